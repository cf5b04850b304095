#!/usr/bin/env bash
# Renders each scene of a folder that has a camera to a small picture beside it.
#
# usage: docs/pictures.sh FOLDER SIZE SAMPLES [NAME…]      all scenes if none is named
#
# The program portray is the one that PORTRAY names, or that of the folder PORTRAY_BIN, or of PATH.
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$1"
size=$2 samples=$3
shift 3
portray=${PORTRAY:-portray}
if ! command -v "$portray" >/dev/null; then
  echo "pictures.sh: \`$portray\` is missing: build it, and put it on the PATH or into PORTRAY" >&2
  exit 1
fi
if [ $# -eq 0 ]; then
  for scene in *.sdl; do
    # Files that are only included have no camera.
    if grep -q '^camera' "$scene"; then set -- "$@" "${scene%.sdl}"; fi
  done
fi
for name in "$@"; do
  "$portray" "$name.sdl" -q --size "$size" --samples "$samples" -o "$name.png"
done
