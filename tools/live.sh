#!/usr/bin/env bash
# Builds the engine of the web page (crates/web) for WebAssembly, packed, as target/web/engine.wasm.zst.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/apt.sh

target=wasm32-unknown-unknown
tools/wasm_target.sh || {
    echo "Rust's library for $target is missing: install it (rustup target add $target)" >&2
    exit 1
}
command -v zstd >/dev/null || { can_install && install_packages zstd; } || {
    echo "the engine is packed by zstd: install it (apt-get install zstd)" >&2
    exit 1
}
# As a library for Rust as well it would be linked without the optimization between crates, a quarter larger.
cargo rustc -p afmsweep-web --lib --target "$target" --profile web --crate-type cdylib
built=${CARGO_TARGET_DIR:-target}/$target/web/afmsweep_web.wasm
mkdir -p target/web
# Its code repeats itself over more than the 32 KiB that gzip looks back: so packed it is three quarters of gzip's size.
zstd --ultra -22 -q -f "$built" -o target/web/engine.wasm.zst
echo "target/web/engine.wasm.zst: $(wc -c < target/web/engine.wasm.zst) bytes"
