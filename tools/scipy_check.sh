#!/usr/bin/env bash
# Holds the reference engine against SciPy's integrators. Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
# Builds the program beside a test, for the reason given in python_check.sh.
cargo test "$@" --test all --no-run
target/scipy/bin/python -W error tests/python/reference_scipy.py \
    "${CARGO_TARGET_DIR:-target}/debug/afmsweep" tests/python/reference/*.toml
target/scipy/bin/python -W error tests/python/pyramid_half_space.py
target/scipy/bin/python -W error tests/python/layer_contact.py "${CARGO_TARGET_DIR:-target}/debug/afmsweep"
