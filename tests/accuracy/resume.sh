#!/bin/sh
# A reference goes on where it stopped, with less noise, and is not made again when it is good enough.
#     resume.sh velum-accuracy
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "$1" >&2
    cat "$work"/out* "$work/error" >&2
    exit 1
}
make() {
    out=$1
    shift
    "$accuracy" reference --scene slab_thin --size 16x9 --device cpu --seconds 60 --error 1e-6 --cache "$work/cache" \
        "$@" > "$work/$out" 2> "$work/error" || fail "reference: status $?"
}
noise() {
    sed -n 's/.*noise \([0-9.]*\),.*/\1/p' "$work/$1"
}
accuracy=$1
make out1 --paths 64
grep -q ' in  1 parts' "$work/out1" || fail 'no first part'
make out2 --paths 64
[ "$(cat "$work/out1")" = "$(cat "$work/out2")" ] || fail 'made again'
make out3 --paths 1024
grep -q ' in  2 parts' "$work/out3" || fail 'no second part'
# Sixteen times the paths: a quarter of the noise.
awk -v a="$(noise out1)" -v b="$(noise out3)" 'BEGIN { exit !(a > 0 && b > 0.15 * a && b < 0.4 * a) }' ||
    fail "noise of $(noise out1) and $(noise out3)"
# Another plugin than the one that was built, another key.
LC_ALL=C sed 's/\(velum reference revision \)......../\100000000/' "$VELUM_PLUGIN" > "$work/libother.so"
VELUM_PLUGIN=$work/libother.so make out4 --paths 16
grep -q ' in  1 parts' "$work/out4" || fail 'the reference of another plugin was taken'
[ "$(ls "$work/cache" | wc -l)" -eq 2 ] || fail 'not two references'
# Told to stop, it keeps what it has.
"$accuracy" reference --scene fog --size 16x9 --device cpu --seconds 600 --error 1e-6 --cache "$work/cache" \
    > "$work/out5" 2> "$work/error" &
sleep 6
kill -INT $!
wait $! && fail 'stopped, and all is well'
grep -q ' in  1 parts' "$work/out5" || fail 'nothing was kept'
[ "$(ls "$work/cache" | wc -l)" -eq 3 ] || fail 'not three references'
# A byte that has changed since is found.
for file in "$work"/cache/fog-*; do
    printf '\001' | dd of="$file" bs=1 seek=900 conv=notrunc 2> "$work/error"
done
! "$accuracy" run --scene fog --size 16x9 --device cpu --cached --cache "$work/cache" > "$work/out6" 2> "$work/error" ||
    fail 'a damaged reference was taken'
grep -q 'not sound' "$work/error" || fail 'no word of the damage'
