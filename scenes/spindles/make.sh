#!/usr/bin/env bash
# Makes spindles.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
../picture.sh spindles.sdl spindles.png 640x480
