#!/usr/bin/env bash
# venv.sh FOLDER REQUIREMENTS: a Python environment with a requirements file, or with one package.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/apt.sh
folder=$1 wanted=$2

if ! command -v python3 >/dev/null; then
    can_install && install_packages python3 python3-venv || {
        echo "error: no python3; install it" >&2
        exit 1
    }
fi

# A folder that a failed try has left is no environment.
rm -rf "$folder"
make_environment() {
    python3 -m venv "$folder" 2>/dev/null && return
    rm -rf "$folder"
    # Debian keeps the module in a package of its own.
    can_install && install_packages python3-venv && python3 -m venv "$folder" && return
    rm -rf "$folder"
    python3 -m virtualenv -q "$folder" 2>/dev/null && return
    python3 -m pip install -q --user virtualenv 2>/dev/null && python3 -m virtualenv -q "$folder"
}
if ! make_environment; then
    rm -rf "$folder"
    echo "error: python3 cannot make a virtual environment; install python3-venv (Debian, Ubuntu) or virtualenv" >&2
    exit 1
fi
if [ -f "$wanted" ]; then
    packages=(-r "$wanted")
else
    packages=("$wanted")
fi
if ! "$folder/bin/python" -m pip install -q --no-compile --disable-pip-version-check "${packages[@]}"; then
    rm -rf "$folder"
    echo "error: pip could not install $wanted; see its message above" >&2
    exit 1
fi
