#!/usr/bin/env bash
# prepare.sh SOURCE: .ci/prepare where packages are missing and cannot be installed: they are named, nothing is made.
set -euo pipefail
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bash=$(command -v bash)
mkdir "$work/bin"
for tool in dirname env; do
    ln -s "$(command -v "$tool")" "$work/bin/$tool"
done

# stub NAME LINE...: a program in front of the system's.
stub() {
    printf '%s\n' "#!$bash" "${@:2}" > "$work/bin/$1"
    chmod +x "$work/bin/$1"
}

stub dpkg-query 'case "${*: -1}" in meson | libspng-dev) exit 1 ;; esac' 'echo installed'
stub id 'echo 1000'

# refused PATTERN
refused() {
    if PATH=$work/bin "$bash" "$source/.ci/prepare" "$work/build" > "$work/log" 2>&1 || ! grep -q -- "$1" "$work/log" ||
        [ -e "$work/build" ]; then
        printf 'FAILED: expected: %s\n' "$1"
        sed 's/^/  | /' "$work/log"
        exit 1
    fi
}

refused 'apt-get install --no-install-recommends libspng-dev meson$'
stub sudo 'exit 1'
refused 'Missing: libspng-dev meson$'
