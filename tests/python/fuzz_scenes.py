#!/usr/bin/env python3
"""Mutants of the scenes of this repository over `plan`, `force` and `run`, looking for panics, signals, hangs, greed
and messages without a place or help.

    tests/python/fuzz_scenes.py PROGRAM [--mutants 10000] [--seed 1] [--seconds 0] [--keep FOLDER]

Mutant N of a seed is always the same, so a finding repeats: --only N runs it alone. Exit code 1 where anything was
found. Only Python's standard library is needed.
"""

import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ["scenes", "tests/hard", "tests/scenes/good"]
# Wall clock of a call, s; and its memory, bytes: both far above what any of these scenes needs.
LIMIT = {"plan": 60.0, "force": 30.0, "run": 60.0}
MEMORY = 2 << 30
# A run that is still stepping when its time is over is no hang, as scenes may ask for as much as they like.
LARGEST_RUN = 3e8

NUMBERS = ["0", "-0.0", "1", "-1", "1e-300", "1e300", "1e999", "inf", "-inf", "nan", "0.5", "0.50000001", "1e-12",
           "3", "65536", "4294967295", "18446744073709551616", "-0.999999999999", "1e6", "1e-6", "0x10", "1_000"]
UNITS = ["m", "nm", "um", "GPa", "Pa", "kHz", "Hz", "N/m", "mJ/m^2", "V", "s", "J", "kg", "mm", "fm", ""]
WORDS = ["none", "hertz", "dmt", "jkr", "auto", "rigid", "coupled", "prescribed", "as-printed", "tip", "actuator",
         "rest", "steady", "search", "wait", "both", "one", "resonance", "log", "lin", "amplitude", "contacts",
         "harmonic_amplitude", "ha-fung-chen-2005"]
TOKENS = ['"', "[", "]", "{", "}", "=", ",", "\n", "#", ".", "-", "\u00b5", "\x00", "\t", "'", "\u202e"]
VALUE = re.compile(r'"(-?[0-9.eE+-]+|inf) ?([^"]*)"|(?<![\w"])-?[0-9][0-9.eE+_-]*(?![\w"])')
KEY = re.compile(r'^("?[\w.]+"?) *=', re.M)


def number(draw, old):
    """Another number for an old one: odd, or near by some factor."""
    if draw.random() < 0.5:
        return draw.choice(NUMBERS)
    try:
        value = float(old)
    except ValueError:
        return draw.choice(NUMBERS)
    return repr(value * 10 ** draw.uniform(-9, 9) * draw.choice([1, 1, 1, -1]))


def change_value(draw, text, _all):
    """One quantity or number takes another size, and sometimes another unit."""
    found = list(VALUE.finditer(text))
    if not found:
        return text
    match = draw.choice(found)
    if match.group(1) is None:
        new = number(draw, match.group(0))
    else:
        unit = match.group(2) if draw.random() < 0.8 else draw.choice(UNITS)
        new = '"' + (number(draw, match.group(1)) + " " + unit).strip() + '"'
    return text[: match.start()] + new + text[match.end() :]


def change_word(draw, text, _all):
    """One choice becomes another."""
    found = [m for m in re.finditer(r'"([a-z_-]{3,})"', text)]
    if not found:
        return text
    match = draw.choice(found)
    return text[: match.start(1)] + draw.choice(WORDS) + text[match.end(1) :]


def drop_line(draw, text, _all):
    lines = text.splitlines(keepends=True) or [""]
    del lines[draw.randrange(len(lines))]
    return "".join(lines)


def double_line(draw, text, _all):
    lines = text.splitlines(keepends=True) or [""]
    lines.insert(draw.randrange(len(lines)), draw.choice(lines))
    return "".join(lines)


def foreign_line(draw, text, everything):
    """A line of another scene, anywhere: mostly a key in a wrong section, or a second way to say a thing."""
    lines = text.splitlines(keepends=True)
    lines.insert(draw.randrange(len(lines) + 1), draw.choice(draw.choice(everything).splitlines(keepends=True)))
    return "".join(lines)


