"""A bunny of chocolate, or a head where the bunny's mesh is not there, stands on a hot plate, melts from below, and sets
again when the plate turns cold. heat_bunny.py [PNG]"""
import sys
from pathlib import Path

import mallow

picture = sys.argv[1] if len(sys.argv) > 1 else "bunny.png"
scenes = Path(__file__).resolve().parents[3] / "data" / "scenes"
scene = mallow.read_scene(scenes / "chocolate_bunny.toml", ["solver.support_radius=0.0126"])
source = scene.bodies[0].source
sampling = source.sampling.replace(spacing=0.006)
if (scenes / source.file).exists():
    scene.bodies[0].source = source.replace(sampling=sampling)
else:
    scene.bodies[0].source = mallow.ImplicitSource("moai", sampling, source.placement.replace(rotate=[0, 0, 0]))
simulation = mallow.build(scene)
bunny, plate = simulation.bodies()[0], simulation.collider_ids()[0]
print(f"{simulation.particle_count} particles")


def tell():
    kelvins, height = simulation.temperatures, simulation.positions[:, 2]
    solidus = scene.materials[0].material.solidus
    print(f"{simulation.time:.0f} s: {simulation.heat(bunny):6.0f} J, from {kelvins.min():.0f} to {kelvins.max():.0f} K, "
          f"{100 * (kelvins > solidus).mean():.0f} % above the solidus, {1000 * height.max():.0f} mm high")
    return kelvins.copy(), height.copy()


_, first = tell()
simulation.set_temperature(plate, 370)
simulation.advance(3)
kelvins, height = tell()
assert kelvins[height < 0.01].mean() > kelvins[height > 0.04].mean() + 5, "it is hot where it touches the plate"

if hasattr(mallow, "Renderer"):
    scene.render.width, scene.render.height = 480, 300
    mallow.render(scene, simulation, file=picture)
simulation.set_temperature(plate, 270)
simulation.advance(1)
assert tell()[0].max() < kelvins.max(), "it cools"
