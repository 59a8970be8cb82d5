"""Small files of every kind that Apertura reads, made here: what fuzzing starts from.

    seeds.py FOLDER [PROGRAM]      PROGRAM, the built apertura, bakes some of them into assets
"""
import json
import math
import pathlib
import struct
import subprocess
import sys
import zlib


def glb(document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def split_glb(data):
    """The JSON and the binary chunk of a .glb."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5]


def cube_document():
    """A cube on a floor: interleaved, quantised and sparse accessors, instances, an image, a camera, two scenes."""
    binary = bytearray()
    views, accessors = [], []

    def view(data, **more):
        binary.extend(b"\0" * (-len(binary) % 4))
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), **more})
        binary.extend(data)
        return len(views) - 1

    def accessor(view_index, component, kind, count, **more):
        accessors.append({"bufferView": view_index, "componentType": component, "type": kind, "count": count, **more})
        return len(accessors) - 1

    interleaved = b"".join(struct.pack("<6f", *c, *(v * 2 - 1 for v in c)) for c in CORNERS)
    both = view(interleaved, byteStride=24)
    position = accessor(both, 5126, "VEC3", 8, min=[0, 0, 0], max=[1, 1, 1])
    normal = accessor(both, 5126, "VEC3", 8, byteOffset=12)
    faces = accessor(view(bytes(FACES)), 5121, "SCALAR", 36)
    quads = view(struct.pack("<16h", 0, 0, 0, 0, 0, 0, 9, 0, 9, 0, 0, 0, 8, 0, 8, 0), byteStride=8)
    last = {"indices": {"bufferView": view(b"\3"), "componentType": 5121}, "values": {"bufferView": view(struct.pack("<3h", 9, 0, 9))}}
    floor = accessor(quads, 5122, "VEC3", 4, sparse={"count": 1, **last})
    places = accessor(view(struct.pack("<9f", 1, 0, 1, 4, 0, 4, 6, 0, 2)), 5126, "VEC3", 3)
    turns = accessor(view(struct.pack("<12h", *([0, 0, 0, 32767] * 3))), 5122, "VEC4", 3, normalized=True)
    image = view(png(2, 2, 8, [0, 255, 90, 7]))
    document = {
        "asset": {"version": "2.0", "generator": "seeds"},
        "scene": 0,
        "scenes": [{"nodes": [0, 4]}, {"nodes": [3]}],
        "nodes": [
            {"children": [1, 2], "name": "root", "extras": {"keep": [1, None, {}]}},
            {"mesh": 0, "translation": [3, 0, 3], "rotation": [0, 0.6, 0, 0.8], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "ROTATION": turns}}}},
            {"mesh": 1},
            {"mesh": 0, "scale": [2, 2, 2]},
            {"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 3, 14, 1]},
        ],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": position, "NORMAL": normal}, "indices": faces, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": floor}, "mode": 5}]},
        ],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_mesh_quantization"],
        "extensionsRequired": ["EXT_mesh_gpu_instancing", "KHR_mesh_quantization"],
        "buffers": [{"byteLength": 0}],
        "bufferViews": views,
        "accessors": accessors,
    }
    document["buffers"][0]["byteLength"] = len(binary)
    return document, bytes(binary)


def encoded_vertices(count, stride):
    """EXT_meshopt_compression, ATTRIBUTES: `count` (16 at most) vertices of zeros but for a ramp in the first byte."""
    out = bytearray(b"\xa0")
    for byte in range(stride):
        out.append(0b11 if byte == 0 else 0)  # one group of 16: raw bytes, or none
        if byte == 0:
            out.extend([0] + [2] * 15)  # zigzag deltas of 1
    return bytes(out) + b"\0" * (32 - stride) + b"\0" * stride


def compressed_document():
    """A strip of 16 vertices, compressed. They lie on a line: its triangles have no area."""
    packed = encoded_vertices(16, 12)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}],
        "extensionsUsed": ["EXT_meshopt_compression", "KHR_mesh_quantization"],
        "extensionsRequired": ["EXT_meshopt_compression", "KHR_mesh_quantization"],
        "buffers": [{"byteLength": len(packed)}, {"byteLength": 192, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}],
        "bufferViews": [{"buffer": 1, "byteLength": 192, "byteStride": 12, "extensions": {"EXT_meshopt_compression": {
            "buffer": 0, "byteLength": len(packed), "byteStride": 12, "count": 16, "mode": "ATTRIBUTES"}}}],
        "accessors": [{"bufferView": 0, "componentType": 5121, "type": "VEC3", "count": 16}],
    }
    return document, packed


def png(width, height, bits, values, colour=0):
    channels = {0: 1, 2: 3, 4: 2}[colour]
    pixel = struct.Struct(">" + ("B" if bits == 8 else "H") * (width * channels))
    rows = b"".join(b"\0" + pixel.pack(*values[y * width * channels : (y + 1) * width * channels]) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def tiff(width, height, code, sample_format, bits, values, tile=0):
    """One channel, in one strip or in tiles of `tile` texels; with GDAL's NoData."""
    sample = struct.Struct("<" + code)
    row = lambda y, x0, x1: b"".join(sample.pack(values[y * width + x] if y < height and x < width else 0) for x in range(x0, x1))
    if tile:
        parts = [b"".join(row(y, x, x + tile) for y in range(y0, y0 + tile)) for y0 in range(0, height, tile) for x in range(0, width, tile)]
    else:
        parts = [b"".join(row(y, 0, width) for y in range(height))]
    no_data = b"-32767\0\0"
    fields = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 1, bits), (259, 3, 1, 1), (262, 3, 1, 1), (277, 3, 1, 1)]
    if tile:
        fields += [(322, 3, 1, tile), (323, 3, 1, tile)]
    else:
        fields += [(278, 3, 1, height)]
    fields += [(339, 3, 1, sample_format), (42113, 2, 7, None)]
    places, sizes = (324, 325) if tile else (273, 279)
    fields += [(places, 4, len(parts), None), (sizes, 4, len(parts), None)]
    fields.sort()
    at = 8 + 2 + 12 * len(fields) + 4
    extra, offsets = bytearray(), []
    extra += no_data
    begin = at + len(no_data) + 8 * len(parts)
    for part in parts:
        offsets.append(begin)
        begin += len(part)
    lists = {places: offsets, sizes: [len(p) for p in parts]}
    directory = struct.pack("<H", len(fields))
    for tag, kind, count, value in fields:
        if tag == 42113:
            value = at
        elif tag in lists:
            if count == 1:
                value = lists[tag][0]
            else:
                value = at + len(extra)
            extra += struct.pack(f"<{count}I", *lists[tag])
        directory += struct.pack("<HHI", tag, kind, count) + (struct.pack("<HH", value, 0) if kind == 3 else struct.pack("<I", value))
    return b"II*\0" + struct.pack("<I", 8) + directory + struct.pack("<I", 0) + bytes(extra) + b"".join(parts)


