#!/usr/bin/env bash
# How far the light of portray and POV-Ray 3.7 is apart on scenes that both can say: the root of the mean square
# difference of linear values, edges included, in steps of 1/255. Needs `povray`, `oiiotool` and a release build.
#
# usage: compare.sh [SCENE…]      fails if a scene is more than half a step off
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../../../../.." && pwd)"
portray="${PORTRAY:-${CARGO_TARGET_DIR:-$root/target}/release/portray}"
out="$(mktemp -d)"
trap 'rm -r "$out"' EXIT
[ $# -gt 0 ] || set -- lambert shadows mirror refraction absorption fog
for scene in "$@"; do
  # One ray through the centre of each pixel, as portray has it; depth and least weight as in common.inc.
  povray +I"$here/$scene.pov" +L"$here" +O"$out/a.exr" +FE File_Gamma=1 +W512 +H512 -A -D >"$out/log" 2>&1 \
    || { cat "$out/log" >&2; exit 1; }
  "$portray" -q "$here/$scene.sdl" -o "$out/b.exr" --channels rgb --samples 1 --depth 24 --min-weight 1e-5
  # Its status says that there is a difference.
  { oiiotool "$out/a.exr" "$out/b.exr" --diff || true; } | sed -n 's/.*RMS error = *//p' \
    | awk -v s="$scene" '{ printf "%s %.3f\n", s, 255 * $1; if (255 * $1 > 0.5) exit 1 }'
done
