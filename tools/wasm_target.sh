#!/usr/bin/env bash
# Gets Rust's library for WebAssembly where it is missing and rustup can.
set -euo pipefail
target=wasm32-unknown-unknown
[ -d "$(rustc --print sysroot)/lib/rustlib/$target" ] || rustup target add "$target"