def exr(width, height, values):
    """One channel Y of floats, without compression."""
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data

    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
    header += attribute(b"channels", b"chlist", b"Y\0" + struct.pack("<iB3xii", 2, 0, 1, 1) + b"\0")
    header += attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", box)
    header += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)) + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    first = len(header) + 8 * height
    size = 8 + 4 * width
    lines = b"".join(struct.pack("<ii", y, 4 * width) + struct.pack(f"<{width}f", *values[y * width : (y + 1) * width]) for y in range(height))
    return header + struct.pack(f"<{height}Q", *(first + y * size for y in range(height))) + lines


def mesh_texts():
    triangles = [[CORNERS[i] for i in FACES[k : k + 3]] for k in range(0, 36, 3)]
    obj = "mtllib nothing.mtl\n" + "".join("v %g %g %g\n" % c for c in CORNERS) + "vn 0 1 0\nusemtl a\ng one\n"
    obj += "".join("f %d %d %d\n" % tuple(i + 1 for i in FACES[k : k + 3]) for k in range(0, 36, 3)) + "f 1//1 2//1 4//1 3//1\n"
    ply = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n"
    head = ply.replace("ascii", "binary_little_endian").encode()
    binary = b"".join(struct.pack("<3f", *c) for c in CORNERS) + b"".join(struct.pack("<B3i", 3, *FACES[k : k + 3]) for k in range(0, 36, 3))
    ply += "".join("%g %g %g\n" % c for c in CORNERS) + "".join("3 %d %d %d\n" % tuple(FACES[k : k + 3]) for k in range(0, 36, 3))
    stl = "solid cube\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % c for c in t) + "endloop\nendfacet\n" for t in triangles) + "endsolid cube\n"
    packed = b"\0" * 80 + struct.pack("<I", 12) + b"".join(struct.pack("<12fH", 0, 0, 0, *(x for c in t for x in c), 0) for t in triangles)
    return {"cube.obj": obj.encode(), "text.ply": ply.encode(), "binary.ply": head + binary, "text.stl": stl.encode(), "binary.stl": packed}


def height_maps():
    heights = [int(20 + 10 * math.sin(x * 0.9) + 5 * math.cos(y * 1.3)) for y in range(9) for x in range(11)]
    return {
        "grey8.png": png(11, 9, 8, heights),
        "grey16.png": png(11, 9, 16, [h * 30 for h in heights]),
        "alpha.png": png(11, 9, 8, [v for h in heights for v in (h, 255 * (h % 3 > 0))], colour=4),
        "rgb.png": png(11, 9, 8, [v for h in heights for v in (1, 134, h)], colour=2),
        "int16.tif": tiff(11, 9, "h", 2, 16, [h if h % 7 else -32767 for h in heights]),
        "float.tif": tiff(11, 9, "f", 3, 32, heights),
        "tiled.tif": tiff(11, 9, "f", 3, 32, heights, tile=16),
        "geo.tif": (pathlib.Path(__file__).resolve().parent.parent / "data/heights_geotiff.tif").read_bytes(),
        "float.exr": exr(11, 9, heights),
    }


def write_seeds(folder, program=None):
    """Writes FOLDER/gltf, meshes, heights and, with a program to bake them, assets."""
    folder = pathlib.Path(folder)
    for name in ("gltf", "meshes", "heights", "assets"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    document, binary = cube_document()
    (folder / "gltf/cube.glb").write_bytes(glb(document, binary))
    separate = json.loads(json.dumps(document))
    separate["buffers"][0]["uri"] = "cube.bin"
    (folder / "gltf/cube.bin").write_bytes(binary)
    (folder / "gltf/cube.gltf").write_text(json.dumps(separate, indent=1))
    (folder / "gltf/packed.glb").write_bytes(glb(*compressed_document()))
    for name, data in mesh_texts().items():
        (folder / "meshes" / name).write_bytes(data)
    for name, data in height_maps().items():
        (folder / "heights" / name).write_bytes(data)
    if program:
        for name, options in {"sh": [], "sixteen": ["--bits", "16"], "firm-2": ["--model", "firm-2"], "auto": ["--model", "auto"], "horizon": ["--model", "horizon"]}.items():
            subprocess.run([program, "bake", folder / "gltf/cube.glb", "-o", folder / f"assets/{name}.glb", "--rays", "16", *options], check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    write_seeds(*sys.argv[1:3])
