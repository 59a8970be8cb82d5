"""Apertura as a guest in other people's builds: the package installed, moved and linked by tests/consumer through find_package and
pkg-config, its sources through add_subdirectory, and what is said where that cannot work.

    guest.py BUILD FOLDER [COMPILER ...]     BUILD: a build folder of this project; FOLDER: where to work; compilers [c++]
"""
import os
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
CONSUMER = SOURCE / "tests/consumer"
wrong = []


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    return done.returncode, done.stdout, done.stderr


def must(*command, **more):
    code, out, errors = run(*command, **more)
    if code:
        sys.exit(f"{' '.join(map(str, command))}: exit {code}\n{out[-3000:]}{errors[-3000:]}")
    return out


def check(holds, what):
    if not holds:
        wrong.append(what)


def check_lights(program, assets, by):
    lights = [(.2, .9, .3), (-.5, .4, .1), (.9, .2, -.4)]
    lit = 0
    for asset, model in assets:
        for vertex in (0, 7, 12):
            for light in lights:
                arguments = [asset, model, vertex, *light, .27]
                got = [float(x) for x in must(program, *arguments).split()]
                expected = [float(x) for x in must(sys.executable, CONSUMER / "expected.py", *arguments).split()]
                # of the largest value that each can have: a light overhead, and the whole sky
                for value, other, most in zip(got, expected, (6.98e-5, 3.1416)):
                    check(abs(value - other) <= 1e-5 * most, f"{by}: {model}, vertex {vertex}: {value}, from the bytes {other}")
                lit += expected[0] > 1e-6
    check(lit >= 3, f"{by}: only {lit} lights are seen")


def configure(folder, *options, compiler="c++"):
    return run("cmake", "-S", CONSUMER, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_CXX_COMPILER={compiler}", *options)


def main():
    build, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    compilers = sys.argv[3:] or ["c++"]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    must("cmake", "--install", build, "--prefix", folder / "installed")
    prefix = folder / "moved elsewhere"
    (folder / "installed").rename(prefix)
    texts = "".join(p.read_text(errors="ignore") for p in prefix.rglob("*") if p.suffix in (".cmake", ".pc", ".h"))
    check(str(build) not in texts and str(SOURCE) not in texts, "what is installed names the folder that it was built in")

    program = prefix / "bin/apertura"
    assets = []
    for model, recipe in (("sh-l1", "sh"), ("firm-2", "firm-2")):
        assets.append((folder / f"{model}.glb", model))
        must(program, "bake", "builtin:statue", "-o", assets[-1][0], "--model", recipe, "--at", "vertices", "--rays", "64", "--threads", "2")
    code, _, errors = run(program, "chart", folder / "none.glb", "-o", folder / "charts")
    check(code == 1 and "none.glb" in errors, f"chart of a program that was moved: {errors}")
    script = prefix / "share/apertura/charts.py"
    script.rename(folder / "charts.py")
    code, _, errors = run(program, "chart", "builtin:room-1", "-o", folder / "charts")
    check(code == 1 and errors.count("\n") == 1 and "charts.py" in errors, f"chart without its script: {errors}")
    (folder / "charts.py").rename(script)

    must(sys.executable, SOURCE / "tests/glsl_names.py", folder / "glsl", prefix / "include/apertura/shaders")
    for compiler in compilers:
        by = f"find_package, {compiler}"
        linked = folder / f"package-{pathlib.Path(compiler).name}"
        code, _, errors = configure(linked, f"-DCMAKE_PREFIX_PATH={prefix}", compiler=compiler)
        if code:
            sys.exit(f"{by}: {errors}")
        must("ninja", "-C", linked)
        check_lights(linked / "light", assets, by)
        must(linked / "draw", assets[1][0], "firm-2", folder / "picture.png")
        check((folder / "picture.png").stat().st_size > 500, "the picture of the linked renderer is empty")

        by = f"pkg-config, {compiler}"
        libraries = next(prefix.glob("lib*/**/pkgconfig"))
        flags = must("pkg-config", "--cflags", "--libs", "apertura-asset",
                     env={**os.environ, "PKG_CONFIG_PATH": str(libraries)}).strip()
        must("bash", "-c", f"{compiler} -std=c++20 -O2 -Wall -Wextra -Wpedantic -Wshadow -Werror {CONSUMER}/light.cpp {flags} "
                           f"-o '{folder}/by_pc'")
        check_lights(folder / "by_pc", assets, by)

    by = "add_subdirectory"
    inside = folder / "inside"
    code, _, errors = configure(inside, f"-DAPERTURA={SOURCE}")
    if code:
        sys.exit(f"{by}: {errors}")
    targets = must("ninja", "-C", inside, "-t", "targets", "all")
    check("GTest" not in targets and "embree" not in targets and "apertura_tests" not in targets, f"{by}: builds what it was not asked for")
    must("ninja", "-C", inside, "light")
    check_lights(inside / "light", assets, by)

    # Without what asset links, sh alone; and what is asked for and cannot be, refused.
    alone = folder / "alone"
    alone.mkdir()
    hidden = {**os.environ, "PKG_CONFIG_LIBDIR": str(folder)}
    for asked, works in (("sh OPTIONAL_COMPONENTS asset", True), ("asset", False)):
        (alone / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(alone LANGUAGES CXX)\n"
                                              f"find_package(apertura REQUIRED COMPONENTS {asked})\n"
                                              "if(TARGET apertura::asset OR NOT TARGET apertura::sh)\n  message(FATAL_ERROR targets)\nendif()\n")
        shutil.rmtree(alone / "build", ignore_errors=True)
        code, _, errors = run("cmake", "-S", alone, "-B", alone / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}", env=hidden)
        check((code == 0) == works and (works or "apertura::asset needs" in errors), f"components {asked}, without OpenImageIO: {errors}")

    # What cannot work says so.
    both = folder / "both"
    both.mkdir()
    (both / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(both LANGUAGES CXX)\n"
                                         f"add_subdirectory({SOURCE} a)\nfind_package(apertura REQUIRED)\n")
    code, _, errors = run("cmake", "-S", both, "-B", both / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    check(code and "another copy of Apertura" in errors, f"sources and package in one build: {errors}")
    (both / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(both LANGUAGES CXX)\n"
                                         f"find_package(apertura REQUIRED)\nadd_subdirectory({SOURCE} a)\n")
    code, _, errors = run("cmake", "-S", both, "-B", both / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    check(code and "another copy of Apertura" in errors, f"package and sources in one build: {errors}")
    (both / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(both LANGUAGES CXX)\n"
                                         "find_package(apertura REQUIRED COMPONENTS window)\n")
    code, _, errors = run("cmake", "-S", both, "-B", both / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    check(code and "window" in errors and "sh, asset, renderer" in errors, f"a component that is not there: {errors}")
    (folder / "file").write_text("")
    code, _, errors = run("cmake", "--install", build, "--prefix", folder / "file/below")
    check(code and "file/below" in errors, f"a prefix that cannot be written: {errors}")
    print("\n".join(wrong) if wrong else f"installed, moved and linked by {', '.join(compilers)}: find_package, pkg-config, add_subdirectory")
    sys.exit(bool(wrong))


main()
