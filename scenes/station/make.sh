#!/usr/bin/env bash
# Makes the picture of the station, from its textures to the colours of its table; prints its rays and seconds.
#
#   make.sh [-s COLUMNSxROWS] [-n SAMPLES] [-p FOLDER] [OUT]
#
# With OUT, a folder, all that is made on the way is kept there: textures/, the render `deck` with its coverage, `stars`,
# `station`, which is both composited and has its table and its indices, station.six and station.png. Without it there
# is station.png beside this script.
#
#   -s COLUMNSxROWS   size of the picture (default: 960x640)
#   -n SAMPLES        samples a pixel, 1, 4, 9 and so on (default: 9)
#   -p FOLDER         pictures of your own as textures, and stars.png as the sky: see textures.sh
#   -h                this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail

usage() { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" | sed '/^set/d'; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

size=960x640 samples=9 pictures=''
while getopts s:n:p:h option; do
    case $option in
        s) size=$OPTARG ;;
        n) samples=$OPTARG ;;
        p) pictures=$(cd "$OPTARG" && pwd) || fail "no folder $OPTARG" ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -le 1 ] || fail "expected one folder, found $#; see -h"
[[ $size =~ ^([1-9][0-9]{0,4})x([1-9][0-9]{0,4})$ ]] || fail "-s $size: expected a size as 960x640"
columns=${BASH_REMATCH[1]}
here=$(cd "$(dirname "$0")" && pwd)
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
if [ $# -eq 1 ]; then
    mkdir -p "$1"
    out=$(cd "$1" && pwd)
else
    out=$folder
fi

# Textures as fine as the picture shows them.
width=$((columns < 64 ? 64 : columns > 1024 ? 1024 : columns))
"$here/textures.sh" -w "$width" ${pictures:+-p "$pictures"} "$out/textures"
cd "$out"
cp "$here/station.sdl" station.sdl
portray station.sdl -q --size "$size" --samples "$samples" --channels rgb,cvg --stats "$folder/stats" -o deck
if [ -f "$pictures/stars.png" ]; then
    icopy -q "$pictures/stars.png" stars --channels rgb --resize "$size"
else
    istars -q stars --size "$size" --seed 4 --faintest 10 --band 14 --tilt 30 --white 5
fi
icomp -q over deck stars -o station
ilut -q station --metric oklab
iencode -q station --metric oklab --dither floyd-steinberg
iencode -q station --metric oklab --dither floyd-steinberg --sixel -o station.six
iencode -q station --metric oklab --dither floyd-steinberg -o station.png
[ "$out" != "$folder" ] || cp station.png "$here/station.png"
figure() { sed -n "s/^ *\"$1\": \([0-9.]*\).*/\1/p" "$folder/stats"; }
echo "station.png: $(figure rays) rays, $(figure trace_seconds) s"
