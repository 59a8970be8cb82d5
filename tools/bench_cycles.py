"""Run by Blender, for tools/bench: bakes ambient occlusion of a mesh's vertices with Cycles, 256 samples each, and prints the processor time.

    blender -b --python bench_cycles.py -- MESH.obj
"""
import sys
import time

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
if hasattr(bpy.ops.wm, "obj_import"):
    bpy.ops.wm.obj_import(filepath=sys.argv[-1])
else:
    bpy.ops.import_scene.obj(filepath=sys.argv[-1])
mesh = next(o for o in bpy.context.scene.objects if o.type == "MESH")
bpy.context.view_layer.objects.active = mesh
mesh.select_set(True)
bpy.ops.object.shade_smooth()
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 256
scene.cycles.use_adaptive_sampling = False
scene.world = bpy.data.worlds.new("world")
scene.world.light_settings.distance = 1e6
if not mesh.data.materials:
    mesh.data.materials.append(bpy.data.materials.new("material"))
mesh.data.color_attributes.new("occlusion", "FLOAT_COLOR", "POINT")
scene.render.bake.target = "VERTEX_COLORS"
begin = time.process_time()
bpy.ops.object.bake(type="AO")
print(f"CYCLES {time.process_time() - begin}")
