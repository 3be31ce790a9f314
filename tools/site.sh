#!/usr/bin/env bash
# Builds the documents as pages, and fails where one of their links leads nowhere.
set -euo pipefail
cd "$(dirname "$0")/.."
source=target/site_source
rm -rf "$source"
mkdir -p "$source"
# What the documents link to, where they expect it. README.md is a folder's first page.
while read -r file; do
    target=$source/${file%README.md}
    [ "$target" = "$source/$file" ] || target=${target}index.md
    mkdir -p "$(dirname "$target")"
    sed 's/README\.md\([)#]\)/index.md\1/g' "$file" >"$target"
done < <(git ls-files '*.md')
while read -r file; do
    mkdir -p "$source/$(dirname "$file")"
    cp "$file" "$source/$file"
done < <(git ls-files '*.svg' '*.png' '*.csv' '*.json' '*.ipynb' 'LICENSE*' 'scenes/*' 'tests/hard/*' 'tests/clusters/*' 'examples/*' 'benches/*' 'src/*' 'crates/*' 'CITATION.cff' | grep -v '\.md$')
cp tools/site.css "$source/"
# Without its warnings it would not fail on them.
log=target/site.log
if ! "${PYTHON:-.venv/bin/python}" -m mkdocs build --strict --config-file mkdocs.yml >"$log" 2>&1; then
    grep -v '^INFO' "$log" >&2
    exit 1
fi
# The live page, where its engine is built.
program=${CARGO_TARGET_DIR:-target}/release/afmsweep
if [ -f target/web/engine.wasm.zst ] && [ -x "$program" ]; then
    "$program" -q live --engine target/web/engine.wasm.zst -o target/site/live.html
fi
echo "site: target/site/index.html"
