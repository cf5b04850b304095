#!/usr/bin/env bash
# Makes cylinders.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
cd "$(dirname "$0")"
../picture.sh cylinders.sdl cylinders.png 640x480
