"""Kills runs of every kind at random moments, goes on with them, and compares their files. Needs h5py.

kills.py PROGRAM [--kills 100] [--terms 30] [--disks 30] [--pairs 30] [--seed 1]

Truth is the run of the same scene that nobody disturbs: the file that is gone on to has its variables, to the bit. A quarter
of the signals to runs whose time goes into second branches and audit have to meet them there. Second runs are started on
journals of runs that are under way. As root it also fills small disks and makes them larger again.
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
    bytes_, at = partial.read_bytes(), len(b"afmjournal 2\n")
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
    arguments, lasts = undisturbed(program, name)
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
    if met and "--audit" in KINDS[name][2] and beyond < max(1, met // 4):
        wrong.append(f"only {beyond} of {met} signals met second branches, audit or waveforms")
    print(f"{name:10} {signal.Signals(number).name}: {met} in {runs} runs of {lasts:.2f} s, {beyond} of them beyond the portions, "
          f"{len(wrong)} wrong", flush=True)
    return [f"{name}: {one}" for one in wrong]


def undisturbed(program, name):
    """Runs a kind; the arguments of its runs, and how long it lasts."""
    text, portion, options = KINDS[name]
    pathlib.Path("scene.toml").write_text(text)
    audit = [] if "--audit" in options else ["--audit", "2"]
    arguments = ["run", "scene.toml", "-q", *audit, "--portion", portion, *options]
    began = time.monotonic()
    subprocess.run([program, *arguments, "-o", "whole.h5", "--overwrite"], check=True)
    return arguments, time.monotonic() - began


def full_disks(program, count, draw):
    """Fills disks of some 40 kB or more while runs write their journals, and makes them larger; what is wrong."""
    disk = pathlib.Path("disk")
    disk.mkdir()
    wrong, filled, tried = [], 0, 0
    while filled < count and tried < 10 * count:
        tried += 1
        name = draw.choice(["grid", "list", "design", "curve", "search", "set-point"])
        arguments, _ = undisturbed(program, name)
        arguments = [program, *arguments, "-o", "disk/a.h5", "--resume"]
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(disk)], check=True)
        try:
            size = 4 * draw.randrange(10, 100)
            subprocess.run(["mount", "-o", f"remount,size={size}k", str(disk)], check=True)
            done = subprocess.run(arguments, capture_output=True, text=True)
            filled += done.returncode != 0
            if done.returncode and (done.returncode != 1 or "make room" not in done.stderr):
                wrong.append(f"{name}, {size} kB: exit code {done.returncode}, {done.stderr}")
            subprocess.run(["mount", "-o", "remount,size=16m", str(disk)], check=True)
            done = subprocess.run(arguments, capture_output=True, text=True)
            wrong += [done.stderr] if done.returncode else differing("whole.h5", "disk/a.h5")
        finally:
            subprocess.run(["umount", str(disk)], check=True)
    print(f"full disk: {filled} filled in {tried} runs, {len(wrong)} wrong", flush=True)
    return wrong if filled >= count else [*wrong, f"only {filled} of {count} disks were filled"]


def pairs(program, count, draw):
    """Starts a second run on the journal of one that is under way; what is wrong."""
    wrong, refused, tried = [], 0, 0
    while refused < count and tried < 10 * count:
        name = draw.choice(["grid", "curve", "search"])
        arguments, lasts = undisturbed(program, name)
        arguments = [program, *arguments, "-o", "a.h5", "--resume"]
        tried += 1
        first = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(draw.uniform(0.0, lasts))
        second = subprocess.run(arguments, capture_output=True, text=True)
        _, said = first.communicate()
        refused += second.returncode != 0
        if second.returncode and "another run is writing" not in second.stderr:
            wrong.append(f"{name}: exit code {second.returncode}, {second.stderr}")
        # Whichever came first ran to its end.
        if first.returncode and "another run is writing" not in said:
            wrong.append(f"{name}: {said}")
        wrong += differing("whole.h5", "a.h5")
        pathlib.Path("a.h5").unlink(missing_ok=True)
    print(f"two runs on one journal: {refused} refused of {tried}, {len(wrong)} wrong", flush=True)
    return wrong if refused >= count else [*wrong, f"only {refused} of {count} second runs were refused"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--terms", type=int, default=30)
    parser.add_argument("--disks", type=int, default=30)
    parser.add_argument("--pairs", type=int, default=30)
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
                wrong += full_disks(program, told.disks, draw)
            except subprocess.CalledProcessError as error:
                print(f"full disk: not tried, {error}")
        wrong += pairs(program, told.pairs, draw)
        os.chdir("/")
    print("\n".join(wrong) or "all files are those of undisturbed runs")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
