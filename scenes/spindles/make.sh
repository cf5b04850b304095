#!/usr/bin/env bash
# Makes spindles.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
cd "$(dirname "$0")"
../picture.sh spindles.sdl spindles.png 640x480
