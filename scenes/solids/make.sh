#!/usr/bin/env bash
# Makes solids.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
../picture.sh solids.sdl solids.png 640x480
