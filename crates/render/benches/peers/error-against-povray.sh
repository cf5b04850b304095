#!/usr/bin/env bash
# How far off pictures of the wine glass are after how long, by POV-Ray and by portray, each against its own picture of many
# samples; one thread, display steps of 1/255. Needs `povray`, and release builds of portray and ierr.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$(cd "$here/../../../.." && pwd)"
bin="${CARGO_TARGET_DIR:-$root/target}/release"
out="$(mktemp -d)"
trap 'rm -r "$out"' EXIT
trace() { # NAME OPTION…
  povray +I"$here/wine-glass.pov" +O"$out/$1.png" +W512 +H512 -D -J +WT1 +FN16 "${@:2}" 2>&1 \
    | sed -n 's/.*Trace Time:.*(\([0-9.]*\) seconds).*/\1/p'
}
trace reference +AM1 +A0.0 +R8 >"$out/seconds"
while read -r options; do
  # Words of a line are options.
  # shellcheck disable=SC2086
  seconds="$(trace picture $options)"
  "$bin/ierr" "$out/reference.png" "$out/picture.png" --metrics rmse --json \
    | sed -n 's/.*"rmse"[^0-9]*\([0-9.e-]*\).*/\1/p' | head -1 \
    | awk -v way="povray $options" -v seconds="$seconds" '{ print way ": " seconds " s, error " 255 * $1 }'
done <<'WAYS'
-A
+AM1 +A0.3 +R3
+AM1 +A0.1 +R3
+AM1 +A0.1 +R4
+AM2 +A0.3 +R3
+AM2 +A0.1 +R3
+AM2 +A0.03 +R4
WAYS
for options in "--samples 1" "--samples 4" "--samples 16" "--aa adaptive --samples 4" "--aa adaptive --samples 16" \
  "--aa adaptive --samples 64" "--error 1" "--error 0.3"; do
  # shellcheck disable=SC2086
  "$bin/portray" -q "$root/scenes/wine-glass/wine-glass.sdl" --threads 1 -o "$out/p.png" --audit --stats - $options \
    | awk -v way="portray $options" '/"trace_seconds"/ { s = $2 } /"audited_error"/ { e = $2 }
      /"audited_error_deviation"/ { d = $2 } END { gsub(",", "", s); gsub(",", "", e)
        print way ": " s " s, error " e " ± " d }'
done
