"""What the documents and the examples show runs as it stands, and prints what they say.

With AFMSWEEP_WRITE set, what is printed is written into the documents.
"""

import os
import re
import subprocess
import sys

import pytest
from conftest import ROOT

EXAMPLES = ROOT / "examples" / "python"


def environment(**more):
    paths = [str(ROOT / "python"), os.environ.get("PYTHONPATH", "")]
    quiet = {"PYTHONWARNINGS": "ignore", "MPLBACKEND": "Agg"}
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths)), **quiet, **more}


def ran(words, folder, **more):
    done = subprocess.run(
        [sys.executable, *map(str, words)], cwd=folder, env=environment(**more), capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def blocks(text):
    """Blocks of Python; those that name a library first need it."""
    return re.findall(r"^```python(?: (\w+))?\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["docs/python.md", "python/README.md"])
def test_pages_print_what_they_say(page, tmp_path):
    text = (ROOT / page).read_text(encoding="utf-8")
    found = [code for library, code in blocks(text) if not library]
    assert found
    # One process, as a reader has one session; a line of its own parts the outputs.
    code = "\n".join(f"{one}\nprint('--')" for one in found)
    printed = ran(["-c", code], tmp_path).split("--\n")
    for code, output in zip(found, printed, strict=False):
        said = [line for line in re.findall(r"^print\(.*?\)(?:  +# (.*))?$|^# (.*)$", code, re.MULTILINE)]
        said = [one or other for one, other in said if one or other]
        if "AFMSWEEP_WRITE" in os.environ and said != output.splitlines():
            fresh = iter(output.splitlines())
            text = text.replace(code, re.sub(r"^# .*$", lambda _: f"# {next(fresh)}", code, flags=re.MULTILINE))
            (ROOT / page).write_text(text, encoding="utf-8")
        else:
            assert output.splitlines() == said, code


def test_the_readme_in_python(tmp_path, command):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    scene = re.search(r"^```toml\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[1]
    (tmp_path / "lever.toml").write_text(scene, encoding="utf-8")
    (tmp_path / "results").mkdir()
    command("run", tmp_path / "lever.toml", "-q", "-o", tmp_path / "results" / "lever.h5")
    found = blocks(text)
    assert found
    for _, code in found:
        pytest.importorskip("matplotlib")
        ran(["-c", code], tmp_path)


@pytest.mark.parametrize(
    ("name", "library", "code"),
    [
        ("saltelli", "SALib", "assert saltelli.main(256) < 0.1"),
        ("posterior", "emcee", "mean, sd = posterior.main()\nassert abs(mean[0] - 2.7e9) < 3 * sd[0]"),
        ("fit_curve", "scipy", "found, spread = fit_curve.main()\nassert abs(found[0] - 2.2) < 3 * spread[0]"),
        (
            "shares",
            "distributed",
            "import sys\nif __name__ == '__main__':\n    one = dict(n_workers=2, threads_per_worker=1, dashboard_address=None)\n    data = shares.main('here', **one)\n    import afmsweep\n    whole = afmsweep.run(shares.SWEEP, audit=0)\n    assert whole.amplitude.equals(data.amplitude)",
        ),
    ],
)
def test_examples(name, library, code, tmp_path):
    pytest.importorskip(library)
    script = tmp_path / "script.py"
    script.write_text(f"import sys\nsys.path.insert(0, {str(EXAMPLES)!r})\nimport {name}\n{code}\n", encoding="utf-8")
    ran([script], tmp_path)


@pytest.mark.parametrize("name", sorted(file.stem for file in (ROOT / "docs" / "notebooks").glob("*.ipynb")))
def test_notebooks_print_what_they_say(name, tmp_path):
    pytest.importorskip("matplotlib")
    ran([ROOT / "tools" / "run_notebooks.py", ROOT / "docs" / "notebooks" / f"{name}.ipynb"], tmp_path)


def test_the_job_array(tmp_path):
    import numpy as np
    import xarray as xr

    rng = np.random.default_rng(3)
    rows = {"sample.youngs_modulus": rng.uniform(1e9, 3e9, 50), "instrument.tip.radius": rng.uniform(8e-9, 9e-9, 50)}
    np.savez(tmp_path / "rows.npz", **rows)
    array = EXAMPLES / "job_array.py"
    for number in ("1", "2", "3"):
        ran([array, "run", "rows.npz", "results"], tmp_path, SLURM_ARRAY_TASK_ID=number, SLURM_ARRAY_TASK_COUNT="3")
    ran([array, "gather", "results", "all.nc"], tmp_path)
    with xr.open_dataset(tmp_path / "all.nc") as data:
        assert np.array_equal(data.tip_radius, rows["instrument.tip.radius"])
