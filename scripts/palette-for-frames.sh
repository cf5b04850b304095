#!/usr/bin/env bash
# Makes an animated GIF of frames that share one table, so that no colour flickers between them.
#
#   palette-for-frames.sh [-n COLOURS] [-d HUNDREDTHS] [-m COLOUR] OUT.gif FRAME...
#
# Beside OUT.gif lies OUT-table.png, a picture of the table, one pixel for each colour in its order.
#
#   -n COLOURS      most colours, 1 to 256 (default: 256)
#   -d HUNDREDTHS   time of a frame in hundredths of a second (default: 4)
#   -m COLOUR       what to put behind where frames are not covered, as #ffffff (default: they stay clear)
#   -h              this text
#
# Programs are taken from the folder PORTRAY_BIN, then from PATH.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

colors=256 delay=4 matte=()
while getopts n:d:m:h option; do
    case $option in
        n) colors=$OPTARG ;;
        d) delay=$OPTARG ;;
        m) matte=(--matte "$OPTARG") ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -ge 3 ] || fail "expected OUT.gif and two frames or more, found $# arguments; see -h"
out=$1
shift
case $out in
    *.gif) ;;
    *) fail "expected a name that ends in .gif, found $out" ;;
esac

[ -z "${PORTRAY_BIN:-}" ] || PATH=$PORTRAY_BIN:$PATH
for program in ilut iencode; do
    command -v "$program" >/dev/null && continue
    echo "$(basename "$0"): no program $program; set PORTRAY_BIN to its folder" >&2
    exit 1
done

table=${out%.gif}-table.png
ilut -q -n "$colors" "${matte[@]}" "$@" -o "$table"
# No dither: its noise moves from frame to frame, and a GIF stores all that moves.
iencode -q --lut "$table" "${matte[@]}" --delay "$delay" "$@" -o "$out"
