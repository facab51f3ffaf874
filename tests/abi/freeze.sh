#!/bin/sh
# Takes today's headers as the frozen first version of the ABI. Run once, when ABI 1 is declared final: after that
# v1/ never changes, and tests hold today's headers against it.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$here/v1/velum"
cp "$here"/../../plugin/include/velum/*.h "$here/v1/velum/"
echo "frozen: $(ls "$here/v1/velum" | tr '\n' ' ')"
