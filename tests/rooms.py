"""Checks that the rooms of the house see each other only along the arrows.

    rooms.py BUILD [--without FOLDER]     BUILD: a build folder of Ninja's. FOLDER: where to build sh and asset alone

For each room: everything that its sources include lies in the rooms that it may see, of outside libraries it knows neither Embree nor
Vulkan but where it may, and a source that includes a header against the arrows does not compile.
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parent.parent
# Each room's target and folder, the folders that it may include, and the outside libraries kept from everybody else.
ROOMS = {
    "sh": ("sh", {"sh", "shaders"}, set()),
    "asset": ("runtime/asset", {"runtime/asset", "sh", "shaders"}, set()),
    "directions": ("bake/sampling", {"bake/sampling", "sh", "shaders"}, set()),
    "scene": ("bake/scene", {"bake/scene", "bake/sampling", "runtime/asset", "sh", "shaders"}, set()),
    "renderer": ("runtime/render", {"runtime/render", "runtime/asset", "sh", "shaders"}, {"vulkan"}),
    "sampling": ("bake/sampling", {"bake/sampling", "runtime/asset", "sh", "shaders"}, {"embree"}),
    "fit": ("bake/fit", {"bake/fit", "bake/sampling", "runtime/asset", "sh", "shaders"}, set()),
    "measure": ("bake/measure", {"bake/measure", "bake/fit", "bake/scene", "bake/sampling", "runtime/asset", "sh", "shaders"}, set()),
}
FOLDERS = sorted({folder for folder, _, _ in ROOMS.values()} | {"shaders"})


def headers(build):
    """What each object of the build was made from."""
    out, of = {}, None
    for line in subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout.split("\n"):
        if line.startswith(" "):
            out[of].append(line.strip())
        elif ":" in line:
            of = line.split(":")[0]
            out[of] = []
    return out


def home(path):
    """The folder of this repository that a header lies in, by the longest name."""
    path = path.resolve()
    if not path.is_relative_to(SOURCE):
        return None
    relative = str(path.relative_to(SOURCE))
    return next((f for f in sorted(FOLDERS, key=len, reverse=True) if relative.startswith(f + "/")), None)


def main():
    build = pathlib.Path(sys.argv[1])
    made = headers(build)
    commands = subprocess.run(["ninja", "-C", build, "-t", "commands"], check=True, capture_output=True, text=True).stdout.split("\n")
    wrong = []
    for room, (folder, sees, libraries) in ROOMS.items():
        objects = {o: d for o, d in made.items() if f"/apertura_{room}.dir/" in o and (build / o).exists()}
        if not objects:
            wrong.append(f"{room}: nothing of it is built")
        for o, files in objects.items():
            for file in files:
                path = build / file
                where = home(path)
                if where and where not in sees:
                    wrong.append(f"{room}: {o} includes {file}")
                for library in {"vulkan", "embree"} - libraries:
                    outside = not path.resolve().is_relative_to(SOURCE) and not path.resolve().is_relative_to(build.resolve())
                    if outside and re.search(f"/{library}[0-9]*/", str(path)):
                        wrong.append(f"{room}: {o} includes {file}")
        # A source against the arrows, compiled as the room's own are.
        command = next(c for c in commands if f"/apertura_{room}.dir/" in c and " -c " in c)
        words = shlex.split(command)
        flags = [w for w in words[1:] if re.match("-I|-isystem|-std|-D", w) or w.startswith("/usr/include")]
        for other in FOLDERS:
            header = next(iter(sorted((SOURCE / other).glob("*.h"))), None)
            if other in sees or not header:
                continue
            with tempfile.TemporaryDirectory() as place:
                text = pathlib.Path(place) / "against.cpp"
                text.write_text(f'#include "apertura/{other}/{header.name}"\n')
                tried = subprocess.run([words[0], *flags, "-fsyntax-only", text], cwd=build, capture_output=True, text=True)
                if tried.returncode == 0 or f"apertura/{other}/{header.name}: No such file" not in tried.stderr and "file not found" not in tried.stderr:
                    wrong.append(f"{room}: may include {other}/{header.name}")
    if len(sys.argv) > 3:
        apart = sys.argv[3]
        subprocess.run(["cmake", "-S", SOURCE, "-B", apart, "-G", "Ninja", "--no-warn-unused-cli", "-DAPERTURA_BAKE=OFF", "-DAPERTURA_RENDER=OFF",
                        *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{p}=ON" for p in ("Vulkan", "embree", "TBB", "assimp", "TIFF", "Eigen3", "CLI11", "GTest"))], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["ninja", "-C", apart], check=True, stdout=subprocess.DEVNULL)
    print("\n".join(wrong) if wrong else f"{len(ROOMS)} rooms, no include against the arrows")
    sys.exit(bool(wrong))


main()
