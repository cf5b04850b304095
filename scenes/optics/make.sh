#!/usr/bin/env bash
# Renders the pictures of scenes/optics: each scene beside this script, with the program portray.
#
# usage: scenes/optics/make.sh [NAME…]      all scenes if none is named
set -euo pipefail
cd "$(dirname "$0")"
[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
portray=${PORTRAY:-portray}
if ! command -v "$portray" >/dev/null; then
  echo "make.sh: \`$portray\` is missing: build it, and put it on the PATH or into PORTRAY" >&2
  exit 1
fi
if [ $# -eq 0 ]; then
  for scene in *.sdl; do
    # Files that are only included have no camera.
    if grep -q '^camera' "$scene"; then set -- "$@" "${scene%.sdl}"; fi
  done
fi
for name in "$@"; do
  "$portray" "$name.sdl" -q --size 256x256 --samples 9 -o "$name.png"
done
