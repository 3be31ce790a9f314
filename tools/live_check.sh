#!/usr/bin/env bash
# Tries the web page: its engine's numbers against the program's, the types of its scripts, the page itself in Chromium.
# target/web/engine.wasm.zst is there. Needs node, npm and Chromium, which it installs where it may. Arguments go to cargo.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/apt.sh
program=${CARGO_TARGET_DIR:-target}/debug/afmsweep
engine=target/web/engine.wasm.zst
# The program beside the test, as tools/python_check.sh has it: no library is compiled twice.
cargo test "$@" --test all --no-run

missing=()
command -v npm >/dev/null || missing+=(nodejs npm)
command -v chromium >/dev/null || missing+=(chromium)
if [ ${#missing[@]} -gt 0 ]; then
    { can_install && install_packages "${missing[@]}"; } || {
        echo "the check of the web page needs ${missing[*]}" >&2
        exit 1
    }
fi
zstd -d -q -f "$engine" -o target/web/engine.wasm
# One thread's work, so it runs beside the page's own tests.
.venv/bin/python tests/python/live_engine.py "$program" target/web/engine.wasm &
numbers=$!
mkdir -p target/web/test
cp crates/web/test/package.json target/web/test/
npm install --prefix target/web/test --no-package-lock --no-audit --no-fund --silent
for config in page/tsconfig page/tsconfig.worker explore/tsconfig; do
    target/web/test/node_modules/.bin/tsc --project "crates/web/$config.json"
done
"$program" live --engine "$engine" -o target/web/live.html
export NODE_PATH=$PWD/target/web/test/node_modules
node crates/web/test/browser.mjs target/web/live.html target/web/engine.wasm
# Pages of results: a grid, a list, and a grid with an axis of names.
for scene in quickstart samples phase_at_setpoint; do
    "$program" -q run "scenes/$scene.toml" -o "target/web/$scene.h5" --overwrite
    "$program" -q report "target/web/$scene.h5" --engine "$engine"
done
node crates/web/test/explore.mjs target/web/{quickstart,samples,phase_at_setpoint}/explore.html
wait "$numbers"
