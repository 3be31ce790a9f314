#!/usr/bin/env bash
# Builds a wheel for Linux into target/wheels, and tries it in an empty environment: a run, and the command.
set -euo pipefail
cd "$(dirname "$0")/.."
# Tools for wheels are no part of the tests' environment.
[ -x target/maturin/bin/maturin ] || tools/venv.sh target/maturin "maturin>=1.9.4,<2"
target/maturin/bin/maturin build --release --manifest-path python/Cargo.toml --out target/wheels "$@"
wheel=$(ls -t target/wheels/afmsweep-*.whl | head -1)
tools/venv.sh target/wheel_trial "afmsweep @ file://$PWD/$wheel"
cd target/wheel_trial
bin/afmsweep init > lever.toml
bin/afmsweep run lever.toml -q -o lever.h5
bin/python - <<'PYTHON'
import warnings
import afmsweep

warnings.simplefilter("ignore", afmsweep.SceneWarning)
ours, theirs = afmsweep.run("lever.toml"), afmsweep.open("lever.h5")
assert ours.equals(theirs.assign_attrs(ours.attrs)), "the run is not what the command's file holds"
print(f"{ours.status.size} instances, as the command's file has them")
PYTHON
echo "$(du -h "$OLDPWD/$wheel" | cut -f1) $wheel"
