#!/usr/bin/env bash
# Renders a scene with sixteen samples a pixel and writes it as a PNG of 256 colours; prints its rays and seconds.
#
#   picture.sh SCENE.sdl OUT.png COLUMNSxROWS [OPTION OF PORTRAY]...
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
if [ $# -lt 3 ]; then
    sed -n '2,/^$/s/^# \{0,1\}//p' "$0" | sed '/^set/d' >&2
    exit 2
fi
scene=$1 out=$2 size=$3
shift 3
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
portray "$scene" -q --size "$size" --samples 16 --channels rgb --stats "$folder/stats" -o "$folder/picture" "$@"
iencode "$folder/picture" -q --metric oklab --dither floyd-steinberg -o "$out"
figure() { sed -n "s/^ *\"$1\": \([0-9.]*\).*/\1/p" "$folder/stats"; }
echo "$out: $(figure rays) rays, $(figure trace_seconds) s"
