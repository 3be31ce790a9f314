"""Runs the cells of notebooks in their order, each notebook in a namespace and a folder of its own.

    run_notebooks.py [--write] NOTEBOOK...

Ends with 1 where a cell prints something else than the notebook has; with --write that is put in its place. Pictures are
drawn and not kept.
"""

import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path

os.environ["MPLBACKEND"] = "Agg"


def run(file: Path, write: bool) -> list[str]:
    notebook, scope, wrong = json.loads(file.read_text(encoding="utf-8")), {"__name__": "__main__"}, []
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for count, cell in enumerate(code, 1):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("".join(cell["source"]), f"{file.name}[{count}]", "exec"), scope)
        lines = printed.getvalue().splitlines(keepends=True)
        outputs = [{"name": "stdout", "output_type": "stream", "text": lines}] if lines else []
        if cell["outputs"] != outputs:
            wrong.append(f"{file.name}, cell {count} prints\n{printed.getvalue()}")
        cell["outputs"], cell["execution_count"] = outputs, count
    if write:
        file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        return []
    return wrong


if __name__ == "__main__":
    write = "--write" in sys.argv
    files = [Path(word).resolve() for word in sys.argv[1:] if word != "--write"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        wrong = [line for file in files for line in run(file, write)]
    sys.exit("\n".join(wrong) or 0)
