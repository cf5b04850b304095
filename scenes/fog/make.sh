#!/usr/bin/env bash
# Makes fog.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
cd "$(dirname "$0")"
../picture.sh fog.sdl fog.png 640x480
