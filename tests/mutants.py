"""Runs the program on thousands of damaged and exaggerated files of every kind that it reads.

    mutants.py PROGRAM [--runs N] [--seed S] [--jobs J] [--seconds T] [--keep FOLDER]

A run passes when it ends by itself with 0, 1 or 2 within T s (20) of its own and 2 GB, says why in one line where it is not 0, and
leaves nothing behind but a whole output. What does not pass is kept, and named with the command.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import resource
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent / "fuzz"))
import seeds

MOST_BYTES = 2 << 30
ODD_NUMBERS = [0, -1, 1, 2, 7, 0.5, 1e30, -1e30, 1e300, 255, 256, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**53, 2**63, 2**64 - 1]
ODD_VALUES = [None, True, "", "x", "../secret", [], {}, [0], {"bufferView": 0}, 5126, 5121]


def mutate_bytes(rng, data):
    data = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 4, 16])):
        if not data:
            break
        at = rng.randrange(len(data))
        length = min(rng.choice([1, 2, 4, 8, 64, 512]), len(data) - at)
        kind = rng.randrange(7)
        if kind == 0:
            data[at] ^= 1 << rng.randrange(8)
        elif kind == 1:
            data[at] = rng.randrange(256)
        elif kind == 2:
            data[at : at + 4] = struct.pack(rng.choice("<>") + "I", rng.choice([0, 1, 255, 2**16, 2**31, 2**32 - 1, 2**32 - 4, rng.randrange(2**32)]))
        elif kind == 3:
            del data[at : at + length]
        elif kind == 4:
            data[at:at] = data[at : at + length] * rng.choice([1, 2, 50])
        elif kind == 5:
            other = rng.randrange(len(data))
            data[at : at + length], data[other : other + length] = data[other : other + length], data[at : at + length]
        else:
            del data[at:]
    return bytes(data)


def mutate_words(rng, data):
    """Swaps, repeats and exaggerates the words of a text."""
    lines = data.split(b"\n")
    for _ in range(rng.choice([1, 2, 4])):
        at = rng.randrange(len(lines))
        words = lines[at].split(b" ")
        kind = rng.randrange(4)
        if kind == 0:
            words[rng.randrange(len(words))] = str(rng.choice(ODD_NUMBERS + ["nan", "inf", "-", "9" * 400])).encode()
        elif kind == 1:
            words = words * rng.choice([2, 100])
        elif kind == 2:
            lines[at:at] = [lines[rng.randrange(len(lines))]] * rng.choice([1, 10, 1000])
        else:
            words = []
        lines[at] = b" ".join(words)
    return b"\n".join(lines)


def places(value, found):
    """Every place in a document: the container and the key."""
    keys = value.keys() if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        found.append((value, key))
        places(value[key], found)
    return found


def mutate_json(rng, document):
    for _ in range(rng.choice([1, 1, 2, 3])):
        found = places(document, [])
        if not found:
            break
        numbers = [p for p in found if isinstance(p[0][p[1]], (int, float)) and not isinstance(p[0][p[1]], bool)]
        kind = rng.randrange(7)
        holder, key = rng.choice(numbers if numbers and kind < 4 else found)
        if kind == 0:
            holder[key] = rng.choice(ODD_NUMBERS)
        elif kind == 1:
            holder[key] = holder[key] * rng.choice([-1, 2, 1000, 10**9]) + rng.choice([-1, 0, 1]) if isinstance(holder[key], (int, float)) else 0
        elif kind < 4:
            other, name = rng.choice(numbers or found)
            holder[key], other[name] = other[name], holder[key]
        elif kind == 4:
            holder[key] = rng.choice(ODD_VALUES)
        elif kind == 5:
            lists = [p[0][p[1]] for p in found if isinstance(p[0][p[1]], list) and p[0][p[1]]]
            if lists:
                chosen = rng.choice(lists)
                chosen.extend([json.loads(json.dumps(rng.choice(chosen)))] * rng.choice([1, 3, 1000]))
        else:
            del holder[key]
    return document


def mutant(rng, path):
    data = path.read_bytes()
    if path.suffix in (".obj",) or path.name.startswith("text."):
        return mutate_words(rng, data) if rng.random() < 0.7 else mutate_bytes(rng, data)
    if path.suffix == ".gltf" and rng.random() < 0.8:
        return json.dumps(mutate_json(rng, json.loads(data))).encode()
    if path.suffix == ".glb" and rng.random() < 0.7:
        document, binary = seeds.split_glb(data)
        if rng.random() < 0.3:
            binary = mutate_bytes(rng, binary)
        return seeds.glb(mutate_json(rng, document), binary)
    return mutate_bytes(rng, data)


def commands(rng, path, out):
    verb = rng.choice(["bake", "bake", "info", "render", "compare"])
    height = ["--terrain-rgb"] if path.stem == "rgb" else []
    if path.suffix in (".png", ".tif", ".exr") and rng.random() < 0.4:
        if rng.random() < 0.5:
            return ["bake", path, "-o", out / "o.glb", *height]
        quantity = rng.choice([["--azimuths", "4"], ["--azimuths", "4", "--exact"], ["--quantity", "sun-hours", "--day", "80", "--latitude", "50"]])
        return ["horizon", path, "-o", out / "o.tif", *quantity, *height]
    if verb == "bake":
        model = rng.choice([[], ["--model", "firm-2"], ["--model", "auto"], ["--bits", "16"]])
        at = rng.choice([["--storage-tolerance", "0.2"], ["--at", "vertices"]])  # by default, seconds go to finding a tolerance
        return ["bake", path, "-o", out / "o.glb", "--rays", "8", *model, *at, *height]
    if verb == "info":
        return ["info", path, *rng.choice([[], ["--json"]])]
    if verb == "render":
        return ["render", path, "-o", out / "o.png", "--size", "16x16", *rng.choice([[], ["--model", "reference", *height]])]
    return ["compare", path, "--receivers", "4", "--light-radii", "5", "--models", "soft", "--json", out / "o.json", *height]


def one_run(program, folder, seed, number, keep, most_seconds):
    """None, or what was wrong."""
    rng = random.Random(f"{seed} {number}")
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        files = sorted(p for p in folder.rglob("*") if p.is_file() and p.suffix != ".bin")
        chosen = rng.choice(files)
        (place / "in").mkdir(), (place / "out").mkdir()
        if chosen.suffix == ".gltf":
            shutil.copy(chosen.with_suffix(".bin"), place / "in/cube.bin")
        path = place / "in" / chosen.name
        path.write_bytes(mutant(rng, chosen))
        command = [program, *map(str, commands(rng, path, place / "out"))]
        begin = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        killer = threading.Timer(3 * most_seconds, process.kill)
        killer.start()
        said = b"".join(line for line in process.stderr.read().splitlines(True) if b" % after " not in line)  # how far a long work is
        _, status, usage = os.wait4(process.pid, 0)
        killer.cancel()
        code = process.returncode = os.waitstatus_to_exitcode(status)
        seconds, bytes_used = time.monotonic() - begin, usage.ru_maxrss * 1024
        left = sorted(p.name for p in (place / "out").iterdir())
        wrong = []
        if code not in (0, 1, 2):
            wrong.append(f"ended with {code}")
        if code != 0 and (said.count(b"\n") != 1 or not said.startswith(b"apertura: ")):
            wrong.append(f"said {said[-800:].decode(errors='replace')!r}")
        # A machine may stand still for a while: what counts is the program's own time, and that it ends.
        working = usage.ru_utime + usage.ru_stime
        if working > most_seconds or seconds > 3 * most_seconds:
            wrong.append(f"took {seconds:.0f} s, {working:.0f} s of them its own")
        if bytes_used > MOST_BYTES and "sanit" not in program:
            wrong.append(f"took {bytes_used / 2**30:.1f} GiB")
        if len(left) > (code == 0) or (code != 0 and left):
            wrong.append(f"left {left}")
        if not wrong:
            return code, None
        keep.mkdir(parents=True, exist_ok=True)
        kept = keep / f"{number}-{chosen.name}"
        shutil.copy(path, kept)
        return code, f"{', '.join(wrong)}: {shlex.join(command)} (kept as {kept})"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--keep", type=pathlib.Path, default=pathlib.Path("mutants"))
    options = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        seeds.write_seeds(folder, options.program)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda n: one_run(options.program, folder, options.seed, n, options.keep, options.seconds), range(options.runs)))
    failures = [wrong for _, wrong in results if wrong]
    for wrong in failures:
        print(wrong)
    counts = {code: sum(c == code for c, _ in results) for code in sorted({c for c, _ in results})}
    print(f"{options.runs} mutants, seed {options.seed}: {len(failures)} wrong; exit codes {counts}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
