"""Turns bits over in results files and gives them to every command that reads one. Needs h5py.

results_bits.py PROGRAM [--flips 2000] [--seed 1]

Truth is what the commands say of the undamaged file. After each flip a command refuses the file in words, or says the same,
byte for byte: no flip goes unnoticed. Every other flip is of the file's first and last parts, where its names, lists of
chunks and texts lie: bits there are few beside those of the numbers.
"""

import argparse
import collections
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "clusters"))
from same import variables  # noqa: E402

HEAD = """
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sample]
surface_energy = "0 J/m^2"
"""
# Enough samples for chunks beside what lies in headers.
SAMPLES = HEAD + """
[approach]
gap = "16 nm"
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "0.5 GPa", to = "5 GPa" }
"approach.gap" = { distribution = "uniform", from = "15 nm", to = "19 nm" }
[design]
kind = "latin-hypercube"
samples = 640
"""
GRID = HEAD + """
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 8 }
"approach.gap" = { from = "15 nm", to = "19 nm", points = 4 }
[output]
waveforms = { instances = [0, 5], samples_per_period = 64 }
"""
SEARCH = '[run]\nsteady = "search"\n'
BOTH = 'branches = "both"\n'
# What is told of each file: words before it and after it, and every how many flips. `out` is a folder or a file that it makes.
COMMANDS = {
    "samples.h5": [
        ("export", ["--format", "csv"], 1),
        ("stats", ["--json"], 1),
        ("infer", ["--observed", "amplitude=16 nm +- 0.5 nm", "--json"], 1),
        ("cite", [], 1),
        ("export", ["--format", "salib", "-o", "out"], 4),
        ("report", ["-o", "out"], 20),
    ],
    "grid.h5": [("cite", [], 1), ("report", ["-o", "out"], 4), ("check", ["-i", "1"], 100)],
    "grid.1-of-2.h5": [("merge", ["grid.2-of-2.h5", "--no-audit", "-o", "out"], 1)],
}


def read(path):
    """A file, or all files of a folder, by their names."""
    if path.is_dir():
        return {one.name: one.read_bytes() for one in sorted(path.iterdir())}
    return path.read_bytes() if path.exists() else None


def say(program, command, file, words):
    """Exit code, what it said, and what it made."""
    out = pathlib.Path("out")
    shutil.rmtree(out) if out.is_dir() else out.unlink(missing_ok=True)
    done = subprocess.run([program, command, file, *words], capture_output=True, timeout=60)
    if command == "merge" and done.returncode == 0:
        # The merged file tells when it was made.
        made = variables("out")
    else:
        made = read(out)
    return done.returncode, done.stdout, done.stderr.decode(errors="replace"), made


def flip(draw, whole):
    """The file with a bit turned over, and which."""
    edge = min(8192, len(whole))
    place = draw.choice([draw.randrange(len(whole)), draw.randrange(edge), len(whole) - 1 - draw.randrange(edge)])
    bit = 8 * place + draw.randrange(8)
    damaged = bytearray(whole)
    damaged[bit // 8] ^= 1 << bit % 8
    return damaged, bit


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--flips", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    program = str(told.program.resolve())
    draw = random.Random(told.seed)
    table, wrong = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, scene in (("samples", SAMPLES + SEARCH), ("grid", GRID + SEARCH + BOTH)):
            pathlib.Path(f"{name}.toml").write_text(scene)
            subprocess.run([program, "run", f"{name}.toml", "-q", "--no-audit", "-o", f"{name}.h5"], check=True)
        subprocess.run([program, "prepare", "grid.toml", "-q", "-o", "choices"], check=True)
        for share in ("1", "2"):
            words = ["--shard", f"{share}/2", "--choices", "choices", "-o", f"grid.{share}-of-2.h5"]
            subprocess.run([program, "run", "grid.toml", "-q", "--no-audit", *words], check=True)
        whole = {file: pathlib.Path(file).read_bytes() for file in COMMANDS}
        truth = {}
        for file, commands in COMMANDS.items():
            for command, words, _ in commands:
                truth[file, command, *words] = said = say(program, command, file, words)
                if said[0] != 0:
                    wrong.append(f"{command} {file} fails: {said[2]}")
        for number in range(told.flips):
            file = list(COMMANDS)[number % len(COMMANDS)]
            damaged, bit = flip(draw, whole[file])
            pathlib.Path(file).write_bytes(damaged)
            for command, words, every in COMMANDS[file]:
                if number // len(COMMANDS) % every:
                    continue
                code, text, error, made = said = say(program, command, file, words)
                # Times and folders apart, what it says beside its answer may hang on nothing but the file.
                if (code, text, made) == tuple(truth[file, command, *words][n] for n in (0, 1, 3)):
                    table["the same"] += 1
                elif code == 1 and "error: " in error and "panicked" not in error:
                    table["refused"] += 1
                else:
                    expected = truth[file, command, *words]
                    apart = [n for n in range(4) if said[n] != expected[n]]
                    if isinstance(made, dict) and isinstance(expected[3], dict):
                        apart += [name for name in made.keys() | expected[3].keys() if made.get(name) != expected[3].get(name)]
                    wrong.append(f"bit {bit} of {file}: {command} ends with {code}, other parts {apart}: {error}")
            pathlib.Path(file).write_bytes(whole[file])
        os.chdir("/")
    sizes = ", ".join(f"{file} {len(bytes_)} B" for file, bytes_ in whole.items())
    print(f"{told.flips} bits of {sizes}: {dict(table)}; {len(wrong)} wrong")
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
