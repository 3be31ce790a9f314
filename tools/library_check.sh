#!/usr/bin/env bash
# The library alone, from an empty project: on the CPU, with results in memory, without GPU, HDF5, pictures or program.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
project=$(mktemp -d)
trap 'rm -rf "$project"' EXIT

cd "$project"
mkdir src
cat >Cargo.toml <<TOML
[package]
name = "stranger"
version = "0.1.0"
edition = "2024"
[dependencies]
afmsweep = { path = "$root", default-features = false }
TOML
cp "$root/Cargo.lock" .
cp "$root/examples/tapping.rs" src/main.rs

# What the library brings along.
unwanted=$(cargo tree --prefix none -e normal | grep -E "^(wgpu|naga|hdf5|png|clap|anyhow|indicatif)" || true)
[ -z "$unwanted" ] || { echo "the library alone depends on: $unwanted" >&2; exit 1; }

# Nothing warns, either: code that only the program uses would be left over here. Nobody debugs it.
RUSTFLAGS="${RUSTFLAGS:-} -D warnings" CARGO_PROFILE_DEV_DEBUG=false \
    CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target/library} cargo run -q >answer.txt
cat answer.txt
# Nine samples, each with its line; a stiffer one is hit harder.
[ "$(awk 'NR > 1 && NF == 4' answer.txt | wc -l)" = 9 ]
awk 'NR > 1 && NF == 4 { if ($4 <= last) exit 1; last = $4 }' answer.txt
