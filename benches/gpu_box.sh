#!/usr/bin/env bash
# Everything that is to be known of a GPU, in one call of a few minutes, on a machine without a compiler:
# whether the shader agrees with the CPU there, how fast it is, and what limits it.
#
#   benches/gpu_box.sh pack DIR    here: builds the programs and puts them, their libraries and this script in DIR
#   DIR/gpu_box.sh run OUT         there: eight files in OUT; QUICK=1 is a rehearsal on a software driver
set -euo pipefail

# The executable of that name in cargo's messages.
made() {
    grep "\"name\":\"$1\"" | grep -o '"executable":"[^"]*"' | cut -d'"' -f4
}

pack() {
    local box=$1
    cd "$(dirname "$0")/.."
    mkdir -p "$box/lib" "$box/scenes"
    cargo build --release
    # The paths of the other programs, by cargo's own word.
    install -s "$(cargo test --release --no-run --test gpu --message-format=json | made gpu)" "$box/gpu"
    install -s "$(cargo bench --no-run --bench limits --message-format=json | made limits)" "$box/limits"
    install -s "${CARGO_TARGET_DIR:-target}/release/afmsweep" "$box/afmsweep"
    # HDF5 and what it needs; the C library is the machine's own.
    ldd "$box/afmsweep" | grep -o '/[^ ]*' | grep -vE '/(ld-linux|lib(c|m|dl|rt|pthread|gcc_s|resolv))[-.]' |
        xargs -r cp -L -t "$box/lib"
    cp scenes/quickstart.toml scenes/paper_fig4_*.toml "$box/scenes"
    cp benches/gpu_box.sh "$box/"
    du -sh "$box"
}

run() {
    local out box quick=${QUICK:-}
    box=$(cd "$(dirname "$0")" && pwd)
    mkdir -p "$1"
    out=$(cd "$1" && pwd)
    export LD_LIBRARY_PATH="$box/lib:${LD_LIBRARY_PATH:-}"
    export NODEVICE_SELECT=1
    local program=$box/afmsweep sizes=1000,10000,100000,1000000 instances=1048576
    [ -z "$quick" ] || { sizes=1000,4000 instances=4096; }
    "$program" devices --json | tee "$out/devices.json"
    # The steps go on if one fails: what the others find is wanted all the same.
    { timeout 200 "$box/gpu" --test-threads 1 --nocapture 2>&1 || true; } | tee "$out/agree.log"
    for scene in quickstart paper_fig4_hertz paper_fig4_dmt paper_fig4_jkr; do
        timeout 100 "$program" check "$box/scenes/$scene.toml" -i 6 2>&1 || true
    done | tee "$out/check.log"
    timeout 170 "$box/limits" --gpu --instances $instances --seconds ${quick:+0.}1 -o "$out/limits.json" || true
    timeout 150 "$program" bench "$box/scenes/quickstart.toml" --backend cpu,gpu --sizes $sizes --compared 12 -o "$out/bench" || true
}

case "${1:-}:${2:-}" in
    pack:?*) pack "$2" ;;
    run:?*) run "$2" ;;
    *) sed -n '2,6s/^# \{0,1\}//p' "$0" && exit 2 ;;
esac
