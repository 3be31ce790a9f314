"""Damages results files and looks at what `report` and `check` make of them.

    python fuzz_files.py PROGRAM [--cases N] [--seed N] [--keep FOLDER]

Files of every kind (grid, list, searched with both branches, waveforms with times of their own) are flipped,
overwritten, cut, spliced with each other and shifted. Of each damaged file `report` makes a page; every twentieth
goes to `check` as well. A failure is:

    panic    the program panics or dies of a signal
    hang     it takes longer than a minute
    memory   it takes more than 1 GB
    silent   it ends with 0 and says nothing, and the page, a picture or the table of `check` is not that of the
             undamaged file
    wordless it ends with an error code and not exactly one line that says why

The exit code is 0 only if there is none. Needs nothing but Python.
"""

import argparse
import collections
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

SECONDS = 60
MEGABYTES = 1000
CHECK_EVERY = 20

HEAD = """
title = "Fuzz"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 60
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
[sample]
youngs_modulus = "2 GPa"
poisson_ratio = 0.34
surface_energy = "66 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "17 nm"
"""
TAIL = """
[output]
observables = ["amplitude", "phase", "force_max", "indentation_max", "dissipation", "harmonic_amplitude"]
"""
SCENES = {
    "grid": HEAD
    + """
[sweep]
"sample.youngs_modulus" = { from = "500 MPa", to = "5 GPa", points = 4, scale = "log" }
"approach.gap" = { values = ["14 nm", "16 nm", "18 nm"] }
[run]
periods = 120
measure = 10
"""
    + TAIL,
    "list": HEAD
    + """
[samples]
"sample.youngs_modulus" = ["1 GPa", "2 GPa", "3 GPa", "4 GPa", "5 GPa"]
"approach.gap" = ["14 nm", "15 nm", "16 nm", "17 nm", "18 nm"]
[run]
periods = 120
measure = 10
"""
    + TAIL,
    "searched": HEAD.replace("quality_factor = 60", "quality_factor = 400")
    + """
[sweep]
"approach.gap" = { from = "14 nm", to = "19.5 nm", points = 12 }
[run]
steady = "search"
branches = "both"
periods = 300
"""
    + TAIL,
    "waveforms": HEAD.replace('frequency = "resonance"', 'frequency = "299 kHz"')
    + """
[sweep]
"drive.frequency" = { values = ["298 kHz", "299 kHz", "300 kHz"] }
[run]
periods = 120
measure = 10
"""
    + TAIL
    + "waveforms = { instances = [0, 1, 2], samples_per_period = 64, periods = 2 }\n"
    + "spectra = { instances = [2, 0] }\n",
}


class Ran:
    """A call of the program: its exit code, what it said and what it took."""

    def __init__(self, command, folder):
        with open(folder / "out", "wb") as out, open(folder / "err", "wb") as err:
            process = subprocess.Popen(command, stdout=out, stderr=err, stdin=subprocess.DEVNULL)
            end, self.hung = time.monotonic() + SECONDS, False
            while True:
                done, status, usage = os.wait4(process.pid, os.WNOHANG)
                if done:
                    break
                if time.monotonic() > end and not self.hung:
                    self.hung = True
                    process.kill()
                time.sleep(0.002)
            process.returncode = self.code = os.waitstatus_to_exitcode(status)
        self.megabytes = usage.ru_maxrss / 1024
        self.out = (folder / "out").read_bytes()
        self.err = (folder / "err").read_text(errors="replace")

    def fault(self):
        """What no input may lead to."""
        if self.hung:
            return "hang"
        if self.code < 0 or self.code == 101 or "panicked" in self.err:
            return "panic"
        if self.megabytes > MEGABYTES:
            return "memory"
        if self.code != 0 and not self.err.strip():
            return "wordless"
        return None


