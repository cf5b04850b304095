#!/usr/bin/env bash
# Makes a picture into a texture: tones evened out, opposite edges that meet, and levels of detail.
#
#   prepare-texture.sh [-s WxH] [-c CLIP] PICTURE TEXTURE
#
# TEXTURE is an IDF image with colour and, made of it, grey, for textures that want one number; of a
# grey picture it has grey alone. Its levels TEXTURE.1, TEXTURE.2 and so on are each half as large, to one pixel.
#
#   -s WxH    size of the texture, as 512x512 (default: that of the picture)
#   -c CLIP   how much tones may be pulled apart, 0.001 to 1; 1 leaves most contrast (default: 0.005)
#   -h        this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

size=() clip=0.005
while getopts s:c:h option; do
    case $option in
        s) size=(--resize "$OPTARG") ;;
        c) clip=$OPTARG ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -eq 2 ] || fail "expected PICTURE TEXTURE, found $# arguments; see -h"
picture=$1 texture=$2

[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
for program in ieq icopy; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# Light that comes from one side would show as a pattern of tiles.
ieq clahe --tiles 4 --clip "$clip" -q "$picture" -o "$folder/even.idf"
if grep -q '^red ' "$folder/even.idf"; then channels=rgb,grg=luma; else channels=grg; fi
icopy -q "$folder/even.idf" "$texture" --channels "$channels" --tileable "${size[@]}" --mips
