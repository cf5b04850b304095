#!/usr/bin/env bash
# Cuts a picture out by a matte and puts it over a background, in linear light: soft edges stay soft,
# without the dark fringes of mixing stored values.
#
#   matte-over.sh [-a X,Y] PICTURE MATTE BACKGROUND OUT
#
# MATTE is as large as PICTURE: white where the picture is to be seen, black where the background is,
# grey for parts of pixels. OUT is an image of any format.
#
#   -a X,Y   where the top left of the picture is on the background (default: 0,0)
#   -h       this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

at=0,0
while getopts a:h option; do
    case $option in
        a) at=$OPTARG ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -eq 4 ] || fail "expected PICTURE MATTE BACKGROUND OUT, found $# arguments; see -h"
picture=$1 matte=$2 background=$3 out=$4

[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
for program in icopy icomp; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# The colours without a coverage of their own: the matte takes its place.
icopy -q "$picture" "$folder/whole" --matte straight --depth 8
if grep -q '^red ' "$folder/whole.idf"; then channels=rgb; else channels=red=grg,grn=grg,blu=grg; fi
icopy -q "$folder/whole" "$folder/cut" --channels "$channels"
icopy -q "$matte" "$folder/grey" --channels grg=luma --depth 8
# Compared here, where the files have names that the user knows.
sizes=("$(sed -n 's/^size //p' "$folder/cut.idf")" "$(sed -n 's/^size //p' "$folder/grey.idf")")
if [ "${sizes[0]}" != "${sizes[1]}" ]; then
    echo "$(basename "$0"): expected a matte of one size with the picture, found ${sizes[1]/ / x } pixels" \
        "in $matte and ${sizes[0]/ / x } in $picture; icopy --resize makes them alike" >&2
    exit 1
fi
icopy -q "$folder/grey" "$folder/matte" --channels cvg=grg
# A description is text, so a channel is borrowed by a line; the colours are not yet multiplied by it.
{
    sed '/^matte /d' "$folder/cut.idf"
    echo "matte straight"
    grep '^cvg ' "$folder/matte.idf"
} >"$folder/picture.idf"
# The background is the canvas: nothing of the picture shows beyond it.
icomp atop "$folder/picture.idf" "$background" --at "$at" -q -o "$out"