def pages(folder):
    """All that a report has made."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())} if folder.is_dir() else {}


def clear(folder):
    for path in folder.iterdir() if folder.is_dir() else []:
        path.unlink()
    if folder.is_dir():
        folder.rmdir()


def damage(whole, others, chance):
    """Damaged bytes, and in words what was done to them."""
    spoilt = bytearray(whole)
    size = len(spoilt)
    kind = chance.choice(["flip", "flip", "flips", "byte", "block", "block", "cut", "splice", "graft", "shift", "swap"])
    at = chance.randrange(size)
    if kind in ("flip", "flips"):
        for _ in range(1 if kind == "flip" else chance.randrange(2, 40)):
            spoilt[at] ^= 1 << chance.randrange(8)
            at = chance.randrange(size)
    elif kind == "byte":
        spoilt[at] = chance.randrange(256)
    elif kind == "block":
        length = min(chance.choice([4, 8, 16, 64, 512, 4096]), size - at)
        fill = chance.choice([lambda: bytes(length), lambda: b"\xff" * length, lambda: chance.randbytes(length)])
        spoilt[at : at + length] = fill()
    elif kind == "cut":
        del spoilt[at:]
    elif kind == "splice":
        spoilt = bytearray(whole[:at] + chance.choice(others)[at:])
    elif kind == "graft":
        other = chance.choice(others)
        length = chance.choice([64, 512, 4096])
        begin = chance.randrange(len(other))
        spoilt[at : at + length] = other[begin : begin + length]
        del spoilt[size:]
    elif kind == "shift":
        length = chance.randrange(1, 64)
        spoilt = bytearray(whole[:at] + (chance.randbytes(length) + whole[at:] if chance.random() < 0.5 else whole[at + length :]))
    else:
        length = min(chance.choice([8, 64, 512]), size - at)
        to = chance.randrange(size - length + 1)
        spoilt[at : at + length], spoilt[to : to + length] = whole[to : to + length], whole[at : at + length]
    return bytes(spoilt), f"{kind} at {at}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--cases", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", help="folder for the files that failed")
    options = parser.parse_args()
    program, chance = os.path.abspath(options.program), random.Random(options.seed)
    counts, failed = collections.Counter(), []
    largest = slowest = 0.0
    with tempfile.TemporaryDirectory() as home:
        home = pathlib.Path(home)
        file, page = home / "a.h5", home / "page"
        report, check = [program, "report", str(file), "-o", str(page)], [program, "check", "-i", "1", str(file)]
        originals, truths, checks = {}, {}, {}
        for name, scene in SCENES.items():
            (home / "a.toml").write_text(scene)
            run = Ran([program, "run", "-q", "--overwrite", str(home / "a.toml"), "-o", str(file)], home)
            made = Ran(report, home)
            if run.code or made.code:
                sys.exit(f"{name}: the undamaged file failed: {run.err}{made.err}")
            originals[name], truths[name], checks[name] = file.read_bytes(), pages(page), Ran(check, home)
            clear(page)
        for number in range(options.cases):
            name = chance.choice(list(SCENES))
            others = [bytes for other, bytes in originals.items() if other != name]
            spoilt, what = damage(originals[name], others, chance)
            # Spliced where all files begin alike, it is one of the others, whole.
            if spoilt in originals.values():
                counts["not damaged"] += 1
                continue
            file.write_bytes(spoilt)
            calls = [("report", report)] + ([("check", check)] if number % CHECK_EVERY == 0 else [])
            for word, command in calls:
                start = time.monotonic()
                ran = Ran(command, home)
                slowest, largest = max(slowest, time.monotonic() - start), max(largest, ran.megabytes)
                outcome = ran.fault()
                if outcome is None and word == "report":
                    lines = ran.err.strip().splitlines()
                    if ran.code:
                        outcome = "refused" if len(lines) == 1 else "wordless"
                    elif pages(page) == truths[name]:
                        outcome = "unchanged"
                    else:
                        outcome = "told" if len(lines) > 1 else "silent"
                    clear(page)
                elif outcome is None:
                    same = (ran.code, ran.out) == (checks[name].code, checks[name].out)
                    outcome = "unchanged" if same else "refused" if ran.code else "silent"
                counts[f"{word} {outcome}"] += 1
                if outcome in ("panic", "hang", "memory", "silent", "wordless"):
                    failed.append(f"case {number}, {name}, {what}, {word}: {outcome}: {ran.err.strip()[:300]}")
                    if options.keep:
                        kept = pathlib.Path(options.keep)
                        kept.mkdir(parents=True, exist_ok=True)
                        (kept / f"{number}_{name}.h5").write_bytes(spoilt)
    for outcome, count in sorted(counts.items()):
        print(f"{count:6} {outcome}")
    print(f"largest {largest:.0f} MB, slowest {slowest:.1f} s, seed {options.seed}")
    print("\n".join(failed))
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
