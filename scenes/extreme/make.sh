#!/usr/bin/env bash
# Renders the pictures of scenes/extreme: each scene beside this script.
#
# usage: scenes/extreme/make.sh [NAME…]      all scenes if none is named
set -euo pipefail
cd "$(dirname "$0")"
../../docs/pictures.sh "$PWD" 320x240 16 "$@"
