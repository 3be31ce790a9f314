#!/usr/bin/env bash
# Runs a scene and opens its results, and made-up ones of every kind, with Python's readers.
# Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build "$@"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for scene in tests/python/*.toml; do
    file=$folder/$(basename "$scene" .toml).h5
    "${CARGO_TARGET_DIR:-target}/debug/afmsweep" run "$scene" -q -o "$file"
    .venv/bin/python -W error tests/python/check_results.py "$file"
done
AFMSWEEP_PYTHON=1 cargo test "$@" --test store_python
