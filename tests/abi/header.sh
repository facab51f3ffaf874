#!/bin/sh
# header.sh LANGUAGE STANDARD HEADER INCLUDE... -- COMPILER...: the header is a translation unit of its own, and may be
# included twice.
set -eu
language=$1 standard=$2 header=$3
shift 3
includes=
while [ "$1" != -- ]; do
    includes="$includes -I$1"
    shift
done
shift
source=$(mktemp)
trap 'rm -f "$source"' EXIT
printf '#include <%s>\n#include <%s>\nint main(void);\n' "$header" "$header" >"$source"
# shellcheck disable=SC2086
"$@" -x "$language" "-std=$standard" -Wall -Wextra -Wpedantic -Wshadow -Werror -fsyntax-only $includes "$source"
