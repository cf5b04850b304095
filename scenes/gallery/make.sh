#!/usr/bin/env bash
# Makes the pictures of the gallery beside this script; programs are taken from the folder PORTRAY_BIN, then from PATH.
#
#   make.sh [NAME]...      all if none is named
set -euo pipefail
[ -z "${PORTRAY_BIN:-}" ] || PATH=$(cd "$PORTRAY_BIN" && pwd):$PATH
export PORTRAY_BIN=
cd "$(dirname "$0")"

# 48 pictures of one turn, in the colors of one table.
animation() {
    local folder
    folder=$(mktemp -d)
    for frame in $(seq 0 47); do
        number=$(printf %02d "$frame")
        portray "$1.sdl" -q -D "frame=$frame" --size 240x180 --samples 9 --channels rgb -o "$folder/$number"
    done
    iencode "$folder"/??.idf -q --metric oklab --delay 5 -o "$1.gif"
    rm -r "$folder"
    echo "$1.gif: 48 pictures"
}

[ $# -gt 0 ] || set -- aquarium cheese flake gears lenses pendulums planet rings section trillion
for name in "$@"; do
    case $name in
        pendulums) animation pendulums ;;
        *) ../picture.sh "$name.sdl" "$name.png" 480x360 ;;
    esac
done
