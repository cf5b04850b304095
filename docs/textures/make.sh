#!/usr/bin/env bash
# Renders the pictures of docs/textures.md: each scene beside this script.
#
# usage: docs/textures/make.sh [NAME…]      all scenes if none is named
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
../pictures.sh "$PWD" 128x128 16 "$@"
