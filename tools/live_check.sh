#!/usr/bin/env bash
# Tries the web page: its engine's numbers against the program's, the types of its scripts, the page itself in Chromium.
# The program and target/web/engine.wasm.gz are there. Needs node, npm and Chromium, which it installs where it may.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/apt.sh
program=${CARGO_TARGET_DIR:-target}/debug/afmsweep
engine=target/web/engine.wasm.gz

missing=()
command -v npm >/dev/null || missing+=(nodejs npm)
command -v chromium >/dev/null || missing+=(chromium)
if [ ${#missing[@]} -gt 0 ]; then
    { can_install && install_packages "${missing[@]}"; } || {
        echo "the check of the web page needs ${missing[*]}" >&2
        exit 1
    }
fi
.venv/bin/python tests/python/live_engine.py "$program" "$engine"
mkdir -p target/web/test
cp crates/web/test/package.json target/web/test/
npm install --prefix target/web/test --no-package-lock --no-audit --no-fund --silent
for config in tsconfig tsconfig.worker; do
    target/web/test/node_modules/.bin/tsc --project "crates/web/page/$config.json"
done
"$program" live --engine "$engine" -o target/web/live.html
gunzip -c "$engine" >target/web/engine.wasm
NODE_PATH=$PWD/target/web/test/node_modules node crates/web/test/browser.mjs target/web/live.html target/web/engine.wasm
