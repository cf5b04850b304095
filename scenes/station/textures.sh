#!/usr/bin/env bash
# Makes the seven texture files of the station from scenes of this folder, a starry sky and noise.
#
#   textures.sh [-p FOLDER] [-w COLUMNS] [OUT]
#
# OUT is a folder; default: textures, beside this script. Files: planet clouds earth plates screen chart sign, all .png.
#
#   -p FOLDER    pictures of your own: each of these names that FOLDER has as .png takes the place of what would be made
#   -w COLUMNS   width of the largest, 64 to 4096 (default: 1024)
#   -h           this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail

usage() { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" | sed '/^set/d'; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

pictures='' width=1024
while getopts p:w:h option; do
    case $option in
        p) pictures=$(cd "$OPTARG" && pwd) || fail "no folder $OPTARG" ;;
        w) width=$OPTARG ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -le 1 ] || fail "expected one folder, found $#; see -h"
case $width in '' | *[!0-9]* | ?????*) fail "-w $width: expected a number from 64 to 4096" ;; esac
[ "$width" -ge 64 ] && [ "$width" -le 4096 ] || fail "-w $width: expected a number from 64 to 4096"
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "${1:-$here/textures}"
out=$(cd "${1:-$here/textures}" && pwd)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$folder"

# A scene of the folder `sources` as an image, so many columns wide, half or all as high; options of portray follow.
source_picture() {
    local name=$1 columns=$2 rows=$3
    shift 3
    portray "$here/sources/$name.sdl" -q --size "${columns}x$rows" --samples 4 -o "$name" "$@"
}

# Fractal land under a sea; opposite edges meet, for the map goes around a ball.
land() {
    source_picture land "$width" $((width / 2)) --channels rgb
    icopy -q land around --tileable
    ieq -q levels 0.08 0.74 around -o map
}

# The sun on the planet is so strong that the map has to be dark.
planet() {
    ieq -q levels 0 1.75 "$1" -o dim
    iencode -q dim --metric oklab --dither floyd-steinberg -o "$out/planet.png"
}

# Streaks, broken up by flames: a stencil.
clouds() {
    source_picture clouds "$width" $((width / 2)) --channels rgb
    source_picture flakes "$width" $((width / 2)) --channels rgb
    icopy -q clouds streaks --channels grg=luma --tileable
    icopy -q flakes mask --channels grg=luma,cvg=0.5 --tileable
    icomp -q over mask streaks -o mixed
    ieq -q levels 0.8 1.04 mixed -o spread
    icopy -q spread "$out/clouds.png" --channels grg --depth 8
}

# The continents: a stencil.
earth() {
    source_picture earth "$width" $((width / 2)) --channels rgb
    icopy -q earth "$out/earth.png" --channels grg=luma
}

# Plates of a hull as heights, with a little wear: a relief.
plates() {
    source_picture plates $((width / 2)) $((width / 2)) --channels rgb
    icopy -q plates "$out/plates.png" --channels grg=luma
}

screen() {
    source_picture screen $((width / 2)) $((width / 4)) --channels rgb
    iencode -q screen --metric oklab -o "$out/screen.png"
}

# A chart: orbits over stars.
chart() {
    local columns=$((width / 2)) rows=$((width / 4))
    source_picture orbits "$columns" "$rows" --channels rgb,cvg
    istars -q deep --size "${columns}x$rows" --seed 12 --faintest 8 --band 20 --tilt 24 --white 7
    ieq -q levels -0.06 1 deep -o lifted
    icomp -q over orbits lifted -o both
    iencode -q both --metric oklab -o "$out/chart.png"
}

# Light through a template, with coverage where there is none.
sign() {
    source_picture sign $((width / 2)) $((width / 4)) --channels rgb,cvg
    icopy -q sign "$out/sign.png"
}

if [ -n "$pictures" ] && [ -f "$pictures/planet.png" ]; then
    planet "$pictures/planet.png"
else
    land
    planet map
fi
for name in clouds earth plates screen chart sign; do
    if [ -n "$pictures" ] && [ -f "$pictures/$name.png" ]; then
        icopy -q "$pictures/$name.png" "$out/$name.png"
    else
        "$name"
    fi
done
