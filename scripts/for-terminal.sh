#!/usr/bin/env bash
# Prepares a picture for terminals: as sixel, and as half blocks for terminals without. Either is
# shown with `cat`. On a terminal the picture is shown at once, in the best way it has.
#
#   for-terminal.sh [-w PIXELS] [-b COLUMNSxROWS] [-m COLOUR] PICTURE NAME
#
# The files are NAME.six and NAME.ans.
#
#   -w PIXELS         width of the sixel picture; smaller pictures stay as they are (default: 640)
#   -b COLUMNSxROWS   characters for the half blocks (default: 80x24)
#   -m COLOUR         what to put behind where the picture is not covered (default: its background)
#   -h                this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

width=640 cells=80x24 flatten=(--flatten)
while getopts w:b:m:h option; do
    case $option in
        w) width=$OPTARG ;;
        b) cells=$OPTARG ;;
        m) flatten=(--flatten "$OPTARG") ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -eq 2 ] || fail "expected PICTURE NAME, found $# arguments; see -h"
[[ $width =~ ^[1-9][0-9]{0,4}$ ]] || fail "expected a width from 1 to 99999, found $width"
picture=$1 name=$2

[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
for program in icopy iencode ishow; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

icopy -q "$picture" "$folder/picture" --depth 8 "${flatten[@]}"
read -r _ columns rows _ < <(grep '^size ' "$folder/picture.idf")
if ((columns > width)); then
    height=$((rows * width / columns))
    icopy -q "$folder/picture" "$folder/fitted" --resize "${width}x$((height > 0 ? height : 1))"
else
    icopy -q "$folder/picture" "$folder/fitted"
fi
iencode -q --metric oklab --dither floyd-steinberg --sixel "$folder/fitted.idf" -o "$name.six"
ishow -q --blocks --colors true --size "$cells" "$folder/picture" >"$folder/blocks"
mv "$folder/blocks" "$name.ans"
[ ! -t 1 ] || ishow "$folder/picture"
