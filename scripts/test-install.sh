#!/usr/bin/env bash
# Installs programs by `cargo install --path` into an empty folder, and asks each for its version.
#
#   test-install.sh [-r] [FOLDER...]
#
#   FOLDER     what to install, as crates/render (default: all that docs/tasks/install.md names)
#   -r         build as for a release, as users do; slower to build
#   -h         this text
#
# Builds where CARGO_TARGET_DIR says, else in target/, so that what is there is not built again.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}

profile=(--debug)
while getopts rh option; do
    case $option in
        r) profile=() ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))

cd "$(dirname "$(readlink -f "$0")")/.."
page=docs/tasks/install.md
[ $# -gt 0 ] || set -- $(sed -n 's/^cargo install --path //p' "$page")
for package in "$@"; do
    [ -f "$package/Cargo.toml" ] || fail "expected the folder of a package, found $package"
done
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
target=${CARGO_TARGET_DIR:-$PWD/target}
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml)

for package in "$@"; do
    cargo install --quiet --locked "${profile[@]}" --path "$package" --root "$root" --target-dir "$target"
done
installed=0
for program in "$root"/bin/*; do
    name=$(basename "$program")
    said=$("$program" --version)
    [ "$said" = "$name $version" ] || {
        echo "$name --version: expected $name $version, found $said" >&2
        exit 1
    }
    echo "$said"
    installed=$((installed + 1))
done
[ "$installed" -eq $# ] || {
    echo "expected $# programs, found $installed" >&2
    exit 1
}
