"""Runs the examples of a page (first_steps.md, recipes.md) as they stand, in their order, in a folder of their own.

    python run_recipes.py PROGRAM PAGE

Blocks of shell and Python are run, blocks of TOML are written under the name that follows the word. A comment after a
`print` that is a line of its own is what it must print. With AFMSWEEP_WRITE set, it is written there instead.
Each line of a block of text must be a line of what the last block of shell printed, in this order; `...` in it stands
for anything. Blocks of `console` are for the reader alone.
"""

import os
import re
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path

# Every block imports some of these, and one of them takes two seconds to load.
os.environ["MPLBACKEND"] = "Agg"
import matplotlib.pyplot  # noqa: F401, E402
import SALib  # noqa: F401, E402
import xarray  # noqa: F401, E402


def expected(code):
    """What the block says that it prints: comments at the left margin."""
    return [line[2:] for line in code.splitlines() if line.startswith("# ")]


def shown(text, output):
    """The lines of a block of text that the output does not have, in its order."""
    lines, missing = iter(output.splitlines()), []
    for wanted in text.splitlines():
        pattern = ".*".join(re.escape(part) for part in wanted.split("..."))
        if wanted.strip() != "..." and not any(re.fullmatch(pattern, line) for line in lines):
            missing.append(wanted)
            break
    return missing


def run_python(code, folder, environment):
    """Runs a block in a process of its own that has the libraries of all blocks already; returns what it prints."""
    with tempfile.TemporaryFile() as out:
        child = os.fork()
        if child == 0:
            os.dup2(out.fileno(), 1)
            os.chdir(folder)
            os.environ.update(environment)
            try:
                exec(compile(code, "block", "exec"), {"__name__": "__main__"})
                sys.stdout.flush()
                os._exit(0)
            except BaseException:
                traceback.print_exc()
                os._exit(1)
        _, status = os.waitpid(child, 0)
        assert status == 0, code
        out.seek(0)
        return out.read().decode()


def main(program, page):
    program, text = Path(program).resolve(), Path(page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) > 10, len(blocks)
    prints, output = 0, ""
    with tempfile.TemporaryDirectory() as folder:
        paths = os.pathsep.join([str(program.parent), str(Path(sys.executable).parent), os.environ["PATH"]])
        environment = {**os.environ, "PATH": paths}
        for kind, name, code in blocks:
            if kind == "toml":
                Path(folder, name).write_text(code, encoding="utf-8")
                continue
            if kind == "console":
                continue
            if kind == "text":
                assert not (missing := shown(code, output)), f"{missing} is not in\n{output}"
                prints += len(code.splitlines())
                continue
            if kind == "sh":
                # What a shell shows is both streams, as they come.
                streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
                command = ["bash", "-euo", "pipefail", "-c", code]
                done = subprocess.run(command, cwd=folder, env=environment, text=True, **streams)
                assert done.returncode == 0, f"{code}\n{done.stdout}"
                output = done.stdout
            else:
                assert kind == "python", kind
                said = run_python(code, folder, environment).splitlines()
                if "AFMSWEEP_WRITE" in os.environ:
                    lines, fresh = code.splitlines(), iter(said)
                    fresh = [f"# {next(fresh)}" if line.startswith("# ") else line for line in lines]
                    changed = "".join(f"{line}\n" for line in fresh)
                    text, code = text.replace(code, changed), changed
                assert said == expected(code), f"{code}\nprints {said}"
                prints += len(said)
    assert prints > 8, prints
    if "AFMSWEEP_WRITE" in os.environ:
        Path(page).write_text(text, encoding="utf-8")
    print(f"{Path(page).name}: {len(blocks)} blocks, {prints} lines printed as they say")


if __name__ == "__main__":
    main(*sys.argv[1:])
