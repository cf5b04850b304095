#!/usr/bin/env bash
# Renders the pictures of scenes/optics: each scene beside this script.
#
# usage: scenes/optics/make.sh [NAME…]      all scenes if none is named
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"
../../docs/pictures.sh "$PWD" 256x256 9 "$@"
