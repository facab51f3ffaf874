#!/usr/bin/env bash
# demo.sh HOST SCENARIOS [OPTIONS...]: every command of the host over its scenarios, small. Exit status 0 only if all of
# it succeeds, with the pictures there.
set -euo pipefail
host=$1
scenarios=$2
shift 2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
unset DISPLAY WAYLAND_DISPLAY
export XDG_CACHE_HOME=$out/cache

for scenario in "$scenarios"/*.json; do
    name=$(basename "$scenario" .json)
    "$host" check "$scenario" > /dev/null
    "$host" play "$scenario" --at 5 --settle 3 --size 96x54 --format png,exr --out "$out/$name" --stats "$out/stats" "$@"
    [ "$(find "$out/$name" -size +0 -name '*_000000.png' | wc -l)" -ge 3 ]
    [ "$(find "$out/$name" -size +0 -name '*_000000.exr' | wc -l)" -ge 3 ]
    [ "$(wc -l < "$out/stats")" -ge 9 ]
done
if "$host" play "$scenarios/fair_weather.json" --at 5 --device 99 --out "$out/none" --stats "$out/none/stats" 2> "$out/error"
then
    exit 1
fi
[ "$(wc -l < "$out/error")" -eq 1 ]
[ ! -e "$out/none" ]
"$host" play "$scenarios/fair_weather.json" --from 0 --to 3 --size 96x54 --channels left --out "$out/moving" "$@"
[ "$(find "$out/moving" -size +0 -name '*.png' | wc -l)" -eq 4 ]
"$host" probe "$scenarios/fair_weather.json" --at 5 > "$out/probe.json"
grep -q '"optical_depth"' "$out/probe.json"
"$host" shadow "$scenarios/fair_weather.json" --at 5 --out "$out/shadow.exr" "$@" > "$out/shadow.json"
grep -q '"extent_m"' "$out/shadow.json"
[ -s "$out/shadow.exr" ]

# The pipeline cache: kept; made anew when it is foreign; left out where it cannot be; no word about any of that.
small=(play "$scenarios/fair_weather.json" --at 5 --settle 1 --size 16x16 --channels left --out "$out/small")
cache=("$XDG_CACHE_HOME"/velum/*.pipelines)
[ "${#cache[@]}" -eq 1 ]
[ -s "${cache[0]}" ]
printf 'foreign' > "${cache[0]}"
[ -z "$("$host" "${small[@]}" "$@" 2>&1 >/dev/null)" ]
[ "$(stat -c %s "${cache[0]}")" -gt 7 ]
rm -r "$XDG_CACHE_HOME/velum"
MESA_SHADER_CACHE_DISABLE=1 XDG_CACHE_HOME=/dev/null "$host" "${small[@]}" "$@" > "$out/log" 2>&1
[ "$(wc -l < "$out/log")" -eq 1 ]
"$host" "${small[@]}" --no-cache "$@"
[ ! -e "$XDG_CACHE_HOME/velum" ]
