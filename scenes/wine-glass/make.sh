#!/usr/bin/env bash
# Makes wine-glass.png beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
portray wine-glass.sdl -q --samples 16 -o wine-glass.png
