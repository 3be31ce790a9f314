#!/usr/bin/env bash
# The whole precision bench: makes Python's environment, runs every solver and writes results/precision.
# Arguments go to the bench; `make peers` calls this. About half an hour on a busy machine.
set -euo pipefail
cd "$(dirname "$0")/../.."
requirements=benches/precision/requirements.txt
python=target/peers/bin/python
if [ ! -x "$python" ] || ! cmp -s "$requirements" target/peers/requirements.txt; then
    tools/venv.sh target/peers "$requirements"
    cp "$requirements" target/peers/requirements.txt
fi
cargo bench --features peers --bench precision -- --python "$PWD/$python" --command "make peers" -o results/precision "$@"
