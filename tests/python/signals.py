"""Strikes runs with signals at random moments and checks what they leave. Needs h5py.

signals.py PROGRAM [--moments 60] [--seed 1] [--scene FILE]

Truth is the run of the same scene that no signal reaches: whatever a struck run calls done has that run's values to
the bit, an earlier whole file stays as it was, and the journal at the partial name, looked into by `export`, says what it
lacks; the run that goes on with it gives the whole file.
"""

import argparse
import collections
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

SCENE = """
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 450
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
[sample]
poisson_ratio = 0.34
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 20, scale = "log" }
"sample.surface_energy" = { from = "10 mJ/m^2", to = "100 mJ/m^2", points = 19 }
"approach.gap" = { from = "10 nm", to = "18 nm", points = 9 }
[run]
steady = "search"
branches = "both"
[output]
observables = ["amplitude", "phase", "force_max", "dissipation"]
waveforms = { instances = [0, 1000], samples_per_period = 64, periods = 2 }
"""
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
NOT_RUN = 5
PHASES = ["stepping", "refinement", "branches", "waveforms", "audit"]


def numbers(file):
    """The variables of the root that a run computes, and those of its second states, by name."""
    left_out = {"audit", "waveforms", "spectra", "force_curves", "provenance"}
    found = {}
    file.visititems(lambda name, one: found.update({name: one[...]} if isinstance(one, h5py.Dataset) else {}))
    return {name: data for name, data in found.items() if name.split("/")[0] not in left_out}


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def same(a, b):
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def compare(kept, whole, missing):
    """What of a partial file's instances is not as in the whole one."""
    wrong = []
    done = kept["status"] != NOT_RUN
    per_instance = [name for name in kept if "/" not in name and kept[name].shape[: done.ndim] == done.shape]
    for name in per_instance:
        if name not in whole or not same(kept[name][done], whole[name][done]):
            wrong.append(f"{name} differs from the whole run's")
    finished = not {"stepping", "refinement"} & set(missing)
    if finished != bool(done.all()):
        wrong.append(f"{(~done).sum()} instances not run, missing: {missing}")
    if "branches" not in missing:
        names = [name for name in whole if name.startswith("other_branch/")]
        if not all(name in kept and same(kept[name], whole[name]) for name in names):
            wrong.append("the second states differ")
    return wrong


def strike(program, folder, arguments, number, after):
    """Starts a run, sends it the signal after so long, and gives its exit code and words."""
    child = subprocess.Popen(
        [program, *arguments], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    time.sleep(after)
    if child.poll() is None:
        child.send_signal(number)
    began = time.monotonic()
    words = child.communicate()[1]
    return child.returncode, words, time.monotonic() - began


def goes_on(program, arguments, path, whole):
    """What is wrong with the file of the run that goes on with a journal."""
    done = subprocess.run([program, *arguments, "--resume"], cwd=path.parent, capture_output=True, text=True)
    if done.returncode:
        return [f"--resume: exit code {done.returncode}: {done.stderr}"]
    with h5py.File(path) as file:
        now = numbers(file)
    return [f"{name} differs after --resume" for name in whole if name not in now or not same(now[name], whole[name])]


def judge(strike_of, path, earlier, whole, again):
    """The phase that a struck run was in, and what is wrong with what it left. `again`: the program and its arguments."""
    code, number, words = strike_of
    program, arguments = again
    partial = path.with_name(path.name + ".partial")
    wrong = []
    if code == 0:
        if partial.exists():
            wrong.append("a partial file beside a whole one")
        with h5py.File(path) as file:
            if file.attrs["complete"] != 1:
                wrong.append("exit code 0 and not complete")
            now = numbers(file)
        wrong += [name for name in whole if name not in now or not same(now[name], whole[name])]
        return "whole", wrong
    if path.read_bytes() != earlier:
        wrong.append("the earlier whole file was replaced")
    if code == -number:
        # In the moment before the program listens.
        return "start", wrong + (["a partial file is left"] if partial.exists() else [])
    if code != 128 + number:
        wrong.append(f"exit code {code}")
    if not partial.exists():
        if "nothing was written" not in words:
            wrong.append(f"no partial file: {words!r}")
        return "nothing yet", wrong
    soon = path.with_name("soon.h5")
    look = [program, "export", partial.name, "-o", soon.name, "--overwrite"]
    looked = subprocess.run(look, cwd=path.parent, capture_output=True, text=True)
    if looked.returncode:
        return "torn", wrong + [f"{partial.stat().st_size} bytes: {looked.stderr}"]
    with h5py.File(soon) as file:
        missing = text(file.attrs.get("missing", "")).split()
        phase = text(file.attrs.get("incomplete_phase", ""))
        if file.attrs.get("complete") != 0 or not missing or missing[0] != phase:
            wrong.append(f"complete {file.attrs.get('complete')}, phase {phase}, missing {missing}")
        wrong += compare(numbers(file), whole, missing)
    # What comes after the instances is not in a journal: it may have been stopped in any later phase.
    if not any(f"in the {later}: " in words for later in missing):
        wrong.append(f"the terminal names none of the phases {missing}: {words!r}")
    return phase, wrong + goes_on(program, arguments, path, whole)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--moments", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scene", type=pathlib.Path)
    told = parser.parse_args()
    program = told.program.resolve()
    # Where this is started by `nohup`, the runs would ignore hang-ups as well.
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    draw = random.Random(told.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = told.scene.read_text() if told.scene else SCENE
        (folder / "scene.toml").write_text(scene)
        path = folder / "results.h5"
        arguments = ["run", "scene.toml", "-o", path.name, "--audit", "8"]
        began = time.monotonic()
        subprocess.run([program, *arguments], cwd=folder, check=True, capture_output=True)
        lasts = time.monotonic() - began
        earlier = path.read_bytes()
        with h5py.File(path) as file:
            whole = numbers(file)
        print(f"the whole run: {lasts:.2f} s, {whole['status'].size} instances")
        table, failures, slowest = collections.Counter(), [], 0.0
        for moment in range(told.moments):
            path.write_bytes(earlier)
            number = SIGNALS[moment % len(SIGNALS)]
            after = draw.uniform(0.0, lasts)
            code, words, took = strike(program, folder, arguments, number, after)
            phase, wrong = judge((code, number, words), path, earlier, whole, (program, arguments))
            table[phase, number] += 1
            slowest = max(slowest, took if phase != "whole" else 0.0)
            failures += [f"{number.name} at {after:.2f} s, {phase}: {one}" for one in wrong]
    print(f"{'struck in':14}" + "".join(f"{number.name:>9}" for number in SIGNALS))
    for phase in ["start", "nothing yet", *PHASES, "torn", "whole"]:
        row = [table[phase, number] for number in SIGNALS]
        if any(row):
            print(f"{phase:14}" + "".join(f"{count:9}" for count in row))
    print(f"slowest end after a signal: {slowest:.2f} s; failures: {len(failures)}")
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
