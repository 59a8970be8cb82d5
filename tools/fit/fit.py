"""Finds the fitted constants of shaders/ and sh/ again. Build the project first: those that need the baker link what FOLDER holds.

    fit.py [NAME ...] [--build FOLDER]    NAME: of tools/fit/NAME.cpp [all]; FOLDER: a build folder of this project [build/release]

Each .cpp says at its top which constants it finds, and computes an error; no formula is written here a second time. A line

    // fits FILE PLACE LITERAL ...

names literals in a function or in the initialiser of a constant of that file. A copy of the text is made in which they are variables; the
program is compiled with that copy, and the error that it returns is minimised (Nelder & Mead, "A simplex method for function minimization",
1965, from the constants that ship and from others near them). `LITERAL=1-OTHER` follows another one. Printed are the error with the
constants that ship, the least error found, their ratio, and where it lies. A ratio above 1.02 is an error, unless the program says why in a
line `// reason: ...`.
"""
import argparse
import concurrent.futures
import ctypes
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import numpy
import scipy.optimize

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
HERE = SOURCE / "tools/fit"
MOST = 1.02


class Fit:
    def __init__(self, name, build):
        self.name = name
        self.text = (HERE / f"{name}.cpp").read_text()
        self.ships = []  # the constants as they stand in the texts
        self.temporary = tempfile.TemporaryDirectory(prefix=f"apertura-fit-{name}-")
        self.folder = pathlib.Path(self.temporary.name)
        inside = self.folder / "apertura"
        inside.mkdir()
        for top in ("sh", "shaders"):
            shutil.copytree(SOURCE / top, inside / top)
        for top in ("bake", "runtime"):
            (inside / top).symlink_to(SOURCE / top)
        places = re.findall(r"^// fits (\S+) (\S+) (.+)$", self.text, re.M)
        if not places:
            sys.exit(f"{name}: names no constants")
        for file, place, literals in places:
            self.vary(inside / file, place, literals.split())
        library = self.folder / "fit.so"
        own = [inside / "sh" / s for s in re.findall(r"^// with sh/(\S+)$", self.text, re.M)]
        archives = [next(build.rglob(f"libapertura_{room}.a")) for room in re.findall(r"^// links (\S+)$", self.text, re.M)]
        embree = "embree4" if pathlib.Path("/usr/include/embree4").exists() else "embree3"
        flags = f"-ltbb -l{embree} -lmeshoptimizer -lspng -lOpenImageIO -lOpenImageIO_Util -lassimp -ltiff".split() if archives else []
        done = subprocess.run(["c++", "-std=c++20", "-O2", "-ffp-contract=off", "-shared", "-fPIC", "-Wall", "-Wextra", "-include", HERE / "fitted.h", f"-I{self.folder}",
                               f"-I{HERE}", f"-I{SOURCE}", f'-DAPERTURA_SOURCE="{SOURCE}"', HERE / f"{name}.cpp", *own, "-Wl,--start-group", *archives, "-Wl,--end-group",
                               *flags, "-o", library], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{name}: {done.stderr[:3000]}")
        self.error_of = ctypes.CDLL(str(library)).errorOf
        self.error_of.restype = ctypes.c_double
        self.error_of.argtypes = [ctypes.POINTER(ctypes.c_double), ctypes.c_int]

    def variable(self, literal):
        self.ships.append(float(literal))
        return f"fitted[{len(self.ships) - 1}]"

    def vary(self, path, place, literals):
        """Makes literals of a function, or that of a constant, variables in the copy of a text."""
        text = path.read_text()
        function = re.search(rf"^APERTURA_FN \w+ {place}\(.*?(?:\}}\n|\n\}}\n)", text, re.M | re.S)
        if function and "\n    " in function[0]:  # longer than a line: to the brace at its start
            function = re.search(rf"^APERTURA_FN \w+ {place}\(.*?\n\}}\n", text, re.M | re.S)
        if not function:
            path.write_text(self.vary_constant(text, path.name, place, literals))
            return
        body, names = function[0], {}
        for literal in literals:
            number, _, rule = literal.partition("=")
            pattern = rf"(?<![\w.]){re.escape(number)}(?![\w.])"
            if not re.search(pattern, body):
                sys.exit(f"{self.name}: {place} in {path.name} has no {number}")
            names[number] = names[rule[2:]].join(("(1 - ", ")")) if rule else self.variable(number)
            body = re.sub(pattern, names[number], body)
        path.write_text(text[:function.start()] + body + text[function.end():])

    def vary_constant(self, text, file, place, literals):
        """Of `const T A = 1, B = 2;` A or B becomes a macro, as it is not constant any more."""
        found = re.search(rf"^(?P<type>const(?:expr)? \w+ )(?P<all>[^;()]*\b{place} = [^;]*);", text, re.M)
        parts = found["all"].split(", ") if found else []
        own = [p for p in parts if p.startswith(place + " = ")]
        if len(own) != 1 or len(literals) != 1 or literals[0] not in own[0]:
            sys.exit(f"{self.name}: {file} has no constant {place} = {literals}")
        rest = [p for p in parts if p not in own]
        line = found["type"] + ", ".join(rest) + ";" if rest else ""
        return text[:found.start()] + f"#define {place} float({self.variable(literals[0])})\n{line}" + text[found.end():]

    def error(self, constants):
        return self.error_of((ctypes.c_double * len(constants))(*constants), len(constants))

    def run(self):
        began = time.time()
        ships = numpy.array(self.ships)
        shipped = self.error(ships)
        best, least = ships, shipped
        random = numpy.random.default_rng(1)
        for start in range(4):
            first = best if start in (0, 3) else ships * random.uniform(.9, 1.1, len(ships))
            simplex = numpy.vstack([first, *(first + numpy.where(numpy.arange(len(first)) == i, .08 * abs(first) + 1e-4, 0)
                                             for i in range(len(first)))])
            found = scipy.optimize.minimize(self.error, first, method="Nelder-Mead", bounds=[(0, None)] * len(first),
                                            options={"initial_simplex": simplex, "maxfev": 250 * len(first), "xatol": 1e-5, "fatol": 1e-9})
            if found.fun < least:
                best, least = found.x, found.fun
        ratio = shipped / least
        reason = re.search(r"^// reason: (.+(?:\n//   .+)*)", self.text, re.M)
        lines = [f"{self.name}: {shipped:.6f} with the constants that ship, {least:.6f} at the least: {ratio:.3f} of it"
                 f" ({time.time() - began:.0f} s)"]
        if ratio > MOST and reason:
            lines.append("  reason: " + re.sub(r"\n//\s+", " ", reason[1]))
        lines.append("  ships " + " ".join(f"{x:.6g}" for x in ships))
        lines.append("  least " + " ".join(f"{x:.6g}" for x in best))
        return "\n".join(lines), ratio <= MOST or bool(reason)


def fit(name, build):
    return Fit(name, build).run()


def main():
    parser = argparse.ArgumentParser(description="finds the fitted constants of shaders/ and sh/ again")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--build", type=pathlib.Path, default=SOURCE / "build/release")
    arguments = parser.parse_args()
    names = arguments.names or sorted(p.stem for p in HERE.glob("*.cpp"))
    failed = False
    with concurrent.futures.ProcessPoolExecutor() as pool:
        for done in concurrent.futures.as_completed([pool.submit(fit, name, arguments.build) for name in names]):
            text, good = done.result()
            failed |= not good
            print(text, flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
