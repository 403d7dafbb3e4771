"""A bunny of chocolate, or a head where the bunny's mesh is not there, stands on a hot plate and melts from below.
heat_bunny.py [PNG] [MESH]"""
import sys
from pathlib import Path

import mallow

picture = sys.argv[1] if len(sys.argv) > 1 else "bunny.png"
mesh = Path(sys.argv[2]) if len(sys.argv) > 2 else Path("data/meshes/bunny.ply")
shape = mallow.mesh_shape(mallow.read_mesh(mesh)) if mesh.exists() else mallow.moai_shape()
rotate = [90, 0, 0] if mesh.exists() else [0, 0, 0]
body = mallow.sample(mallow.place(shape, mallow.Placement(rotate=rotate, size=0.1, center=[0, 0, 0.055])),
                     mallow.Sampling(count=3000))

chocolate = mallow.find_preset("chocolate")
material = chocolate.material
print("chocolate:", material)
material.temperature = 290
material.conductivity = 20  # a hundred times as fast as chocolate, so that a second shows it
simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
simulation.add_collider(mallow.Collider(friction=0.5, temperature=360))
bunny = simulation.add_body(body, material, "bunny")
top = simulation.positions[:, 2].max()
simulation.advance(2)
height, kelvins = simulation.positions[:, 2], simulation.temperatures
low, high = kelvins[height < 0.02].mean(), kelvins[height > 0.06].mean()
print(f"{simulation.heat(bunny):.0f} J; near the plate {low:.0f} K, far from it {high:.0f} K")
assert low > high + 5 and high < 320, "it is hot where it touches the plate"

if hasattr(mallow, "Renderer"):
    surface = mallow.Surfacer().draw(simulation)
    camera = mallow.frame_camera(mallow.bounds(surface))
    renderer = mallow.Renderer(mallow.RenderConfig(width=480, height=360))
    mallow.write_png(picture, renderer.render(surface, [chocolate.appearance], [], camera))
