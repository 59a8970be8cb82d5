"""Checks that an engine may include the formulas: every name that they declare begins with apertura, and a shader whose own names are all of
theirs without that prefix compiles.

    glsl_names.py FOLDER [SHADERS]     FOLDER: where to write; SHADERS: the texts [shaders/ of this repository]
"""
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
# The buffers of the renderer's own shaders, which engines do not include.
RENDERER = {"scene.glsl", "lit.glsl", "vertex_params.glsl", "frame.glsl", "evaluate.glsl"}


def declared(text):
    """(kind, name) of what a text declares or defines at its top level."""
    text = re.sub(r"//.*", "", text)
    out = [("function", n) for n in re.findall(r"^(?:APERTURA_FN )?\w+ (\w+)\(", text, re.M)]
    out += [("type", n) for n in re.findall(r"^struct (?:APERTURA_STD140 )?(\w+)", text, re.M)]
    out += [("constant", n) for n in re.findall(r"^const \w+ (\w+)", text, re.M)]
    out += [("macro", n) for n in re.findall(r"^ *# *define (\w+)", text, re.M)]
    return out


def main():
    folder = pathlib.Path(sys.argv[1])
    shaders = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else SOURCE / "shaders"
    folder.mkdir(parents=True, exist_ok=True)
    wrong, plain = [], {}
    for path in sorted(shaders.glob("*.glsl")):
        if path.name in RENDERER:
            continue
        for kind, name in declared(path.read_text()):
            prefix = next((p for p in ("APERTURA_", "Apertura", "apertura") if name.startswith(p)), None)
            if not prefix:
                wrong.append(f"{path.name}: the {kind} {name} has no prefix")
                continue
            bare = name[len(prefix):]
            plain.setdefault(bare[0].lower() + bare[1:] if kind == "function" else bare, kind)
    if len(plain) < 150:
        wrong.append(f"only {len(plain)} names were found")
    names = []
    for name, kind in plain.items():
        if name in ("CPP", "HALF", "FN", "STD140") or name.endswith("_GLSL"):
            continue
        kinds = {"function": f"float {name}(float x) {{ return x; }}", "type": f"struct {name} {{ int of; }};"}
        names.append(kinds.get(kind, f"#define {name} 7"))
    names.sort(key=lambda line: line.startswith("#"))
    (folder / "engine_names.glsl").write_text("\n".join(names) + "\n")
    made = subprocess.run(["glslangValidator", "-V", "--target-env", "vulkan1.3", f"-I{folder}", f"-I{shaders}", "-o", folder / "engine.spv",
                           SOURCE / "tests/consumer/engine.comp"], capture_output=True, text=True)
    if made.returncode:
        wrong.append(made.stdout)
    print("\n".join(wrong) if wrong else f"{len(names)} names of an engine's own beside ours")
    sys.exit(bool(wrong))


main()
