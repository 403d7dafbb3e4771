"""Opens the folder of a mallow run in Blender from the command line:

    blender -b -P tools/blender/open_run.py -- FOLDER [--render FRAME] [--to FILE.png] [--samples N] [--save FILE.blend]

With a .blend before -P the run is opened in that file, else in an empty one."""
import argparse
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import mallow_import  # noqa: E402
from mallow_import.sequence import opened_run  # noqa: E402


def ours(collection, name, make):
    """The object of this name and mark, made where there is none."""
    found = next((o for o in bpy.data.objects if o.get("mallow_studio") == name), None)
    if found is None:
        found = bpy.data.objects.new(name, make())
        found["mallow_studio"] = name
        collection.objects.link(found)
    return found


def set_studio(run, objects):
    """A camera where the scene of the run has it, or one that sees all, a sun and some sky."""
    scene = bpy.context.scene
    camera = ours(scene.collection, "mallow camera", lambda: bpy.data.cameras.new("mallow camera"))
    corners = np.array([list(o.matrix_world @ Vector(c)) for o in objects if o.data.vertices for c in o.bound_box])
    low, high = (corners.min(0), corners.max(0)) if corners.size else (np.zeros(3), np.ones(3))
    size = float(np.linalg.norm(high - low)) or 1.0
    target = Vector(run.render("target", list((low + high) / 2), 3))
    angle = math.radians(min(max(run.render("field_of_view", 35), 1), 170))
    eye = Vector(run.render("eye", list(target + 0.6 * size / math.tan(angle / 2) * Vector((0.7, -0.6, 0.4))), 3))
    camera.location = eye
    camera.rotation_euler = (target - eye).to_track_quat("-Z", "Y").to_euler()
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = angle
    camera.data.clip_start, camera.data.clip_end = 1e-3 * size, 1e3 * size
    scene.camera = camera
    sun = ours(scene.collection, "mallow sun", lambda: bpy.data.lights.new("mallow sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.0, 0.2
    sun.rotation_euler = (0.7, 0.2, 0.9)
    if scene.world is None:
        scene.world = bpy.data.worlds.new("mallow sky")
        scene.world.use_nodes = True
        sky = scene.world.node_tree.nodes["Background"]
        sky.inputs["Color"].default_value, sky.inputs["Strength"].default_value = (0.7, 0.8, 0.9, 1), 0.5


def render(run, objects, frame, file, samples):
    scene = bpy.context.scene
    scene.frame_set(frame)
    set_studio(run, objects)
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False  # Debian's Blender has no denoiser
    scene.render.resolution_x, scene.render.resolution_y = run.render("width", 960), run.render("height", 540)
    scene.render.filepath = os.path.abspath(file)
    bpy.ops.render.render(write_still=True)


def main(arguments):
    parser = argparse.ArgumentParser(prog="open_run.py", description="Opens the folder of a mallow run in Blender")
    parser.add_argument("folder", metavar="FOLDER", help="what `mallow run --out` wrote")
    parser.add_argument("--render", type=int, metavar="FRAME", help="take a picture of this frame")
    parser.add_argument("--to", metavar="FILE", help="where it goes; frame_000012.png beside where Blender was started")
    parser.add_argument("--samples", type=int, default=64, help="of light for each pixel; 64")
    parser.add_argument("--save", metavar="FILE", help="write a .blend")
    options = parser.parse_args(arguments)
    if not bpy.data.filepath:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    mallow_import.register()
    objects = mallow_import.import_run(options.folder)
    run = opened_run(os.path.realpath(options.folder))
    if options.render is not None:
        file = options.to or f"frame_{options.render:06d}.png"
        render(run, objects, options.render, file, options.samples)
    if options.save:
        set_studio(run, objects)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options.save))


if __name__ == "__main__":
    try:
        main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    except (mallow_import.ImportFailure, OSError) as failure:
        print(f"open_run.py: {failure}", file=sys.stderr)
        sys.exit(2)
