#!/usr/bin/env bash
# Quality (PSNR in dB) and CPU time of our quantisers beside pngquant, ImageMagick and netpbm, as a
# table of Markdown: 256 colours, no dither, files read and written.
#
#   scripts/compare-quantisers.sh [PICTURE.png…]      without pictures, the scenes are rendered
#
# Our programs are taken from CARGO_TARGET_DIR (default: target) after `cargo build --release
# --workspace`, or from PATH; those of others from PATH. One that is not installed is said to be
# absent.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=${CARGO_TARGET_DIR:-$root/target}/release:$PATH
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

needed=(iencode ierr)
[ $# -gt 0 ] || needed+=(portray)
for program in "${needed[@]}"; do
    if ! command -v "$program" >/dev/null; then
        echo "no $program; first: cargo build --release --workspace" >&2
        exit 1
    fi
done

pictures=("$@")
if [ ${#pictures[@]} -eq 0 ]; then
    for scene in "$root"/scenes/*/*.sdl; do
        case $scene in */include/*) continue ;; esac
        name=$folder/$(basename "$scene" .sdl).png
        portray "$scene" -q --size 512x512 --samples 4 -o "$name"
        pictures+=("$name")
    done
fi

ours() { # METHOD METRIC IN OUT
    iencode -q --threads 1 --method "$1" --metric "$2" "$3" -o "$4"
}
heckbert() { ours heckbert rgb "$@"; }
fast() { ours fast rgb "$@"; }
best() { ours best rgb "$@"; }
oklab() { ours best oklab "$@"; }
pngquant_1() { pngquant --force --nofs --speed 1 --output "$2" 256 "$1"; }
pngquant_4() { pngquant --force --nofs --speed 4 --output "$2" 256 "$1"; }
imagemagick() { MAGICK_THREAD_LIMIT=1 convert "$1" +dither -colors 256 "PNG8:$2"; }
netpbm() { pngtopnm "$1" | pnmquant -nofloyd 256 | pnmtopng >"$2"; }

# Rows of the table: the function, the program it needs, its name.
rows=(
    "heckbert|true|ilut heckbert"
    "fast|true|ilut fast"
    "best|true|ilut best"
    "oklab|true|ilut best, Oklab"
    "pngquant_1|pngquant|pngquant, speed 1"
    "pngquant_4|pngquant|pngquant, speed 4"
    "imagemagick|convert|ImageMagick"
    "netpbm|pnmquant|netpbm pnmquant"
)

printf '| method |'
for picture in "${pictures[@]}"; do printf ' %s |' "$(basename "$picture" .png)"; done
printf ' mean dB | CPU s |\n|---|'
for _ in "${pictures[@]}"; do printf -- '--:|'; done
printf -- '--:|--:|\n'

TIMEFORMAT='%U %S'
for row in "${rows[@]}"; do
    IFS='|' read -r work program name <<<"$row"
    printf '| %s |' "$name"
    if ! command -v "$program" >/dev/null; then
        for _ in "${pictures[@]}"; do printf ' absent |'; done
        printf ' | |\n'
        continue
    fi
    decibels=() seconds=()
    for picture in "${pictures[@]}"; do
        { time "$work" "$picture" "$folder/out.png" 2>"$folder/errors"; } 2>"$folder/time" || {
            cat "$folder/errors" >&2
            exit 1
        }
        value=$(ierr -q --metrics psnr "$picture" "$folder/out.png" |
            awk '$1 == "psnr" { print $2 }')
        printf ' %s |' "$value"
        decibels+=("$value")
        seconds+=("$(cat "$folder/time")")
    done
    printf '%s\n' "${decibels[@]}" | awk '{ sum += $1 } END { printf " %.2f |", sum / NR }'
    printf '%s\n' "${seconds[@]}" | awk '{ sum += $1 + $2 } END { printf " %.2f |\n", sum }'
done
