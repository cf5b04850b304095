#!/usr/bin/env bash
# Instructions that the wine glass takes on one thread, by callgrind, beside the figure kept for this
# compiler in crates/render/benches/instructions.txt. It fails where they are 5 % more, unless
# CHANGELOG.md has a line that says so: "wine glass: N million instructions".
#
#   scripts/count-instructions.sh [--keep]      --keep writes the figure down
#
# portray is taken from CARGO_TARGET_DIR (default: target) after `cargo build --release`. Without
# valgrind, or for a compiler that no figure is kept for, nothing is compared.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
portray=${CARGO_TARGET_DIR:-$root/target}/release/portray
figures=$root/crates/render/benches/instructions.txt
[ $# -eq 0 ] || [ "$*" = --keep ] || { echo "expected nothing or --keep, found $*" >&2; exit 2; }

if ! command -v valgrind >/dev/null; then
    echo "valgrind is not installed: instructions are not counted"
    exit 0
fi
if [ ! -x "$portray" ]; then
    echo "no $portray; first: cargo build --release" >&2
    exit 1
fi
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
valgrind --tool=callgrind --callgrind-out-file="$folder/out" "$portray" -q --samples 1 --threads 1 \
    "$root/scenes/wine-glass/wine-glass.sdl" -o "$folder/picture.png" >"$folder/said" 2>&1 || {
    cat "$folder/said" >&2
    exit 1
}
found=$(awk '$1 == "summary:" || $1 == "totals:" { n = $2 } END { printf "%d", n / 1e6 + 0.5 }' "$folder/out")
compiler="$(rustc --version | cut -d ' ' -f 2) $(uname -m)"
if [ "${1:-}" = --keep ]; then
    { grep -v "^$compiler " "$figures" || true; echo "$compiler $found"; } >"$folder/figures"
    cp "$folder/figures" "$figures"
fi
kept=$(sed -n "s/^$compiler //p" "$figures")
if [ -z "$kept" ]; then
    echo "wine glass: $found million instructions; no figure is kept for $compiler"
    exit 0
fi
echo "wine glass: $found million instructions; $kept are kept for $compiler"
if [ $((found * 100)) -gt $((kept * 105)) ]; then
    # What is known is written down, to the same 5 %.
    known=$(sed -n 's/.*wine glass: \([0-9]*\) million instructions.*/\1/p' "$root/CHANGELOG.md" | tail -n 1)
    if [ -z "$known" ] || [ $((found * 100)) -gt $((known * 105)) ]; then
        echo "more than 5 % more: find out why, or say in CHANGELOG.md" \
            "\"wine glass: $found million instructions\"" >&2
        exit 1
    fi
fi
