#!/usr/bin/env bash
# Seconds that POV-Ray and portray trace the wine glass on two threads, in turn; needs `povray` and a release build.
# Usage: against-povray.sh [RUNS]
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../../../.." && pwd)"
portray="${CARGO_TARGET_DIR:-$root/target}/release/portray"
out="$(mktemp -d)"
trap 'rm -r "$out"' EXIT
for _ in $(seq "${1:-9}"); do
  povray +I"$here/wine-glass.pov" +O"$out/p.png" +W512 +H512 -A -D +WT2 2>&1 \
    | sed -n 's/.*Trace Time:.*(\([0-9.]*\) seconds).*/povray \1/p'
  "$portray" -q "$root/scenes/wine-glass/wine-glass.sdl" --samples 1 --threads 2 -o "$out/q.png" --stats - \
    | sed -n 's/.*"trace_seconds": \([0-9.]*\).*/portray \1/p'
done | sort | awk '{ n[$1]++; v[$1, n[$1]] = $2 }
  END { for (k in n) printf "%s: min %s, median %s\n", k, v[k, 1], v[k, int((n[k] + 1) / 2)] }'
