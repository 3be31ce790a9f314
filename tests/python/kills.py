"""Kills runs of every kind at random moments, goes on with them, and compares their files. Needs h5py.

kills.py PROGRAM [--kills 100] [--terms 30] [--seed 1]

Truth is the run of the same scene that nobody disturbs: the file that is gone on to has its variables, to the bit. A quarter
of the signals to runs whose time goes into second branches and audit have to meet them there. As root it also fills a small disk and makes it larger again.
"""

import argparse
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "clusters"))
from same import differing  # noqa: E402

LEVER = """
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "26 N/m"
frequency = "300 kHz"
quality_factor = 450
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
"""
STIFFNESSES = '"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = COUNT, scale = "log" }\n'
GAPS = '"approach.gap" = { from = "8 nm", to = "19 nm", points = 40 }\n'
MODULI = ", ".join(f'"{0.3 + 0.02 * n:.2f} GPa"' for n in range(300))
RADII = ", ".join(f'"{5 + n % 17} nm"' for n in range(300))
KINDS = {
    "grid": (LEVER + '[contact]\nlaw = "dmt"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "20") + GAPS, "64", []),
    "f32": (LEVER + '[contact]\nlaw = "hertz"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "20") + GAPS, "64",
            ["--precision", "f32"]),
    "once": (LEVER + '[contact]\nlaw = "jkr"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "20") + GAPS, "64",
             ["--no-estimate"]),
    "list": (LEVER + '[contact]\nlaw = "hertz"\n[approach]\ngap = "14 nm"\n[samples]\n'
             f'"sample.youngs_modulus" = [{MODULI}]\n"instrument.tip.radius" = [{RADII}]\n', "32", []),
    "design": (LEVER + '[contact]\nlaw = "hertz"\n[approach]\ngap = "14 nm"\n[uncertain]\n'
               '"sample.youngs_modulus" = { distribution = "loguniform", from = "0.5 GPa", to = "5 GPa" }\n'
               '"instrument.cantilever.stiffness" = { distribution = "normal", mean = "26 N/m", sd = "5 %" }\n'
               '[design]\nkind = "sobol"\nsamples = 256\nseed = 3\n[run]\nsteady = "search"\n', "16", []),
    # Begins at its neighbours' states.
    "neighbours": (LEVER + '[contact]\nlaw = "hertz"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "120") + GAPS
                   + '[run]\nsteady = "search"\n', "64", []),
    "curve": (LEVER + '[contact]\nlaw = "dmt"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "70")
              + '[curve]\nquantity = "approach.gap"\nfrom = "22 nm"\nto = "12 nm"\npoints = 12\ndirection = "both"\n',
              "200", []),
    "search": (LEVER + '[contact]\nlaw = "dmt"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "20") + GAPS
               + '[run]\nsteady = "search"\nbranches = "both"\n[output]\n'
               'waveforms = { instances = [0, 9], samples_per_period = 32, periods = 2 }\n', "64", []),
    # Most of its time goes into second branches and an audit.
    "branches": (LEVER.replace("450", "2000") + '[contact]\nlaw = "dmt"\n[sweep]\n' + STIFFNESSES.replace("COUNT", "12") + GAPS
                 + '[run]\nsteady = "search"\nbranches = "both"\n[output]\n'
                 'waveforms = { instances = [0, 9], samples_per_period = 32, periods = 2 }\n', "64", ["--audit", "60"]),
    "set-point": (LEVER + '[contact]\nlaw = "hertz"\n[approach]\nsetpoint = 0.8\n[sweep]\n'
                  + STIFFNESSES.replace("COUNT", "80"), "8", []),
}


# Of what is asked once all portions have ended.
LATER = {3, 4, 5}


def has_later(partial):
    """Whether a journal has records of what is asked once all portions have ended."""
    if not partial.exists():
        return False
    bytes_, at = partial.read_bytes(), len(b"afmjournal 1\n")
    while at + 9 <= len(bytes_):
        length, kind = int.from_bytes(bytes_[at : at + 4], "little"), bytes_[at + 4]
        if kind in LATER and at + 13 + length <= len(bytes_):
            return True
        at += 13 + length
    return False


def struck(program, arguments, number, after):
    """Starts a run and sends it a signal after so long; its exit code, and whether the signal met it."""
    child = subprocess.Popen([program, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        return child.wait(after), False
    except subprocess.TimeoutExpired:
        child.send_signal(number)
        return child.wait(), True


def to_the_end(program, arguments, number, strikes, lasts, draw):
    """Strikes a run so often, then lets it end; how often it was met, how often beyond its portions, and what is wrong."""
    met = later = 0
    for _ in range(strikes):
        code, was_met = struck(program, arguments, number, draw.uniform(0.0, lasts))
        met += was_met
        later += was_met and has_later(pathlib.Path("a.h5.partial"))
        if code not in (0, -number, 128 + number):
            return met, later, f"exit code {code}"
        if code == 0:
            break
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    return met, later, done.stderr if done.returncode else None


def strikes(program, name, number, count, draw):
    """Strikes runs of a kind until `count` signals have met one; what is wrong."""
    text, portion, options = KINDS[name]
    pathlib.Path("scene.toml").write_text(text)
    audit = [] if "--audit" in options else ["--audit", "2"]
    arguments = ["run", "scene.toml", "-q", *audit, "--portion", portion, *options]
    whole = [*arguments, "-o", "whole.h5", "--overwrite"]
    began = time.monotonic()
    subprocess.run([program, *whole], check=True)
    lasts = time.monotonic() - began
    met = beyond = runs = 0
    wrong = []
    while met < count:
        some, later, fault = to_the_end(program, [*arguments, "-o", "a.h5", "--resume"], number, 3, 1.1 * lasts, draw)
        met, beyond, runs = met + some, beyond + later, runs + 1
        wrong += [fault] if fault else differing("whole.h5", "a.h5")
        pathlib.Path("a.h5").unlink(missing_ok=True)
        if pathlib.Path("a.h5.partial").exists():
            wrong.append("a journal is left")
            pathlib.Path("a.h5.partial").unlink()
    # A draw of few signals may miss them by chance.
    if "--audit" in options and beyond < max(1, met // 4):
        wrong.append(f"only {beyond} of {met} signals met second branches, audit or waveforms")
    print(f"{name:10} {signal.Signals(number).name}: {met} in {runs} runs of {lasts:.2f} s, {beyond} of them beyond the portions, "
          f"{len(wrong)} wrong", flush=True)
    return [f"{name}: {one}" for one in wrong]


def full_disk(program):
    """Fills a disk of 256 kB while a run writes its journal, and makes it larger."""
    text, portion, options = KINDS["search"]
    pathlib.Path("scene.toml").write_text(text)
    arguments = ["run", "scene.toml", "-q", "--audit", "2", "--portion", portion, *options]
    subprocess.run([program, *arguments, "-o", "whole.h5", "--overwrite"], check=True)
    disk = pathlib.Path("disk")
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(disk)], check=True)
    try:
        wrong = []
        for size in ("256k", "320k", "16m"):
            subprocess.run(["mount", "-o", f"remount,size={size}", str(disk)], check=True)
            done = subprocess.run([program, *arguments, "-o", "disk/a.h5", "--resume"], capture_output=True, text=True)
            if size == "16m":
                wrong += [done.stderr] if done.returncode else differing("whole.h5", "disk/a.h5")
            elif done.returncode != 1 or "make room" not in done.stderr:
                wrong.append(f"{size}: exit code {done.returncode}, {done.stderr}")
        print(f"full disk: {len(wrong)} wrong")
        return wrong
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--terms", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    program = str(told.program.resolve())
    draw = random.Random(told.seed)
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in KINDS:
            wrong += strikes(program, name, signal.SIGKILL, -(-told.kills // len(KINDS)), draw)
            wrong += strikes(program, name, signal.SIGTERM, -(-told.terms // len(KINDS)), draw)
        if os.geteuid() == 0 and subprocess.run(["mount", "--version"], capture_output=True).returncode == 0:
            try:
                wrong += full_disk(program)
            except subprocess.CalledProcessError as error:
                print(f"full disk: not tried, {error}")
        os.chdir("/")
    print("\n".join(wrong) or "all files are those of undisturbed runs")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