def foreign_section(draw, text, everything):
    """A section of another scene at the end, in place of one's own where there is one."""
    sections = re.split(r"(?m)^(?=\[)", draw.choice(everything))[1:]
    if not sections:
        return text
    new = draw.choice(sections)
    head = new.splitlines()[0]
    own = [part for part in re.split(r"(?m)^(?=\[)", text) if not part.startswith(head)]
    return "".join(own) + "\n" + new


def sweep_key(draw, text, _all):
    """One more axis, of a quantity that the scene gives."""
    section, found = "", []
    for line in text.splitlines():
        if line.startswith("["):
            section = line.strip("[] ")
        elif section not in ("", "sweep", "samples", "run", "output"):
            match = re.match(r'([a-z_0-9]+) *= *("[^"]*"|[0-9][0-9.e+-]*)', line)
            if match:
                found.append((f"{section}.{match.group(1)}", match.group(2)))
    if not found:
        return text
    path, value = draw.choice(found)
    axis = f'"{path}" = {{ values = [{value}, {change_value(draw, value, _all)}] }}\n'
    if "[sweep]" in text:
        return text.replace("[sweep]\n", "[sweep]\n" + axis, 1)
    return text + "\n[sweep]\n" + axis


def token(draw, text, _all):
    at = draw.randrange(len(text) + 1)
    if draw.random() < 0.5:
        return text[:at] + draw.choice(TOKENS) + text[at:]
    return text[:at] + text[at + draw.randrange(1, 8) :]


CHANGES = [change_value] * 6 + [change_word] * 2 + [sweep_key] * 2
CHANGES += [drop_line, double_line, foreign_line, foreign_section, token]


def mutant(seed, index, scenes):
    """The text of a mutant and the command that it goes to."""
    draw = random.Random(f"{seed}/{index}")
    text = draw.choice(scenes)
    for _ in range(draw.choice([1, 1, 1, 2, 2, 3])):
        text = draw.choice(CHANGES)(draw, text, scenes)
    return text, draw.choice(["plan", "plan", "force", "run"])


def shortened(text):
    """The same scene with few instances and few periods, so that thousands of runs take minutes."""
    text = re.sub(r"points *= *[0-9]+", "points = 2", text)
    text = re.sub(r"(?m)^periods *= *[0-9]+", "periods = 12", text)
    text = re.sub(r"(?m)^measure *= *[0-9]+", "measure = 4", text)
    if not re.search(r"(?m)^periods", text):
        few = "[run]\nperiods = 12\nmeasure = 4\n"
        text = text.replace("[run]\n", few, 1) if "[run]\n" in text else f"{text}\n{few}"
    return re.sub(r"instances *= *\[[0-9, ]*\]", "instances = [0]", text)


def bounded():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.nice(10)


def call(arguments, seconds, folder):
    """Exit code (negative: a signal; none: out of time), messages, and the largest memory seen."""
    child = subprocess.Popen(arguments, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             preexec_fn=bounded, env={**os.environ, "RAYON_NUM_THREADS": "1"})
    most, over, start = 0, False, time.monotonic()

    said = []
    reader = threading.Thread(target=lambda: said.append(child.stderr.read()))
    reader.start()
    while child.poll() is None:
        try:
            status = Path(f"/proc/{child.pid}/status").read_text()
            most = max(most, int(re.search(r"VmHWM:\s+(\d+)", status).group(1)) * 1024)
        except (OSError, AttributeError):
            pass
        over = time.monotonic() - start > seconds
        if over or most > MEMORY:
            child.send_signal(signal.SIGKILL)
            child.wait()
            break
        time.sleep(0.01)
    reader.join()
    return (None if over else child.returncode), said[0].decode("utf-8", "replace"), most


