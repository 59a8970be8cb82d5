"""Writes the small scenes of this folder, each byte by its format's specification, without the libraries that read them.

    make.py [FOLDER]     [this folder]

Height maps are 5 x 4 texels of 100 + 10 x + 3 y, less 200 where they may be negative; texel (2, 1) has no data where the format can say so.
Meshes are a unit cube whose lowest corner is at the origin, of 12 triangles, but where said otherwise. tests/importers_test.cpp reads them.
"""
import base64
import json
import pathlib
import struct
import sys
import zlib

WIDTH, HEIGHT = 5, 4


def height(x, y):
    return 100 + 10 * x + 3 * y


def texels(f):
    return [f(x, y) for y in range(HEIGHT) for x in range(WIDTH)]


def png(bits, channels, rows):
    """PNG, 3rd edition (W3C, 2025). rows: lists of samples."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + struct.pack(f">{len(row)}{'H' if bits == 16 else 'B'}", *row) for row in rows)
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, {1: 0, 2: 4, 3: 2}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def tiff(values, code, sample_format, no_data=None, place=()):
    """TIFF 6.0 (Adobe, 1992), one strip, not compressed; GDAL's tag 42113 for no data; GeoTIFF's tags: tag, type, code, values."""
    size = struct.calcsize(code)
    data = struct.pack(f"<{len(values)}{code}", *values)
    text = str(no_data).encode() + b"\0"
    tags = [(256, 3, 1, WIDTH), (257, 3, 1, HEIGHT), (258, 3, 1, 8 * size), (259, 3, 1, 1), (262, 3, 1, 1), (273, 4, 1, 8),
            (277, 3, 1, 1), (278, 3, 1, HEIGHT), (279, 4, 1, len(data)), (282, 5, 1, 8 + len(data)), (283, 5, 1, 8 + len(data)),
            (296, 3, 1, 1), (339, 3, 1, sample_format)]
    data += struct.pack("<II", 1, 1)  # the resolution: none
    for tag, kind, geo, numbers in place:
        tags.append((tag, kind, len(numbers), 8 + len(data)))
        data += struct.pack(f"<{len(numbers)}{geo}", *numbers)
    after = 8 + len(data)
    if no_data is not None:
        tags.append((42113, 2, len(text), after + 2 + 12 * (len(tags) + 1) + 4 if len(text) > 4 else int.from_bytes(text.ljust(4, b"\0"), "little")))
    directory = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *t) for t in tags) + b"\0\0\0\0"
    return b"II*\0" + struct.pack("<I", after) + data + directory + text


def exr(values, half):
    """OpenEXR file layout (Academy Software Foundation, 2023): one channel Y, scan lines, not compressed."""
    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(data)) + data
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    header = (b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
              + attribute("channels", "chlist", b"Y\0" + struct.pack("<iBxxxii", 1 if half else 2, 0, 1, 1) + b"\0")
              + attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window)
              + attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0")
              + attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
              + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0")
    code = "e" if half else "f"
    lines = [struct.pack("<iI", y, WIDTH * struct.calcsize(code)) + struct.pack(f"<{WIDTH}{code}", *values[y * WIDTH:(y + 1) * WIDTH])
             for y in range(HEIGHT)]
    offsets, at = [], len(header) + 8 * HEIGHT
    for line in lines:
        offsets.append(at)
        at += len(line)
    return header + struct.pack(f"<{HEIGHT}Q", *offsets) + b"".join(lines)


CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # counter-clockwise from outside
TRIANGLES = [t for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))]


def gltf(views, accessors, primitives, node=None, buffers=None, **more):
    """views: bytes, or (bytes, members)."""
    binary, out = b"", []
    for view in views:
        data, members = view if isinstance(view, tuple) else (view, {})
        binary += b"\0" * (-len(binary) % 4)
        out.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), **members})
        binary += data
    uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **(node or {})}],
                       "meshes": [{"primitives": primitives}], "accessors": accessors, "bufferViews": out,
                       "buffers": [{"byteLength": len(binary), "uri": uri}, *(buffers or [])], **more}, indent=1).encode() + b"\n"


def glb(document):
    """The same as a .glb."""
    parsed = json.loads(document)
    binary = base64.b64decode(parsed["buffers"][0].pop("uri").split(",")[1])
    text = json.dumps(parsed).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" + text
            + struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def floats(vectors):
    return struct.pack(f"<{3 * len(vectors)}f", *(x for v in vectors for x in v))


def positions(count=8, **more):
    return {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": count, "min": [0, 0, 0], "max": [1, 1, 1], **more}


def indices(view, values, code="H", kind=5123):
    return struct.pack(f"<{len(values)}{code}", *values), {"bufferView": view, "componentType": kind, "type": "SCALAR", "count": len(values)}


FLAT = [i for t in TRIANGLES for i in t]


def plain_cube():
    data, accessor = indices(1, FLAT)
    return gltf([floats(CORNERS), data], [positions(), accessor], [{"attributes": {"POSITION": 0}, "indices": 1}])


def interleaved_cube():
    """Positions and normals in one view of stride 28, with four bytes between them and the next; indices of 8 bits."""
    data = b"".join(floats([c, tuple((2 * x - 1) / 3 ** .5 for x in c)]) + b"\xff\xff\xff\xff" for c in CORNERS)
    numbers, accessor = indices(1, FLAT, "B", 5121)
    return gltf([(data, {"byteStride": 28}), numbers],
                [positions(), {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "type": "VEC3", "count": 8}, accessor],
                [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}])


def strips_and_fans():
    """Each side of the cube a primitive of its own: strips of four vertices, fans of four, by turns; indices of 32 bits."""
    views, accessors, primitives = [floats(CORNERS)], [positions()], []
    for i, (a, b, c, d) in enumerate(FACES):
        data, accessor = indices(i + 1, (a, b, d, c) if i % 2 else (a, b, c, d), "I", 5125)
        views.append(data)
        accessors.append(accessor)
        primitives.append({"attributes": {"POSITION": 0}, "indices": i + 1, "mode": 5 if i % 2 else 6})
    return gltf(views, accessors, primitives)


def sparse_cube():
    """All corners at the origin but those that a sparse accessor moves; no view below it."""
    moved = [i for i, c in enumerate(CORNERS) if any(c)]
    numbers, accessor = indices(2, FLAT)
    sparse = {"count": len(moved), "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 1}}
    position = positions(sparse=sparse)
    del position["bufferView"]
    return gltf([bytes(moved), floats([CORNERS[i] for i in moved]), numbers], [position, accessor],
                [{"attributes": {"POSITION": 0}, "indices": 1}])


def quantized_cube():
    """KHR_mesh_quantization: corners as normalised shorts of 0 and 32767, which the node turns and moves."""
    data = b"".join(struct.pack("<4h", *(32767 * x for x in c), 0) for c in CORNERS)
    numbers, accessor = indices(1, FLAT)
    position = {"bufferView": 0, "componentType": 5122, "normalized": True, "type": "VEC3", "count": 8, "min": [0, 0, 0], "max": [32767] * 3}
    return gltf([(data, {"byteStride": 8}), numbers], [position, accessor], [{"attributes": {"POSITION": 0}, "indices": 1}],
                node={"translation": [1, 0, 0], "rotation": [0, 0, .5 ** .5, .5 ** .5]}, extensionsUsed=["KHR_mesh_quantization"],
                extensionsRequired=["KHR_mesh_quantization"])


def compressed_attributes(data, stride, count):
    """EXT_meshopt_compression, appendix A: version 0, every group of deltas as 16 bytes."""
    first = data[:stride]
    out, last, padded = b"\xa0", first, count + -count % 16
    for k in range(stride):
        deltas, before = [], last[k]
        for v in range(padded):
            byte = data[v * stride + k] if v < count else before
            delta = (byte - before) & 255
            deltas.append((delta << 1 ^ (0xff if delta & 128 else 0)) & 255)
            before = byte
        out += b"\xff" * ((padded // 16 + 3) // 4) + bytes(deltas)
    return out + b"\0" * max(32 - stride, 0) + first


def compressed_indices(values):
    """The same, index sequences: deltas to one of two baselines, here always the first, in base 128."""
    out, before = b"\xd1", 0
    for value in values:
        delta = value - before
        number = ((delta << 1) ^ (delta >> 31)) << 1
        before = value
        while True:
            out += bytes([number & 127 | (128 if number > 127 else 0)])
            number >>= 7
            if not number:
                break
    return out + b"\0\0\0\0"


def compressed_cube():
    vertices, numbers = compressed_attributes(floats(CORNERS), 12, 8), compressed_indices(FLAT)
    fallback = {"byteLength": 96 + 72, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
    document = json.loads(gltf([vertices, numbers], [positions(), indices(1, FLAT)[1]], [{"attributes": {"POSITION": 0}, "indices": 1}],
                               buffers=[fallback], extensionsUsed=["EXT_meshopt_compression"],
                               extensionsRequired=["EXT_meshopt_compression"]))
    for view, (offset, length, stride, count, mode) in zip(document["bufferViews"],
                                                           ((0, 96, 12, 8, "ATTRIBUTES"), (96, 72, 2, 36, "INDICES"))):
        compressed = {**view, "byteStride": stride, "count": count, "mode": mode}
        view.clear()
        view.update({"buffer": 1, "byteOffset": offset, "byteLength": length, "extensions": {"EXT_meshopt_compression": compressed}})
    return json.dumps(document, indent=1).encode() + b"\n"


def obj():
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS] + ["f " + " ".join(str(i + 1) for i in face) for face in FACES]
    return ("# quads, from 1\n" + "\n".join(lines) + "\n").encode()


def ply(binary):
    head = (f"ply\nformat {'binary_little_endian' if binary else 'ascii'} 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
            "property float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if binary:
        return head + floats(CORNERS) + b"".join(struct.pack("<B3i", 3, *t) for t in TRIANGLES)
    return head + ("\n".join([*(f"{x} {y} {z}" for x, y, z in CORNERS), *("3 %d %d %d" % t for t in TRIANGLES)]) + "\n").encode()


def stl(binary):
    if binary:
        return b"a cube".ljust(80, b"\0") + struct.pack("<I", 12) + b"".join(
            struct.pack("<3f", 0, 0, 0) + floats([CORNERS[i] for i in t]) + b"\0\0" for t in TRIANGLES)
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % CORNERS[i] for i in t) + "endloop\nendfacet\n"
                     for t in TRIANGLES)
    return f"solid cube\n{facets}endsolid cube\n".encode()


def rows(values, channels=1):
    per = WIDTH * channels
    return [values[y * per:(y + 1) * per] for y in range(HEIGHT)]


def terrain_rgb(x, y):
    n = round((height(x, y) - 200 + 10000) / .1)
    return [n >> 16, n >> 8 & 255, n & 255]


def files():
    hole = lambda value: lambda x, y: value if (x, y) == (2, 1) else height(x, y) - 200
    rgb = [c for y in range(HEIGHT) for x in range(WIDTH) for c in terrain_rgb(x, y)]
    alpha = [c for y in range(HEIGHT) for x in range(WIDTH) for c in (height(x, y), 0 if (x, y) == (2, 1) else 65535)]
    return {
        "heights_u8.png": png(8, 1, rows(texels(height))),
        "heights_u16.png": png(16, 1, rows(texels(height))),
        "heights_u16_alpha.png": png(16, 2, rows(alpha, 2)),
        "heights_terrain_rgb.png": png(8, 3, rows(rgb, 3)),
        "heights_u16.tif": tiff(texels(height), "H", 1),
        "heights_i16_nodata.tif": tiff(texels(hole(-32768)), "h", 2, -32768),
        "heights_i32_nodata.tif": tiff(texels(hole(-9999)), "i", 2, -9999),
        "heights_f32_nodata.tif": tiff(texels(hole(-9999)), "f", 3, "-9999"),
        "heights_f32_nan.tif": tiff(texels(hole(float("nan"))), "f", 3),
        # Cells of .001 degrees whose middle is at 45 degrees north, in WGS 84 (OGC GeoTIFF 1.1).
        "heights_geotiff.tif": tiff(texels(height), "H", 1, place=[
            (33550, 12, "d", (0.001, 0.001, 0)), (33922, 12, "d", (0, 0, 0, 10, 45.002, 0)),
            (34735, 3, "H", (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326))]),
        # A tenth of a foot above 500 feet, by GDAL's metadata; no data where the number is 130, the file says +130.
        "heights_scaled.tif": tiff(texels(height), "H", 1, no_data="+130", place=[(42112, 2, "B", (
            b'<GDALMetadata><Item name="OFFSET" sample="0" role="offset">500</Item><Item name="SCALE" sample="0" role="scale">0.1</Item>'
            b'<Item name="UNITTYPE" sample="0" role="unittype">ft</Item></GDALMetadata>\0'))]),
        "heights_f64.tif": tiff(texels(lambda x, y: height(x, y) - 200), "d", 3),
        "heights_f32.exr": exr(texels(hole(float("nan"))), False),
        "heights_f16.exr": exr(texels(hole(float("nan"))), True),
        "cube.gltf": plain_cube(),
        "cube.glb": glb(plain_cube()),
        "cube_interleaved.glb": glb(interleaved_cube()),
        "cube_strips_fans.gltf": strips_and_fans(),
        "cube_sparse.gltf": sparse_cube(),
        "cube_quantized.glb": glb(quantized_cube()),
        "cube_compressed.gltf": compressed_cube(),
        "cube.obj": obj(),
        "cube_ascii.ply": ply(False),
        "cube_binary.ply": ply(True),
        "cube_ascii.stl": stl(False),
        "cube_binary.stl": stl(True),
    }


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    for name, data in files().items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    main()
