#!/usr/bin/env bash
# Renders the pictures of docs/sampling.md.
#
# usage: docs/sampling/make.sh
#
# The program portray is the one that PORTRAY names, or that of the folder PORTRAY_BIN, or of PATH.
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
portray=${PORTRAY:-portray}
"$portray" focus.sdl -q --size 384x256 --error 0.5 -o focus.png
"$portray" glossy.sdl -q --size 384x256 --glossy --error 1 -o glossy.png
for way in none adaptive stochastic; do
  "$portray" ../../scenes/gallery/gears.sdl -q --size 192x192 --aa "$way" -o "gears-$way.png"
done
