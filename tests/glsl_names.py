"""Checks that an engine may include the formulas: every name that they declare begins with apertura, and a shader whose own names are all of
theirs without that prefix compiles.

    glsl_names.py FOLDER [SHADERS]     FOLDER: where to write; SHADERS: the texts [shaders/ of this repository, but the renderer's own]
"""
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
# The buffers of the renderer's own shaders, which are not installed.
RENDERER = {"scene.glsl", "lit.glsl", "vertex_params.glsl", "paint.glsl", "stored_bounce.glsl"}
QUALIFIERS = {"const", "highp", "mediump", "lowp", "shared", "in", "out", "inout", "flat", "uniform", "buffer", "readonly", "writeonly",
              "APERTURA_FN", "APERTURA_STD140", "static", "inline"}


def declared(text):
    """(kind, name) of what a text defines, and of all that it declares outside braces and parentheses."""
    text = re.sub(r"/\*.*?\*/", " ", re.sub(r"//.*", "", text), flags=re.S)
    out = [("macro", n) for n in re.findall(r"^[ \t]*#[ \t]*define[ \t]+(\w+)", text, re.M)]
    text = re.sub(r"^[ \t]*#.*(?:\\\n.*)*", "", text, flags=re.M)
    depth, now, all_of = 0, [], []
    for token in re.findall(r"[A-Za-z_]\w*|[\d.]\w*|[^\w\s]", text):
        depth -= token in "})]"
        if depth == 0:
            now.append(token)
        depth += token in "{(["
        # A declaration ends with a semicolon, a function also with its body.
        if depth == 0 and (token == ";" or token == "}" and ")" in now and "=" not in now and "struct" not in now):
            all_of.append(now)
            now = []
    for words in all_of:
        if "struct" in words and "}" in words:
            at = words.index("}")
            out += [("type", w) for w in words[:at] if re.match("[A-Za-z_]", w) and w not in QUALIFIERS | {"struct"}]
            out += [("constant", w) for w in words[at:] if re.match("[A-Za-z_]", w)]
            continue
        parts, part = [], []
        for word in words:
            if word in ",;":
                parts.append(part)
                part = []
            else:
                part.append(word)
        for i, part in enumerate([*parts, part]):
            part = part[:part.index("=")] if "=" in part else part
            names = [w for w in part if re.match("[A-Za-z_]", w) and w not in QUALIFIERS]
            if len(names) > (i == 0):
                out.append(("function" if ")" in part else "constant", names[-1]))
    return out


def check_itself():
    """What would slip past a check of the first word of a line."""
    slips = {"const F APERTURA_A = 1.0, LEAK = 2.0;": "LEAK", "AperturaFloat leak;": "leak", "highp float leak(float x) { return x; }": "leak",
             "float\nleak(float x)\n{ return x; }": "leak", "const float[2] LEAK = float[2](0.0, 1.0);": "LEAK",
             "   float leak(float a, float b) { float inside = a; return inside; }": "leak", "shared float leak[4];": "leak",
             "struct Leak { float inside; };": "Leak", "#define LEAK(x) x": "LEAK", "struct Apertura { int a; } leak;": "leak"}
    for text, name in slips.items():
        names = [n for _, n in declared("const float APERTURA_B = f(1.0, two);\n" + text + "\nconst float APERTURA_C = 3.0;\n")]
        if name not in names or {"inside", "two", "f", "a", "b"} & set(names) or "APERTURA_B" not in names or "APERTURA_C" not in names:
            sys.exit(f"this check itself errs: of '{text}' it sees {names}")


def main():
    check_itself()
    folder = pathlib.Path(sys.argv[1])
    shaders = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else SOURCE / "shaders"
    folder.mkdir(parents=True, exist_ok=True)
    wrong, plain = [], {}
    for path in sorted(shaders.glob("*.glsl")):
        if path.name in RENDERER and len(sys.argv) == 2:
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
    # As an engine includes them, below a folder that is ours.
    root = folder / "include"
    (root / "apertura").mkdir(parents=True, exist_ok=True)
    link = root / "apertura/shaders"
    link.unlink(missing_ok=True)
    link.symlink_to(shaders.resolve())
    made = subprocess.run(["glslangValidator", "-V", "--target-env", "vulkan1.3", f"-I{folder}", f"-I{root}", "-o", folder / "engine.spv",
                           SOURCE / "tests/consumer/engine.comp"], capture_output=True, text=True)
    if made.returncode:
        wrong.append(made.stdout)
    print("\n".join(wrong) if wrong else f"{len(names)} names of an engine's own beside ours")
    sys.exit(bool(wrong))


main()
