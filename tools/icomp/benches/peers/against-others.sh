#!/usr/bin/env bash
# Milliseconds that `over` of two 4K RGBA files takes, files in and out, by icomp and by those of ImageMagick (`convert`),
# GraphicsMagick (`gm`), OpenImageIO (`oiiotool`) and netpbm (`pamcomp`) that are installed, in turn; the best of RUNS.
# Makes the pictures with ImageMagick; needs a release build of icopy and icomp.
# Usage: against-others.sh [RUNS]
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../../../.." && pwd)"
PATH="${CARGO_TARGET_DIR:-$root/target}/release:$PATH"
folder="$(mktemp -d)"
trap 'rm -r "$folder"' EXIT
cd "$folder"

# Smooth colour with noise, and a disc with a soft rim for coverage.
for name in a b; do
  [ $name = a ] && center='1500,1000 1500,100' || center='2400,1200 2400,300'
  convert -size 3840x2160 -seed ${#center} plasma:red-blue -attenuate 0.1 +noise Gaussian \
    \( -size 3840x2160 xc:black -fill white -draw "circle $center" -blur 0x8 \) \
    -alpha off -compose CopyOpacity -composite -depth 8 -define png:compression-level=3 PNG32:$name.png
  icopy -q $name.png $name.pam
  icopy -q $name.png $name.idf
done

once() {
  local what=$1 start end
  shift
  start=$(date +%s%N)
  "$@" >/dev/null 2>&1 || return 0
  end=$(date +%s%N)
  printf '%s\t%d\n' "$what" $(((end - start) / 1000000))
}
has() { command -v "$1" >/dev/null; }
for _ in $(seq "${1:-7}"); do
  for format in pam png; do
    once "$format icomp" icomp over a.$format b.$format -o icomp.$format
    once "$format ImageMagick" convert b.$format a.$format -composite convert.$format
    if has gm; then once "$format GraphicsMagick" gm composite a.$format b.$format gm.$format; fi
  done
  if has oiiotool; then once "png oiiotool" oiiotool a.png b.png --over -o oiiotool.png; fi
  if has pamcomp; then once "pam pamcomp" pamcomp a.pam b.pam pamcomp.pam; fi
  once "idf icomp" icomp over a.idf b.idf -o c
done | sort -t"$(printf '\t')" -k1,1 -k2,2n | awk -F'\t' '!($1 in best) { best[$1] = $2; printf "%-20s %6d ms\n", $1, $2 }'
