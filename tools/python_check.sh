#!/usr/bin/env bash
# Runs a scene and opens its results, and made-up ones of every kind, with Python's readers. Holds statistics against
# SALib and SciPy, and the schema of scenes against all scenes there are, runs the examples of first steps and recipes, and
# builds the documents as pages.
# Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
# Builds the program beside the test, as the other tests do: `cargo build` alone would choose other
# features for shared dependencies and compile everything once more.
cargo test "$@" --test all --no-run
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# The pages' examples are mostly one thread's work, so they run beside the rest.
(
    for page in docs/first_steps.md docs/recipes.md; do
        .venv/bin/python tests/python/run_recipes.py "${CARGO_TARGET_DIR:-target}/debug/afmsweep" "$page"
    done
) &
pages=$!
for scene in tests/python/*.toml; do
    file=$folder/$(basename "$scene" .toml).h5
    "${CARGO_TARGET_DIR:-target}/debug/afmsweep" run "$scene" -q -o "$file"
    .venv/bin/python -W error tests/python/check_results.py "$file"
done
.venv/bin/python -W error tests/python/check_stats.py "${CARGO_TARGET_DIR:-target}/debug/afmsweep" tests/python/study/*.toml
"${CARGO_TARGET_DIR:-target}/debug/afmsweep" schema > "$folder/schema.json"
.venv/bin/python tests/python/check_schema.py "$folder/schema.json" .
tools/site.sh
wait "$pages"
AFMSWEEP_PYTHON=1 cargo test "$@" --test all store_python
