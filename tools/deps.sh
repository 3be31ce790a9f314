#!/usr/bin/env bash
# Sees to what a build needs besides Rust: a C linker and the HDF5 library, or with STATIC=1 a cmake to
# build HDF5 with. Installs what is missing where it may, and otherwise says what to do. Silent and
# without a network where nothing is missing.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/apt.sh

# The places in which the build looks for HDF5.
have_hdf5() {
    [ -n "${HDF5_DIR:-}" ] && [ -e "$HDF5_DIR/include/H5pubconf.h" ] && return
    for name in hdf5 hdf5-serial; do
        command -v pkg-config >/dev/null && pkg-config --exists "$name" && return
    done
    for folder in /usr/include/hdf5/serial /usr/include /usr/local/include /opt/homebrew/include; do
        # Debian and Fedora give the header a suffix with the word size.
        ls "$folder"/H5pubconf*.h >/dev/null 2>&1 && return
    done
    command -v h5cc >/dev/null && h5cc -showconfig >/dev/null 2>&1
}

new_enough_cmake() {
    local version
    version=$(cmake --version 2>/dev/null | sed -n 's/^cmake version //p') || return
    [ -n "$version" ] && [ "$(printf '%s\n' 3.26 "$version" | sort -V | head -1)" = 3.26 ]
}

if ! command -v cargo >/dev/null; then
    echo "error: no cargo; install Rust from https://rustup.rs" >&2
    exit 1
fi
if ! command -v cc >/dev/null; then
    can_install && install_packages gcc libc6-dev || {
        echo "error: no C compiler (cc), which Rust links with; install gcc or clang" >&2
        exit 1
    }
fi

if [ -n "${STATIC:-}" ]; then
    new_enough_cmake || {
        echo "building HDF5 needs cmake 3.26 or newer; putting one into target/cmake"
        tools/venv.sh target/cmake cmake
    }
    exit 0
fi

have_hdf5 && exit 0
if can_install && install_packages libhdf5-dev hdf5-tools pkg-config && have_hdf5; then
    exit 0
fi
cat >&2 <<'END'
error: no HDF5 library with its headers was found, and none could be installed.
Either install it and try again:
    Debian, Ubuntu   sudo apt-get install libhdf5-dev hdf5-tools
    Fedora           sudo dnf install hdf5-devel hdf5
    macOS            brew install hdf5
    elsewhere        set HDF5_DIR to the folder that has HDF5's include/ and lib/
or let the build make its own (3 minutes more; needs cmake 3.26 or newer, which pip has):
    python3 -m venv target/cmake && target/cmake/bin/pip install cmake
    PATH="$PWD/target/cmake/bin:$PATH" cargo build --release --features static-hdf5
which is what STATIC=1 does with every target of the Makefile, as in
    make demo STATIC=1
END
exit 1
