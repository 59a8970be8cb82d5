"""Adds two models to a copy of the sources, as README.md says, builds it, and shows that everything finds them.

    add_model.py FOLDER     FOLDER: where the copy goes and is built

One is made from the four numbers: a cap whose opacity falls off linearly to its rim, at the
light's centre (which steps too far under large lights: it is a baseline). The other is stored: one fitted cap.
"""
import json
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent


def insert(path, before, text):
    content = path.read_text()
    if content.count(before) != 1:
        sys.exit(f"{path}: '{before}' stands there {content.count(before)} times")
    path.write_text(content.replace(before, text + before))


def add(folder):
    receiver = folder / "shaders/receiver.glsl"
    count = int(receiver.read_text().split("APERTURA_MODEL_COUNT = ")[1].split(";")[0])
    insert(receiver, "const int APERTURA_MODEL_COUNT", f"const int APERTURA_MODEL_FALLOFF = {count};\nconst int APERTURA_MODEL_MULTI_1 = {count + 1};\n")
    receiver.write_text(receiver.read_text().replace(f"APERTURA_MODEL_COUNT = {count};", f"APERTURA_MODEL_COUNT = {count + 2};"))
    models = folder / "shaders/models.glsl"
    insert(models, "        default: e = aperturaIrradianceByRival(", """\
        case APERTURA_MODEL_FALLOFF: e = open * aperturaFalloffTo(receiver.params[0], light); break;
        case APERTURA_MODEL_MULTI_1: e = open * aperturaVisibleFractionOfUnion(receiver, 1, light, lightClass); break;
""")
    insert(models, "// E of a cap light at the receiver, by the formula", """\
APERTURA_FN AperturaFloat aperturaFalloffTo(AperturaVec4 cap, AperturaCapLight light) {
    return max(cap.w - AperturaFloat(1.0) + dot(AperturaVec3(cap), light.axis), AperturaFloat(0.0)) / max(cap.w, aperturaSmall(1e-6));
}

""")
    table = folder / "sh/models.cpp"
    insert(table, "};\n// clang-format on\nstatic_assert(std::size(kModels)", """\
    {.id = APERTURA_MODEL_FALLOFF, .name = "falloff", .numbers = 3, .slots = 1, .baseline = true, .fromVisibility = oneCap, .what = "linear falloff"},
    {.id = APERTURA_MODEL_MULTI_1, .name = "multi-1", .kind = Kind::Union, .parts = 1, .numbers = 3, .slots = 2, .stored = {Cap}, .what = "one aperture"},
""")
    insert(folder / "bake/fit/fit.cpp", '    {"auto", "fit"', """\
    {"multi-1", "fit", APERTURA_MODEL_MULTI_1, -1, "one aperture", fittedLobes<APERTURA_MODEL_MULTI_1>},
""")
    insert(folder / "bake/fit/fit.cpp", "        {APERTURA_MODEL_CAP_ANTI, {Both", """\
        {APERTURA_MODEL_MULTI_1, {Complement, asCaps(1), capsOf<1>, lobesOfCaps<1>}},
""")


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for top in ("CMakeLists.txt", "sh", "shaders", "bake", "runtime", "tools", "tests"):
        for source in [SOURCE / top] if (SOURCE / top).is_file() else sorted(p for p in (SOURCE / top).rglob("*") if p.is_file()):
            copy = folder / source.relative_to(SOURCE)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    add(folder)
    build = folder / "build"
    subprocess.run(["cmake", "-S", folder, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", build, "apertura_program", "apertura_tests"], check=True, stdout=subprocess.DEVNULL)
    out = folder / "out"
    out.mkdir(exist_ok=True)
    run = lambda *words: subprocess.run([build / "tools/apertura", *words], check=True, capture_output=True, text=True).stdout
    run("compare", "builtin:canyon", "--models", "falloff,multi-1", "--receivers", "60", "--json", out / "compare.json")
    found = {row["model"] for row in json.loads((out / "compare.json").read_text())["rows"]}
    assert found == {"falloff", "multi-1"}, found
    run("bake", "builtin:canyon", "-o", out / "canyon.glb", "--rays", "64", "--model", "multi-1")
    assert json.loads(run("info", out / "canyon.glb", "--json"))["model"] == "multi-1"
    for model in ("falloff", "multi-1"):
        run("render", out / "canyon.glb", "-o", out / f"{model}.png", "--size", "96x64", "--model", model)
    run("chart", "builtin:canyon", "-o", out / "chart", "--models", "falloff,multi-1", "--receivers", "60")
    csv = (out / "chart/models.csv").read_text() if (out / "chart/models.csv").exists() else "".join(p.read_text() for p in (out / "chart").glob("*.csv"))
    assert "falloff" in csv and "multi-1" in csv
    tests = "Models.*:Stability.*:GpuTest.*-*Auto*"
    subprocess.run([build / "tests/tests", "--gtest_brief=1", f"--gtest_filter={tests}"], check=True)
    print("a model of the four numbers and a stored one: found by compare, bake, info, render, chart and the tests that hold for every model")


main()
