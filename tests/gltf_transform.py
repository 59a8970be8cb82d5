#!/usr/bin/env python3
"""What is left of an asset after glTF-Transform copied, welded, reordered or pruned it: a model of fixed size is an attribute and stays, what
`auto` chose belongs to an order of vertices, and what is no longer there is said in a note.

gltf_transform.py PROGRAM NODE_MODULES
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile


def main():
    program, modules = sys.argv[1], str(pathlib.Path(sys.argv[2]).resolve())
    script = pathlib.Path(__file__).with_suffix(".mjs")
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for model in ("firm-2", "auto"):
            asset = f"{folder}/{model}.glb"
            subprocess.run([program, "bake", "builtin:arcade", "-o", asset, "--rays", "64", "--model", model], check=True, stdout=subprocess.DEVNULL)
            for step in ("copy", "weld", "reorder", "prune"):
                out = f"{folder}/{model}-{step}.glb"
                subprocess.run(["node", script, asset, step, out], check=True, stdout=subprocess.DEVNULL, env=os.environ | {"NODE_MODULES": modules})
                found = json.loads(subprocess.run([program, "info", out, "--json"], check=True, capture_output=True, text=True).stdout)
                kept = model == "firm-2" or step == "copy"
                right = found["model"] == (model if kept else "sh") and (kept or any("the four numbers alone" in n for n in found.get("notes", [])))
                subprocess.run([program, "render", out, "-o", f"{folder}/a.png", "--size", "32x32"] + (["--model", model] if kept else []), check=True, stdout=subprocess.DEVNULL)
                print(f"{model}, {step}: {found['model']}{'' if right else ', which is wrong'}; " + "; ".join(found.get("notes", [])))
                wrong += not right
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
