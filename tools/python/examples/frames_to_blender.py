"""A film for Blender: one glTF file that plays the surfaces of a scene's bodies. frames_to_blender.py [GLB] [SCENE]"""
import sys
from pathlib import Path

import mallow

SCENE = """
[solver]
gravity = [0, 0, -9.81]
[[body]]
material = "jelly"
box = { count = [8, 8, 8], spacing = 0.02, corner = [-0.08, -0.08, 0.3] }
[[body]]
material = "dough"
sphere = { center = [0, 0, 0.1], radius = 0.1, spacing = 0.02 }
[[collider]]
plane = {}
[run]
frames = 24
frame_time = 0.0333333
"""
file = sys.argv[1] if len(sys.argv) > 1 else "film.glb"
scene = mallow.read_scene(sys.argv[2]) if len(sys.argv) > 2 else mallow.parse_scene(SCENE)
simulation = mallow.build(scene)
surfacer = mallow.Surfacer(scene.surface)
bodies = [mallow.MeshBody(appearance, simulation.name(body), scene.materials[material].name)
          for body, material, appearance in zip(simulation.bodies(), mallow.body_materials(scene),
                                                mallow.body_appearances(scene))]
series = mallow.GlbSeries(bodies)
step = mallow.frame_time(scene, simulation.info())
for frame in range(scene.run.frames):
    series.add(surfacer.draw(simulation), simulation.time)
    simulation.advance(step)
print(series.frames(), "frames of", [body.name for body in bodies])
series.write(file)
assert Path(file).read_bytes()[:4] == b"glTF"
