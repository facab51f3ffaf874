#!/bin/sh
# symbols.sh LIBRARY SOURCE_FOLDER: what the plugin shows to the linker, and what it must never call.
set -eu
library=$1 sources=$2
failed=0

exported=$(nm -D --defined-only "$library" | awk '{print $NF}')
if [ "$exported" != velum_negotiate ]; then
    echo "exports, expected velum_negotiate alone:" $exported
    failed=1
fi
needed=$(readelf -d "$library" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
if [ -z "$needed" ]; then
    echo "$library: no NEEDED entry was found: is readelf there?"
    failed=1
fi
for forbidden in libvulkan libglfw libeccodes libjansson libnova libvelum-weather; do
    if echo "$needed" | grep -q "^$forbidden"; then
        echo "links $forbidden: the plugin loads Vulkan at run time and reads no files"
        failed=1
    fi
done
if ! ls "$sources"/*.c >/dev/null; then
    failed=1
fi
if grep -n 'DeviceWaitIdle' "$sources"/*.c "$sources"/*.h; then
    echo "the plugin never idles the host's device"
    failed=1
fi
exit $failed
