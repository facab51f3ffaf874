#!/usr/bin/env bash
# Mistakes on the command line and around it: one clear line on stderr, exit status 1, nothing left behind.
set -euo pipefail
host=$1
plugins=$2
work=$(mktemp -d)
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
unset DISPLAY WAYLAND_DISPLAY
failed=0

good=$work/good.json
cat > "$good" <<'JSON'
{ "velum": 1, "title": "test", "start": "2014-12-18T10:00:00Z", "duration_s": 10, "seed": 1,
  "ground": {"albedo": [0.1, 0.1, 0.1]},
  "weather": [ {"time_s": 0, "transition_s": 0, "sources": [
      {"global": {"visibility_m": 30000, "layers": [
          {"type": "Cu", "coverage": 0.4, "base_m": 900, "top_m": 1500, "water_g_m3": 0.3, "radius_um": 10}]}} ]} ],
  "camera": [ {"time_s": 0, "lat_deg": 50, "lon_deg": 8, "height_m": 300, "heading_deg": 90,
               "pitch_deg": 0, "roll_deg": 0} ],
  "channels": [ {"name": "front", "yaw_deg": 0, "pitch_deg": 0, "roll_deg": 0, "hfov_deg": 60, "size": [64, 36]} ] }
JSON

# refused PATTERN ARGUMENTS...: exit status 1 and exactly one line on stderr, which matches.
refused() {
    local pattern=$1 status=0
    shift
    "$host" "$@" > "$work/out.txt" 2> "$work/err.txt" || status=$?
    if [ "$status" -ne 1 ] || [ "$(wc -l < "$work/err.txt")" -ne 1 ] || ! grep -qE -- "$pattern" "$work/err.txt"; then
        printf 'FAILED: velum-host %s\n  status %s, expected one line like: %s\n' "$*" "$status" "$pattern"
        sed 's/^/  | /' "$work/err.txt"
        failed=1
    fi
}

# accepted PATTERN ARGUMENTS...: exit status 0, nothing on stderr, stdout matches.
accepted() {
    local pattern=$1 status=0
    shift
    "$host" "$@" > "$work/out.txt" 2> "$work/err.txt" || status=$?
    if [ "$status" -ne 0 ] || [ -s "$work/err.txt" ] || ! grep -qE -- "$pattern" "$work/out.txt"; then
        printf 'FAILED: velum-host %s\n  status %s, expected on stdout: %s\n' "$*" "$status" "$pattern"
        sed 's/^/  | /' "$work/out.txt" "$work/err.txt"
        failed=1
    fi
}

