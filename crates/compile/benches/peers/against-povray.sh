#!/usr/bin/env bash
# Seconds and megabytes that POV-Ray parses and bounds, and prcomp compiles, N objects of three primitives, in turn:
# from as many statements, and from one repeat. Needs `povray`, GNU `time`, and a release build of prcomp.
# Usage: against-povray.sh [N [RUNS]]
set -euo pipefail
root="$(cd "$(dirname "$0")/../../../.." && pwd)"
prcomp="${CARGO_TARGET_DIR:-$root/target}/release/prcomp"
n="${1:-100000}"
out="$(mktemp -d)"
trap 'rm -r "$out"' EXIT

object='shiny red sphere at (%s, %s, %s) scale .4 - blue block rotate (0, %s, 0) + cone at (0, 0, %s)'
pov='union { difference { sphere { <%s, %s, %s>, .4 pigment { color rgb <1, 0, 0> } finish { phong 1 } }
box { -1, 1 rotate <0, %s, 0> pigment { color rgb <0, 0, 1> } } } cone { <0, 0, %s>, 0, <1, 0, %s>, 1 pigment { color rgb 1 } } }'

# shellcheck disable=SC2016
awk -v n="$n" -v form="object is $object\n" 'BEGIN { print "camera at (0, 0, 100)"
  for (i = 0; i < n; i++) printf form, i % 317, int(i / 317) % 317, int(i / 100489), i % 90, i % 50 }' > "$out/statements.sdl"
# shellcheck disable=SC2059
{
  echo "camera at (0, 0, 100) repeat i from 0 to $((n - 1)) { object is"
  printf "$object" 'mod (i, 317)' 'mod (floor (i / 317), 317)' 'floor (i / 100489)' 'mod (i, 90)' 'mod (i, 50)'
  echo ' }'
} > "$out/repeat.sdl"
awk -v n="$n" -v form="${pov//$'\n'/ }\n" 'BEGIN { print "camera { location <0, 0, 100> look_at 0 }"
  for (i = 0; i < n; i++) printf form, i % 317, int(i / 317) % 317, int(i / 100489), i % 90, i % 50, i % 50 }' > "$out/statements.pov"
# shellcheck disable=SC2059
{
  echo "camera { location <0, 0, 100> look_at 0 } #declare i = 0; #while (i < $n)"
  printf "$pov" 'mod(i,317)' 'mod(int(i/317),317)' 'int(i/100489)' 'mod(i,90)' 'mod(i,50)' 'mod(i,50)'
  echo ' #declare i = i + 1; #end'
} > "$out/repeat.pov"

# Prints its label, seconds and megabytes. POV-Ray renders one pixel: what is left is parsing and bounding.
measure() {
  local label="$1"
  shift
  /usr/bin/time -f "$label %e %M" -o "$out/time" "$@" > "$out/log" 2>&1 || { cat "$out/log" >&2; exit 1; }
  awk '{ print $1, $2, $3 / 1000 }' "$out/time"
}
for _ in $(seq "${2:-5}"); do
  for form in statements repeat; do
    measure "povray-$form" povray +I"$out/$form.pov" +W1 +H1 -D -F
    measure "prcomp-$form" "$prcomp" -q "$out/$form.sdl" -o "$out/$form.prc"
    measure "prcomp-check-$form" "$prcomp" -q --check "$out/$form.sdl"
  done
done | sort -k1,1 -k2,2n | awk '{ n[$1]++; v[$1, n[$1]] = $2; if ($3 > m[$1]) m[$1] = $3 }
  END { for (k in n) printf "%s: min %s s, median %s s, %d MB\n", k, v[k, 1], v[k, int((n[k] + 1) / 2)], m[k] }' | sort
