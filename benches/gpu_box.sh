#!/usr/bin/env bash
# Everything that is to be known of a GPU, in one call of a few minutes, on a machine without a compiler:
# whether the shader agrees with the CPU there, how fast it is, and what limits it.
#
#   benches/gpu_box.sh pack DIR    here: builds the programs and puts them, their libraries and this script in DIR
#   DIR/gpu_box.sh run OUT         there: eight files in OUT; QUICK=1 is a rehearsal on a software driver
set -euo pipefail

pack() {
    local box=$1
    cd "$(dirname "$0")/.."
    mkdir -p "$box/lib" "$box/scenes"
    cargo build --release
    # The paths of the programs, by cargo's own word.
    local built
    built=$(cargo test --release --no-run --test agree_gpu --message-format=json | grep '"name":"agree_gpu"' |
        grep -o '"executable":"[^"]*"' | cut -d'"' -f4)
    install -s "$built" "$box/agree_gpu"
    built=$(cargo bench --no-run --bench limits --message-format=json | grep '"name":"limits"' |
        grep -o '"executable":"[^"]*"' | cut -d'"' -f4)
    install -s "$built" "$box/limits"
    install -s "${CARGO_TARGET_DIR:-target}/release/afmsweep" "$box/afmsweep"
    # HDF5 and what it needs; the C library is the machine's own.
    ldd "$box/afmsweep" "$box/agree_gpu" | grep -oE '/[^ ]*/lib(hdf5|sz|aec|z|curl|ssl|crypto|nghttp2|idn2|psl|ssh2|rtmp|gssapi|krb5|k5crypto|com_err|krb5support|ldap|lber|zstd|brotli|unistring|hogweed|nettle|gnutls|gmp|keyutils|sasl2|p11-kit|tasn1|ffi|db-)[^ ]*' |
        sort -u | xargs -r cp -L -t "$box/lib"
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
    "$box/agree_gpu" --test-threads 1 --nocapture 2>&1 | tee "$out/agree.log" || true
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
