#!/usr/bin/env bash
# Every shader through a real GPU's compiler that needs no GPU: Mesa's RADV, told to compile for AMD's Navi 21.
# Usage: tools/gpu_compiler.sh [OPTION...]   (options of the bench `gpu_compiler`)
set -euo pipefail
cd "$(dirname "$0")/.."

driver=$(ls /usr/share/vulkan/icd.d/radeon_icd*.json 2>/dev/null | head -n 1 || true)
if [ -z "$driver" ]; then
    echo "no RADV here: install Mesa's Vulkan drivers (Debian and Ubuntu: apt install mesa-vulkan-drivers)" >&2
    exit 1
fi
# Loaders before 1.3.207 know the first name only. A cache on disk would hide what a compilation takes.
export VK_ICD_FILENAMES=$driver VK_DRIVER_FILES=$driver RADV_FORCE_FAMILY=navi21 RADV_DEBUG=nocache
# The tests' profile: their libraries are compiled already.
exec cargo bench --profile dev --bench gpu_compiler -- "$@"
