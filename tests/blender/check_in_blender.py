# Imports runs into Blender as users do and writes what is there then as JSON. Arguments after --: the folder of
# tools/blender, the folder of a run, another run, the file for the JSON, glTF files to import.
import json
import os
import sys

import bpy
import numpy

numpy.bool = bool  # Debian's Blender reads glTF by this name, which Debian's numpy has no more

tools, folder, other, to, *gltf_files = sys.argv[sys.argv.index("--") + 1:]
sys.path.insert(0, tools)
import mallow_import  # noqa: E402

scene = bpy.context.scene


def counts():
    return {name: len(getattr(bpy.data, name)) for name in ("meshes", "objects", "materials", "collections")}


def shown():
    found = {}
    for o in bpy.data.objects:
        if o.get("mallow_folder") != os.path.realpath(folder):
            continue
        mesh = o.data
        found[o.name] = {
            "body": o["mallow_body"],
            "vertices": [x for v in mesh.vertices for x in v.co],
            "corners": [loop.vertex_index for loop in mesh.loops],
            "uv": [list(c.uv) for c in mesh.uv_layers[0].data] if mesh.uv_layers else [],
            "velocities": [x for v in mesh.attributes["velocity"].data for x in v.vector],
            "materials": [m.name for m in mesh.materials],
            "valid": not mesh.validate(),
        }
    return found


def look(material):
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    return {"color": list(shader.inputs["Base Color"].default_value)[:3], "roughness": shader.inputs["Roughness"].default_value}


found = {"frames": {}}
mallow_import.register()
scene.frame_set(0)
bpy.ops.import_scene.mallow(directory=folder)
found["range"] = [scene.frame_start, scene.frame_end, scene.render.fps]
found["first_counts"] = counts()
for frame in (0, 3, 6, 3, 100):
    scene.frame_set(frame)
    found["frames"][str(frame)] = shown()
for _ in range(3):
    for frame in range(7):
        scene.frame_set(frame)
found["counts_after_frames"] = counts()
found["looks"] = {m.name: look(m) for m in bpy.data.materials if "mallow_body" in m}
mine = next(m for m in bpy.data.materials if m.get("mallow_body") == 1)
mine.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.125
for _ in range(3):
    bpy.ops.import_scene.mallow(directory=folder + "/")
found["counts_after_imports"] = counts()
found["kept_roughness"] = look(mine)["roughness"]
found["handlers"] = len([h for h in bpy.app.handlers.frame_change_post if h.__name__ == "on_frame"])
bpy.ops.import_scene.mallow(directory=other)
found["counts_of_two_runs"] = counts()

# A file that is damaged under our feet changes nothing; a folder that is no run says why.
scene.frame_set(0)
before = shown()
file = os.path.join(folder, "surface", "frame_000001.ply")
whole = open(file, "rb").read()
open(file, "wb").write(whole[:-5])
scene.frame_set(1)
found["kept_where_damaged"] = shown() == before
open(file, "wb").write(whole)
try:
    mallow_import.import_run(tools)
except mallow_import.ImportFailure as failure:
    found["no_run"] = str(failure)

found["gltf"] = []
for file in gltf_files:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=file)
    states = {}
    for frame in range(0, 8):
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        states[str(frame)] = {}
        for o in bpy.data.objects:
            if o.type != "MESH":
                continue
            evaluated = o.evaluated_get(graph)
            size = max(evaluated.matrix_world.to_scale())
            if size > 0:
                mesh = evaluated.to_mesh()
                places = [evaluated.matrix_world @ v.co for v in mesh.vertices]
                box = [[f(p[k] for p in places) for k in range(3)] for f in (min, max)]
                states[str(frame)][o.name] = {
                    "vertices": len(places), "box": box, "materials": [m.name for m in mesh.materials]}
    found["gltf"].append({"fps": bpy.context.scene.render.fps, "shown": states})
with open(to, "w") as out:
    json.dump(found, out)
