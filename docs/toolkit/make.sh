#!/usr/bin/env bash
# Makes the pictures of docs/toolkit.md, beside itself, from scenes of the repository.
#
#   docs/toolkit/make.sh
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
out=$root/docs/toolkit
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$folder"

# row OUT PICTURE...: side by side, 8 pixels apart.
row() {
    local out=$1 x=0 columns
    icopy -q "$2" row.idf --flatten --depth 8
    shift 2
    for picture in "$@"; do
        read -r _ columns _ < <(grep '^size ' row.idf)
        x=$((columns + 8))
        icopy -q "$picture" next.idf --flatten --depth 8
        icomp over next row --at "$x,0" -q -o wider.idf
        icopy -q wider row.idf
    done
    icopy -q row "$out"
}

portray "$root/scenes/gallery/aquarium.sdl" -q --size 200x150 --samples 9 -o aquarium.png

# One file for each channel.
cat >ball.sdl <<'SDL'
object is shiny reddish orange sphere
light point at (4, 6, 8) intensity 0.9
ambient intensity 0.3
background black
camera at (0, 0, 7) target at (0, 0, 0)
SDL
portray ball.sdl -q --size 120x120 --samples 16 -o ball
for channel in red grn blu cvg; do
    icopy -q ball $channel.png --channels grg=$channel
done
row "$out/channels.png" red.png grn.png blu.png cvg.png

# Soft edges: of a small matte, enlarged.
icopy -q ball soft --crop 15,15,90,90 --depth 16 --resize 14x14
icopy -q soft matte --resize 160x160 --filter bicubic
icopy -q matte edge --channels red=1,grn=0.15,blu=0.1,cvg
icopy -q matte meadow --channels red=0.1,grn=0.8,blu=0.2
icomp over edge meadow -q -o linear.png
icomp over edge meadow --stored -q -o stored.png
row "$out/fringes.png" linear.png stored.png

# Quantisers and dithers, few colours so that it shows.
for method in heckbert fast best; do
    iencode -q -n 24 --method $method aquarium.png -o $method.png
done
row methods.idf heckbert.png fast.png best.png
iencode -q methods.idf -o "$out/methods.png"
iencode -q -n 24 --metric oklab aquarium.png -o oklab.png
row metrics.idf best.png oklab.png
iencode -q metrics.idf -o "$out/metrics.png"
for dither in none floyd-steinberg blue-noise; do
    iencode -q -n 12 --metric oklab --dither $dither aquarium.png -o $dither.png
done
row dithers.idf none.png floyd-steinberg.png blue-noise.png
iencode -q dithers.idf -o "$out/dithers.png"

# Tones.
ieq levels -0.6 1.4 -q aquarium.png -o flat.png
ieq equalize -q flat.png -o equal.png
ieq clahe -q --tiles 4 --clip 0.02 flat.png -o clahe.png
row tones.idf flat.png equal.png clahe.png
iencode -q tones.idf -o "$out/tones.png"
ieq histogram -q aquarium.png -o "$out/histogram.png" >histogram.tsv

# A difference as it is seen.
ierr -q aquarium.png none.png --metrics flip --diff flip.png --diff-by flip >flip.txt
row flip.idf aquarium.png none.png flip.png
iencode -q flip.idf -o "$out/flip.png"

# A texture, four of it as a picture, before and after.
icopy -q aquarium.png floor.png --crop 20,88,120,60
"$root/scripts/prepare-texture.sh" floor.png floor
icopy -q floor.png before.png --tile 2x2
icopy -q floor after.png --channels rgb --tile 2x2
row texture.idf before.png after.png
iencode -q texture.idf -o "$out/texture.png"

# Panels and terminals.
"$root/scripts/e-paper.sh" -s 200x150 aquarium.png grey.png
"$root/scripts/e-paper.sh" -p color7 -s 200x150 aquarium.png color.png
row paper.idf grey.png color.png
iencode -q paper.idf -o "$out/e-paper.png"
icopy -q aquarium.png cells.png --resize 80x60
icopy -q cells.png "$out/terminal.png" --resize 320x240 --filter box

# Frames with one table.
icopy -q aquarium.png small.png --resize 120x90
frames=()
for turn in 0 30 60 90 120 150 180 210 240 270 300 330; do
    ieq hue -q $turn small.png -o "turn-$turn.png"
    frames+=("turn-$turn.png")
done
"$root/scripts/palette-for-frames.sh" -n 96 -d 10 turn.gif "${frames[@]}"
cp turn.gif "$out/frames.gif"
