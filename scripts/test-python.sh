#!/usr/bin/env bash
# Builds the wheel of python/, installs it into a fresh environment and runs its tests there.
#
#   test-python.sh [-r]
#
#   -r         build as for a release; slower to build
#   -h         this text
#
# Takes python3 and maturin from PATH, and numpy by pip. Where one of them cannot be had, it says so and ends
# with exit status 77. Pictures are compared with those of the programs on PATH, if they are there, and types are checked by
# mypy, if that is there.

set -euo pipefail

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
fail() {
    echo "$(basename "$0"): $1" >&2
    exit 2
}
skip() {
    echo "skipped: $1" >&2
    exit 77
}

profile=()
while getopts rh option; do
    case $option in
        r) profile=(--release) ;;
        h)
            usage
            exit
            ;;
        *) fail "see -h" ;;
    esac
done
shift $((OPTIND - 1))
[ $# -eq 0 ] || fail "expected no arguments, found $#; see -h"
command -v python3 >/dev/null || skip "python3 is not installed"
command -v maturin >/dev/null || skip "maturin is not installed; pip install maturin"

here=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

python3 -m venv "$folder/environment" || skip "python3 cannot make an environment"
python=$folder/environment/bin/python
export PIP_DISABLE_PIP_VERSION_CHECK=1
"$python" -m pip install --quiet numpy || skip "pip cannot get numpy"
# Cargo takes its settings, for which processors to build among them, from the folders above the working one.
cd "$here/python"
maturin build --quiet "${profile[@]}" --interpreter "$python" --out "$folder/wheels"
"$python" -m pip install --quiet --no-deps "$folder"/wheels/*.whl
cd "$folder"
if command -v mypy >/dev/null; then
    mypy --strict --cache-dir "$folder/types" --python-executable "$python" --package portray
fi
PYTHONDONTWRITEBYTECODE=1 "$python" -m unittest discover --start-directory "$here/python/tests"
