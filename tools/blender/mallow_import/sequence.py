"""Bodies of a run as objects whose meshes are those of the frame that Blender shows."""
import functools
import json
import os
import sys

import bpy
import numpy as np
from bpy.app.handlers import persistent

from .run_files import ImportFailure, Run, bodies_of_triangles, read_ply

# Custom properties, by which what an earlier import made is found again.
FOLDER, BODY, LOOK, FRAME = "mallow_folder", "mallow_body", "mallow_look", "mallow_frame"

# Inputs of a Principled BSDF for the finishes of scenes; names as newer and as older Blenders have them.
SUBSURFACE = ("Subsurface Weight", "Subsurface")
TRANSMISSION = ("Transmission Weight", "Transmission")
ROUGHNESS, IOR = ("Roughness",), ("IOR",)
FINISHES = {
    "jelly": {ROUGHNESS: 0.2, IOR: 1.35, SUBSURFACE: 0.3},
    "clay": {ROUGHNESS: 0.9},
    "cream": {ROUGHNESS: 0.4, SUBSURFACE: 0.5},
    "gloss": {ROUGHNESS: 0.1, IOR: 1.5},
    "syrup": {ROUGHNESS: 0.05, IOR: 1.45, TRANSMISSION: 1.0},
}


@functools.lru_cache(maxsize=8)
def opened_run(folder):
    return Run(folder)


def fill(mesh, places, triangles, velocities, texture):
    """Puts a frame into a mesh in place of what it holds, whose memory Blender frees. Materials stay."""
    mesh.clear_geometry()
    n, m = len(places), len(triangles)
    mesh.vertices.add(n)
    mesh.vertices.foreach_set("co", places.ravel())
    mesh.loops.add(3 * m)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(m)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * m, 3, dtype=np.int32))
    if bpy.app.version < (3, 6, 0):  # newer ones know it from where the next begins
        mesh.polygons.foreach_set("loop_total", np.full(m, 3, np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(m, bool))
    if velocities is not None:
        # Cycles blurs motion by an attribute of this name, per second of the film.
        mesh.attributes.new("velocity", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", velocities.ravel())
    if texture is not None:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", texture.ravel())
    mesh.update(calc_edges=True)


def show(run, objects, frame):
    """Gives the objects of a run's bodies the meshes of a frame, of the last before it that is there."""
    frames = run.frames()
    if not frames:
        return
    number = max((f for f in frames if f <= frame), default=frames[0])
    if all(o.data.get(FRAME) == number for o in objects):
        return
    places, triangles, bodies, velocities = read_ply(run.surface_file(number))
    owners = run.bodies_at(number, bodies_of_triangles(triangles, bodies))
    for o in objects:
        own = triangles[owners == o[BODY]]
        used = np.zeros(len(places), bool)
        used[own] = True
        rows, corners = np.flatnonzero(used), (np.cumsum(used, dtype=np.int32) - 1)[own]
        texture = run.texture_coordinates(o[BODY])
        fill(o.data, places[rows], corners,
             None if velocities is None else velocities[rows] * np.float32(run.speed()),
             texture if texture is not None and len(texture) == 3 * len(own) else None)
        o.data[FRAME] = number


def objects_by_folder():
    found = {}
    for o in bpy.data.objects:
        if o.type == "MESH" and FOLDER in o and BODY in o:
            found.setdefault(o[FOLDER], []).append(o)
    return found


@persistent
def on_frame(scene, _depsgraph=None):
    # Motion blur asks for moments around a frame, which show the frame's mesh and its velocities.
    frame = int(round(scene.frame_current + scene.frame_subframe))
    for folder, objects in objects_by_folder().items():
        try:
            show(opened_run(folder), objects, frame)
        except (ImportFailure, OSError) as error:
            print(f"mallow: {error}", file=sys.stderr)


def material_of(run, body):
    """The body's material. One that an earlier import made stays as the user left it, unless the run's look changed."""
    color, finish = run.looks[body]
    look = json.dumps([color, finish])
    material = next((m for m in bpy.data.materials if m.get(FOLDER) == run.folder and m.get(BODY) == body), None)
    if material is None:
        material = bpy.data.materials.new(run.names[body])
        material[FOLDER], material[BODY] = run.folder, body
    if material.get(LOOK) == look:
        return material
    material[LOOK] = look
    material.diffuse_color = (*color, 1.0)
    material.use_nodes = True
    shader = next((node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if shader is None:  # the user built another material
        return material
    depth = 2 * run.spacing(body)  # how far light goes below the surface
    settings = {
        ("Base Color",): (*color, 1.0),
        ("Subsurface Color",): (*color, 1.0),
        ("Subsurface Radius",): (depth, depth, depth),
        ("Subsurface Scale",): 1.0,
        **FINISHES.get(finish, FINISHES["jelly"]),
    }
    for names, value in settings.items():
        for name in names:
            if name in shader.inputs:
                shader.inputs[name].default_value = value
                break
    return material


def import_run(folder, set_scene=True):
    """Opens a run, or opens it again: what an earlier import of it made is used again. Gives the objects."""
    opened_run.cache_clear()
    run = opened_run(os.path.realpath(folder))
    known = {o[BODY]: o for o in objects_by_folder().get(run.folder, [])}
    collection = next((c for c in bpy.data.collections if c.get(FOLDER) == run.folder), None)
    if collection is None:
        collection = bpy.data.collections.new(os.path.basename(run.folder))
        collection[FOLDER] = run.folder
        bpy.context.scene.collection.children.link(collection)
    objects = []
    for body, name in run.names.items():
        o = known.pop(body, None)
        if o is None:
            o = bpy.data.objects.new(name, bpy.data.meshes.new(name))
            o[FOLDER], o[BODY] = run.folder, body
            collection.objects.link(o)
        material = material_of(run, body)
        if not o.data.materials:
            o.data.materials.append(material)
        o.data[FRAME] = -1  # files may have changed
        objects.append(o)
    for o in known.values():  # of bodies that the run has no more
        mesh = o.data
        bpy.data.objects.remove(o)
        bpy.data.meshes.remove(mesh)
    scene = bpy.context.scene
    if set_scene:
        frames = run.frames()
        scene.frame_start, scene.frame_end = frames[0], frames[-1]
        scene.render.fps = max(1, round(run.render("frames_per_second", 30)))
        scene.render.fps_base = scene.render.fps / max(run.render("frames_per_second", 30), 1e-3)
        scene.render.use_lock_interface = True  # meshes must not be drawn while a render changes them
    show(run, objects, scene.frame_current)
    register_handler()
    return objects


def register_handler():
    unregister_handler()
    bpy.app.handlers.frame_change_post.append(on_frame)


def unregister_handler():
    # By name: a script that runs again has another function of that name.
    for handler in [h for h in bpy.app.handlers.frame_change_post if h.__name__ == on_frame.__name__]:
        bpy.app.handlers.frame_change_post.remove(handler)
