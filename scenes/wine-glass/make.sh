#!/usr/bin/env bash
# Makes wine-glass.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
cd "$(dirname "$0")"
[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
portray wine-glass.sdl -q --samples 16 -o wine-glass.png
