#!/bin/sh
# The revision that references are kept under changes with what shapes them, and with nothing else.
#     revision.sh PROGRAM ROOT GLSLANG
set -eu
program=$(realpath "$1") root=$(realpath "$2") glslang=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "$1" >&2
    exit 1
}
for folder in shaders core weather plugin tests/bench; do
    mkdir -p "$work/$folder"
    cp -R "$root/$folder/." "$work/$folder"
done
revision() {
    (cd "$work" && "$program" revision.h "$@" && cat revision.h)
}
set -- $(cat "$root/tests/accuracy/revision.txt")
listed=" $* "
before=$(revision "$@")
case $before in "#define ACCURACY_REVISION "*) ;; *) fail "found '$before'" ;; esac
[ "$(revision "$@")" = "$before" ] || fail 'not the same twice'

# A line of code, anywhere in the list.
for source in shaders/reference.comp shaders/shared/density.h shaders/weather.glsl core/tile.c core/noise.c \
    weather/grib.c plugin/record_reference.c plugin/blocks.c; do
    cp "$work/$source" "$work/kept"
    echo 'const int own = 1;' >> "$work/$source"
    [ "$(revision "$@")" != "$before" ] || fail "$source does not count"
    cp "$work/kept" "$work/$source"
    sed 's/0\.5/0.25/' "$work/kept" > "$work/$source"
    cmp -s "$work/kept" "$work/$source" || [ "$(revision "$@")" != "$before" ] || fail "a number of $source does not count"
    cp "$work/kept" "$work/$source"
done

# Comments and layout, and what makes the presets alone.
printf '/* a comment with "quotes" */\n\n    // and one of a line\n' >> "$work/shaders/reference.comp"
for source in shaders/march.comp shaders/resolve.comp shaders/shadow.comp shaders/air_light.glsl shaders/cloud_hit.glsl \
    shaders/cloud_light.glsl shaders/scattering.glsl shaders/shared/shade.h plugin/shades.c plugin/record_view.c \
    plugin/stats.c; do
    echo 'const int own = 1;' >> "$work/$source"
done
[ "$(revision "$@")" = "$before" ] || fail 'what shapes no reference counts'
[ "$(revision "$@" shaders/march.comp)" != "$before" ] || fail 'the list does not count'

# Whatever the shaders include is in the list.
for shader in reference reference_resolve; do
    "$glslang" -V --quiet --target-env vulkan1.3 "-I$root/shaders" "-I$root/plugin/include" -DVELUM_2D \
        --depfile "$work/depfile" -o "$work/$shader.spv" "$root/shaders/$shader.comp"
    for source in $(sed 's/^[^:]*://' "$work/depfile"); do
        path=$(realpath "$source")
        case $listed in *" ${path#"$root"/} "*) ;; *) fail "${path#"$root"/} is not in revision.txt" ;; esac
    done
done
