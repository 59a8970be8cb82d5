"""Gives the meshes of a glTF file a second set of texture coordinates whose charts do not overlap, with Blender 3.4:

    blender -b -P tests/data/unwrap.py -- IN.glb OUT.glb TEXELS

Charts are two texels of TEXELS apart. tests/data/arcade.glb was made so, for 256 texels, of what `apertura bake builtin:arcade --at vertices`
writes."""
import math
import sys

import bpy
import numpy

numpy.bool = bool  # Blender's importer asks for the name that NumPy has given up

source, target, texels = sys.argv[sys.argv.index("--") + 1:]
margin = 2 / float(texels)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
for mesh in [o for o in bpy.context.scene.objects if o.type == "MESH"]:
    bpy.context.view_layer.objects.active = mesh
    mesh.select_set(True)
    while len(mesh.data.uv_layers) < 2:
        mesh.data.uv_layers.new()
    mesh.data.uv_layers.active_index = 1
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=math.radians(66), island_margin=margin, area_weight=1, correct_aspect=False)
    bpy.ops.uv.select_all(action="SELECT")
    bpy.ops.uv.average_islands_scale()
    bpy.ops.uv.pack_islands(margin=margin)
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh.select_set(False)
bpy.ops.export_scene.gltf(filepath=target, export_format="GLB", export_materials="NONE", export_attributes=False)
