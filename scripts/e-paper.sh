#!/usr/bin/env bash
# Prepares a picture for an e-paper panel: fills the panel, lifts the tones, and dithers to the very
# colours of the panel, in its order. A pixel of the result is the number that the panel wants.
#
#   e-paper.sh [-p grey16|color7|TABLE] [-s WxH] PICTURE OUT.png
#
#   -p PANEL   grey16: 16 greys, black first (default); color7: black, white, green, blue, red,
#              yellow, orange; or a table of your own, a .lut or an indexed picture
#   -s WxH     size of the panel (default: 800x480)
#   -h         this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

panel=grey16 size=800x480
while getopts p:s:h option; do
    case $option in
        p) panel=$OPTARG ;;
        s) size=$OPTARG ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -eq 2 ] || fail "expected PICTURE OUT.png, found $# arguments; see -h"
[[ $size =~ ^[1-9][0-9]{0,4}x[1-9][0-9]{0,4}$ ]] || fail "expected a size as 800x480, found $size"
picture=$1 out=$2
case $out in
    *.png) ;;
    *) fail "expected a name that ends in .png, found $out" ;;
esac

[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
for program in icopy ieq iencode; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# A bare table is three rows of bytes: red, green, blue.
rows() {
    local value
    for value in "$@"; do printf '%b' "\\x$value"; done
}
table=$folder/panel.lut saturation=1
case $panel in
    grey16)
        greys=(00 11 22 33 44 55 66 77 88 99 aa bb cc dd ee ff)
        rows "${greys[@]}" "${greys[@]}" "${greys[@]}" >"$table"
        saturation=0
        ;;
    color7)
        {
            rows 00 ff 00 00 ff ff ff
            rows 00 ff ff 00 00 ff 80
            rows 00 ff 00 ff 00 00 00
        } >"$table"
        saturation=1.3
        ;;
    *) table=$panel ;;
esac

# The middle of the picture, in the proportions of the panel.
icopy -q "$picture" "$folder/picture" --flatten --depth 8
read -r _ columns rows _ < <(grep '^size ' "$folder/picture.idf")
width=${size%x*} height=${size#*x}
if ((columns * height > rows * width)); then
    across=$((rows * width / height)) down=$rows
else
    across=$columns down=$((columns * height / width))
fi
across=$((across > 0 ? across : 1)) down=$((down > 0 ? down : 1))
crop=$(((columns - across) / 2)),$(((rows - down) / 2)),$across,$down
icopy -q "$folder/picture" "$folder/panel" --crop "$crop" --resize "$size"

# Paper has little contrast, so details are given more.
ieq clahe --tiles 4 --clip 0.006 -q "$folder/panel" -o "$folder/toned.idf"
ieq saturation "$saturation" -q "$folder/toned" -o "$folder/ready.idf"
iencode -q --lut "$table" --dither floyd-steinberg --strength 1 "$folder/ready.idf" -o "$out"
