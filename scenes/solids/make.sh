#!/usr/bin/env bash
# Makes solids.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
cd "$(dirname "$0")"
../picture.sh solids.sdl solids.png 640x480
