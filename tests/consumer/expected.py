"""What tests/consumer/light.cpp prints, computed from the bytes of the asset by what runtime/README.md and sh/README.md say alone: nothing of
Apertura's own code runs here. For sh-l1 and firm-2, and lights no larger than the sun, whose formulas are closed.

    expected.py ASSET MODEL VERTEX X Y Z DEGREES
"""
import json
import math
import struct
import sys


def read_glb(path):
    data = open(path, "rb").read()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def element(document, binary, accessor, index):
    a = document["accessors"][accessor]
    view = document["bufferViews"][a["bufferView"]]
    size, code, top = {5126: (4, "f", 1), 5120: (1, "b", 127), 5122: (2, "h", 32767)}[a["componentType"]]
    count = {"VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
    start = view.get("byteOffset", 0) + a.get("byteOffset", 0) + index * view.get("byteStride", size * count)
    return [x if code == "f" else max(x / top, -1) for x in struct.unpack_from(f"<{count}{code}", binary, start)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(v):
    return [x / math.sqrt(dot(v, v)) for x in v]


def octahedral(x, y):
    z = 1 - abs(x) - abs(y)
    if z < 0:
        x, y = math.copysign(1 - abs(y), x), math.copysign(1 - abs(x), y)
    return unit([x, y, z])


def lobes(document, binary, vertex, attributes):
    """firm-2: the visibility of a direction, from its six numbers."""
    numbers = [n for k in (0, 1) for n in element(document, binary, attributes[f"_VISIBILITY_NUMBERS_{k}"], vertex)]
    complement, softer = numbers[2] < 0, numbers[5] < 0
    slope = 15 if softer else 60

    def visible(w):
        product = 1
        for k in (0, 3):
            rim = 2 * abs(numbers[k + 2]) - 1
            ratio = math.sin(abs(rim) / .9 * 1.37) / math.sin(1.37) if abs(rim) <= .9 else 1 + ((abs(rim) - .9) / .1) ** 3
            offset = math.copysign(slope * ratio, rim)
            f = offset + slope * dot(octahedral(numbers[k], numbers[k + 1]), w)
            product *= .5 + f / (2 * math.sqrt(1 + f * f))
        return 1 - product if complement else product

    return visible


def main():
    path, model, vertex = sys.argv[1], sys.argv[2], int(sys.argv[3])
    towards = unit([float(x) for x in sys.argv[4:7]])
    radius = math.radians(float(sys.argv[7]))
    document, binary = read_glb(path)
    node = next(n for n in document["nodes"] if "mesh" in n)
    assert not {"matrix", "rotation", "scale"} & node.keys(), "this script reads instances that stand as they were made"
    attributes = document["meshes"][node["mesh"]]["primitives"][0]["attributes"]
    normal = unit(element(document, binary, attributes["NORMAL"], vertex))
    x, y, z, w = element(document, binary, attributes["_VISIBILITY"], vertex)
    area = 2 * math.pi * ((w + 1) / 2) ** 2
    direction = [area * c for c in (x, y, z)]
    most = area * (1 - area / (4 * math.pi))
    length = math.sqrt(dot(direction, direction))
    if length > most:
        direction = [c * most / length for c in direction]
    unblocked = math.pi * math.sin(radius) ** 2 * max(dot(normal, towards), 0)
    if model == "sh-l1":
        blur = (1 + math.cos(radius)) / 2
        visible = min(max((area + 3 * blur * dot(direction, towards)) / (4 * math.pi), 0), 1)
    else:
        visible = lobes(document, binary, vertex, attributes)(towards)
    print(f"{unblocked * visible:.9g} {max(dot(normal, direction), 0):.9g}")


main()
