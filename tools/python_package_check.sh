#!/usr/bin/env bash
# Builds the Python package's library beside the tests of the program, in whose folder all other libraries lie compiled, and runs
# the package's tests. Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
export PYO3_PYTHON=$PWD/.venv/bin/python PYO3_BUILD_EXTENSION_MODULE=1
# All packages with a test: alone it would choose other features for shared libraries, and compile them once more.
cargo build --workspace --lib --test all "$@"
cp "${CARGO_TARGET_DIR:-target}/debug/lib_afmsweep.so" python/afmsweep/_afmsweep.abi3.so
PYTHONPATH=python .venv/bin/python -m pytest -q -W error::pytest.PytestWarning python/tests --doctest-modules python/afmsweep
