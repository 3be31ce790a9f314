#!/usr/bin/env bash
# Builds the Python package's library beside the tests of the program, in whose folder all other libraries lie compiled, and runs
# the package's tests. Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
export PYO3_PYTHON=$PWD/.venv/bin/python PYO3_BUILD_EXTENSION_MODULE=1
# All packages, with one that has the tests' libraries: alone it would choose other features of them, and compile them all once more.
cargo build --workspace --lib --example static_curve "$@"
cp "${CARGO_TARGET_DIR:-target}/debug/lib_afmsweep.so" python/afmsweep/_afmsweep.abi3.so
PYTHONPATH=python .venv/bin/python -m pytest -q --no-header --doctest-modules -n 2 python
