#!/usr/bin/env bash
# Builds the engine of the web page (crates/web) for WebAssembly, packed, as target/web/engine.wasm.gz.
set -euo pipefail
cd "$(dirname "$0")/.."

target=wasm32-unknown-unknown
tools/wasm_target.sh || {
    echo "Rust's library for $target is missing: install it (rustup target add $target)" >&2
    exit 1
}
# As a library for Rust as well it would be linked without the optimization between crates, a quarter larger.
cargo rustc -p afmsweep-web --lib --target "$target" --profile web --crate-type cdylib
built=${CARGO_TARGET_DIR:-target}/$target/web/afmsweep_web.wasm
mkdir -p target/web
gzip -9 -n -c "$built" > target/web/engine.wasm.gz
echo "target/web/engine.wasm.gz: $(wc -c < target/web/engine.wasm.gz) bytes"