refused 'a command is missing'
refused 'fly: unknown command' fly "$good"
refused 'a scenario file is missing' play
refused '--colour: unknown option' play "$good" --colour red
refused '--spp: not an option of .check.' check "$good" --spp 4
refused '--at: a value is missing' play "$good" --at
refused '--at: found .soon., expected seconds' play "$good" --at soon
refused '--at: found .nan.' play "$good" --at nan
refused '--at: found .1e999.' play "$good" --at 1e999
refused '--at: found .-5.' play "$good" --at -5
refused '--at does not go with' play "$good" --at 1 --from 2
refused '--size: found .640.' play "$good" --size 640
refused '--size: found .0x10.' play "$good" --size 0x10
refused '--size: found .99999x10.' play "$good" --size 99999x10
refused '--format: found .gif.' play "$good" --format gif
refused '--format: found .png,.' play "$good" --format png,
refused '--fps: found .0.' play "$good" --fps 0
refused '--settle: found .-1.' play "$good" --settle -1
refused '--pose: found .1,2,3., expected lat,lon' play "$good" --pose 1,2,3
refused '--pose: latitude: found .91.' play "$good" --pose 91,0,0,0,0,0
refused '--pose: height: found .nan.' play "$good" --pose 0,0,nan,0,0,0
refused '--pose: height: found .6e7., expected -10000 to 5e.07' play "$good" --pose 0,0,6e7,0,0,0
refused '--quality: found .best.' play "$good" --quality best
refused '--spp needs --quality reference' play "$good" --spp 16
refused '--error needs --quality reference' play "$good" --error 0.1
refused '--error: found .0.' play "$good" --quality reference --error 0
refused '--budget-ms: found .0., expected milliseconds' play "$good" --budget-ms 0
refused '--budget-ms: found .nan.' play "$good" --budget-ms nan
refused '--budget-ms: found .-3.' play "$good" --budget-ms -3
refused '--budget-ms: found .10001.' play "$good" --budget-ms 10001
refused '--budget-ms: a value is missing' play "$good" --budget-ms
refused '--budget-ms: not an option of .probe.' probe "$good" --at 0 --budget-ms 3
refused '--budget-error: found .2., expected a relative error' play "$good" --budget-error 2
refused '--budget-error: found .inf.' play "$good" --budget-error inf
refused '--budget-ms does not go with --quality reference' play "$good" --quality reference --budget-ms 5
refused '--budget-error does not go with --quality reference' play "$good" --budget-error 0.1 --quality reference
refused '--device: found .fast.' play "$good" --device fast
refused '--window does not go with --out' play "$good" --window --out "$work/x"
refused 'no display' play "$good" --window
DISPLAY=:987 refused 'no display .*:987' play "$good" --window
refused '--at is missing' probe "$good"
refused '--out is missing' shadow "$good" --at 0
refused 'a second scenario' play "$good" "$good"
refused 'missing.json' check "$work/missing.json"

printf '{ "velum": 1,\n  "title": oops }\n' > "$work/broken.json"
refused 'broken.json:2:[0-9]+: ' check "$work/broken.json"
refused 'broken.json:2:[0-9]+: ' play "$work/broken.json" --out "$work/never"
refused 'missing.csv' check "$good" --weather "$work/missing.csv"
accepted 'layers: 1' check "$good"
refused '--at: found 10.5, expected 0 to 10, the' play "$good" --at 10.5 --out "$work/late"
refused '--from: found 11, expected 0 to 10,' play "$good" --from 11 --to 5 --out "$work/late"
refused '--to: found 1e.09, expected 0 to 10,' play "$good" --from 1 --to 1e9 --out "$work/late"
refused '--at: found 11, expected 0 to 10,' probe "$good" --at 11
refused '--at: found 11, expected 0 to 10,' tiles "$good" --at 11 --out "$work/late/deep"
accepted 'optical_depth' probe "$good" --at 10
accepted 'velum-host play SCENARIO' --help

refused 'cannot load the plugin: .*missing.so' probe "$good" --at 0 --plugin "$work/missing.so"
refused 'it has no velum_negotiate' probe "$good" --at 0 --plugin "$plugins/host_plugin_none.so"
refused 'another version: it speaks ABI 99' probe "$good" --at 0 --plugin "$plugins/host_plugin_99.so"
refused 'lacks the table .velum.world/1.' play "$good" --at 0 --out "$work/hollow" --plugin "$plugins/host_plugin_tables.so"

: > "$work/file"
refused 'file: cannot make this folder' play "$good" --at 0 --out "$work/file"
refused 'file/below: cannot make|file: cannot make' play "$good" --at 0 --out "$work/file/below"
refused 'file: cannot make' shadow "$good" --at 0 --out "$work/file/map.exr"
refused 'file: cannot make' tiles "$good" --at 0 --out "$work/file"
refused 'file: cannot make' play "$good" --at 0 --out "$work/pictures" --stats "$work/file/stats.jsonl"
if [ "$(id -u)" -ne 0 ]; then
    mkdir "$work/closed"
    chmod a-w "$work/closed"
    refused 'closed: cannot write here' play "$good" --at 0 --out "$work/closed"
fi

left=$(find "$work" -name '*.tmp' -o -name '*.png' -o -name '*.exr' -o -name never -o -name late -o -name hollow)
if [ -n "$left" ]; then
    printf 'FAILED: left behind: %s\n' "$left"
    failed=1
fi
exit "$failed"
