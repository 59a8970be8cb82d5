"""Writes files that are broken or mean harm, each a small change of one that tests/data/make.py writes. Each must be refused with one line.

    malformed.py FOLDER
"""
import json
import pathlib
import struct
import sys
import zlib

import make


def changed(document, change):
    parsed = json.loads(document)
    change(parsed)
    return json.dumps(parsed).encode()


def put(path, value):
    """A change that sets the member at a path of keys and indices."""
    def change(document):
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = value
    return change


def files():
    cube, whole, png, tif = make.plain_cube(), make.glb(make.plain_cube()), make.files()["heights_u16.png"], make.files()["heights_u16.tif"]
    huge = struct.pack(">II", 1 << 30, 1 << 30) + png[24:29]
    deep = json.loads(cube)
    deep["nodes"] = [{"mesh": 0, "children": [1]}, {"children": [0]}]
    nan = make.gltf([make.floats([(float("nan"),) * 3, *make.CORNERS[1:]]), make.indices(1, make.FLAT)[0]],
                    [make.positions(), make.indices(1, make.FLAT)[1]], [{"attributes": {"POSITION": 0}, "indices": 1}])
    far = make.gltf([make.floats(make.CORNERS), make.indices(1, [0, 1, 2000] * 12)[0]],
                    [make.positions(), make.indices(1, [0] * 36)[1]], [{"attributes": {"POSITION": 0}, "indices": 1}])
    return {
        "empty.gltf": b"",
        "empty.glb": b"",
        "no_json.gltf": b"{",
        "cut.gltf": cube[:len(cube) // 2],
        "cut.glb": whole[:len(whole) // 2],
        "length.glb": whole[:8] + struct.pack("<I", 1 << 30) + whole[12:],
        "chunk_length.glb": whole[:12] + struct.pack("<I", 0xfffffff0) + whole[16:],
        "version.glb": whole[:4] + struct.pack("<I", 9) + whole[8:],
        "no_such_buffer.gltf": changed(cube, put(["buffers", 0, "uri"], "no_such.bin")),
        "buffer_above.gltf": changed(cube, put(["buffers", 0, "uri"], "../../../../../../etc/passwd")),
        "buffer_elsewhere.gltf": changed(cube, put(["buffers", 0, "uri"], "https://example.com/a.bin")),
        "short_buffer.gltf": changed(cube, put(["buffers", 0, "byteLength"], 1 << 20)),
        "no_such_view.gltf": changed(cube, put(["accessors", 0, "bufferView"], 7)),
        "view_beyond.gltf": changed(cube, put(["bufferViews", 0, "byteLength"], 1 << 20)),
        "count.gltf": changed(cube, put(["accessors", 0, "count"], 4000000000)),
        "type.gltf": changed(cube, put(["accessors", 0, "type"], "MAT5")),
        "no_such_mesh.gltf": changed(cube, put(["nodes", 0, "mesh"], 3)),
        "own_ancestor.gltf": json.dumps(deep).encode(),
        "infinite_node.gltf": changed(cube, put(["nodes", 0, "scale"], [1e38, 1e38, 1e38])),
        "not_a_number.gltf": nan,
        "index_beyond.gltf": far,
        "points.gltf": changed(cube, put(["meshes", 0, "primitives", 0, "mode"], 0)),
        "draco.gltf": changed(cube, put(["extensionsRequired"], ["KHR_draco_mesh_compression"])),
        "empty.obj": b"",
        "index_beyond.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
        "no_faces.obj": b"v 0 0 0\nv 1 0 0\n",
        "cut.ply": make.ply(True)[:200],
        "claims_more.stl": make.stl(True)[:80] + struct.pack("<I", 1 << 30) + make.stl(True)[84:],
        "empty.png": b"",
        "cut.png": png[:60],
        "checksum.png": png[:20] + bytes([png[20] ^ 1]) + png[21:],
        "huge.png": png[:16] + huge + struct.pack(">I", zlib.crc32(b"IHDR" + huge)) + png[33:],
        "cut.tif": tif[:30],
        "directory_beyond.tif": tif[:4] + struct.pack("<I", 1 << 30) + tif[8:],
        "cut.exr": make.files()["heights_f32.exr"][:100],
        "text.png": b"these are no texels",
    }


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files().items():
        (folder / name).write_bytes(data)


if __name__ == "__main__":
    main()