def steps(program, name, folder):
    """How much a scene would step; none where it has no plan."""
    done = subprocess.run([program, "plan", name, "--json"], cwd=folder, capture_output=True, text=True, timeout=120)
    found = re.search(r'"instance_steps": (\d+)', done.stdout)
    return int(found.group(1)) if found else None


def trouble(program, seed, index, scenes, folder):
    """What is wrong with one mutant's call, or nothing; and whether it was accepted."""
    text, command = mutant(seed, index, scenes)
    if command == "run":
        text = shortened(text)
    name = f"mutant-{index}.toml"
    (Path(folder) / name).write_text(text, encoding="utf-8", newline="")
    extra = ["-o", f"mutant-{index}.h5", "--overwrite", "--no-audit"] if command == "run" else []
    if command == "run":
        try:
            asked = steps(program, name, folder)
        except subprocess.TimeoutExpired:
            return command, ["hang of plan before run"], False
        if asked is not None and asked > LARGEST_RUN:
            return "too long", [], True
    code, said, most = call([program, command, name, *extra], LIMIT[command], folder)
    found = []
    if code is None:
        found.append(f"still at it after {LIMIT[command]:.0f} s")
    elif most > MEMORY:
        found.append(f"took {most >> 20} MiB")
    elif code < 0:
        found.append(f"ended by signal {-code}")
    elif code == 101 or "panicked" in said:
        found.append("panic: " + " ".join(said.split())[:300])
    elif code not in (0, 1):
        found.append(f"exit code {code}: {said[:200]}")
    elif code == 1:
        # A place is a line of the file, or, of errors of the file as a whole, its name.
        if name not in said:
            found.append("no place: " + " ".join(said.split())[:300])
        if "help: " not in said or "expected: " not in said:
            found.append("no help: " + " ".join(said.split())[:300])
        if max((len(word) for word in said.split()), default=0) > 120:
            found.append("a word of more than 120 letters: " + said[:300])
    for leftover in (f"mutant-{index}.h5", f"mutant-{index}.h5.partial"):
        Path(folder, leftover).unlink(missing_ok=True)
    return command, found, code == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--mutants", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=0, help="stop after so long; 0: never")
    parser.add_argument("--parallel", type=int, default=2)
    parser.add_argument("--only", type=int, help="this mutant alone")
    parser.add_argument("--keep", type=Path, help="folder for the scenes at fault")
    args = parser.parse_args()
    program = str(args.program.resolve())
    files = sorted(file for folder in FOLDERS for file in (ROOT / folder).glob("*.toml"))
    scenes = [file.read_text(encoding="utf-8") for file in files]
    start, counts, accepted, done, faults = time.monotonic(), {}, 0, 0, []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(args.parallel) as pool:

        def one(index):
            if args.seconds and time.monotonic() - start > args.seconds:
                return None
            try:
                return index, *trouble(program, args.seed, index, scenes, folder)
            except Exception as error:  # a fault of this script is one to be seen, too
                return index, "script", [repr(error)], False

        wanted = range(args.mutants) if args.only is None else [args.only]
        for answer in pool.map(one, wanted):
            if answer is None:
                continue
            index, command, found, good = answer
            done += 1
            counts[command] = counts.get(command, 0) + 1
            accepted += good
            for line in found:
                faults.append(index)
                print(f"mutant {index} of seed {args.seed}, {command}: {line}", flush=True)
            scene = Path(folder, f"mutant-{index}.toml")
            if found and args.keep:
                args.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(scene, args.keep)
            scene.unlink(missing_ok=True)
    told = ", ".join(f"{command} {count}" for command, count in sorted(counts.items()))
    print(f"{done} mutants of {len(files)} scenes, seed {args.seed} ({told}): {accepted} accepted, "
          f"{len(set(faults))} at fault, {time.monotonic() - start:.0f} s")
    return 1 if faults or not done else 0


if __name__ == "__main__":
    sys.exit(main())
