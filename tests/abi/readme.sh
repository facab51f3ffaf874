#!/bin/sh
# readme.sh README INCLUDE LIBRARY OLD_HOST COMPILER...: the host in the README compiles without a warning, has at most
# thirty lines, and makes a picture. 77: no Vulkan device (it was compiled).
set -eu
readme=$1 include=$2 library=$3 old_host=$4
shift 4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$readme" >"$folder/host.c"
lines=$(wc -l <"$folder/host.c")
if [ "$lines" -lt 10 ] || [ "$lines" -gt 30 ]; then
    echo "the README's host has $lines lines, expected 10..30"
    exit 1
fi
"$@" -std=c17 -Wall -Wextra -Wpedantic -Werror "-I$include" "$folder/host.c" -o "$folder/host" "$library" -lm \
    "-Wl,-rpath,$(dirname "$library")"
status=0
"$old_host" "$library" >"$folder/log" 2>&1 || status=$?
if [ "$status" -eq 77 ]; then
    echo "compiled; no Vulkan device to run it on"
    exit 77
fi
"$folder/host" >"$folder/sky.ppm"
size=$(wc -c <"$folder/sky.ppm")
if [ "$size" -ne $((15 + 640 * 360 * 3)) ]; then
    echo "the picture has $size bytes, expected $((15 + 640 * 360 * 3))"
    exit 1
fi
# A sky is not one colour.
values=$(tail -c +16 "$folder/sky.ppm" | od -An -v -tu1 -w1 | sort -u | wc -l)
if [ "$values" -lt 32 ]; then
    echo "the picture has $values different values, expected 32 or more"
    exit 1
fi
