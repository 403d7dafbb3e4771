"""Fig. 3 of Takamatsu & Kanai as one figure: the same cube with five values of alpha falls on the floor.
figure_3.py [PNG] [COUNT]: COUNT particles along a side, 15 in the paper; needs a build with pictures."""
import sys
from pathlib import Path

import matplotlib

import mallow

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

file = sys.argv[1] if len(sys.argv) > 1 else "figure_3.png"
count = int(sys.argv[2]) if len(sys.argv) > 2 else 15
scenes = Path(__file__).resolve().parents[3] / "data" / "scenes"
frames = [40, 60, 120, 240]
files = [f"fig3_alpha_{name}.toml" for name in ("00", "03", "07", "09", "10")]
figure, axes = pyplot.subplots(len(files), len(frames), figsize=(10, 8), layout="constrained")
heights = []
for row, name in zip(axes, files):
    scene = mallow.read_scene(scenes / name)
    box = scene.bodies[0].source
    scene.bodies[0].source = box.replace(count=[count] * 3, spacing=22 / count)
    scene.solver.support_radius *= 15 / count
    scene.render.width, scene.render.height, scene.render.samples = 320, 240, 2
    simulation = mallow.build(scene)
    step = mallow.frame_time(scene, simulation.info())
    camera = mallow.frame_camera(mallow.Aabb([-25, -25, 0], [25, 25, 30]), scene.render)
    for column, (frame, cell) in enumerate(zip(frames, row)):
        simulation.advance(max(0, frame * step - simulation.time))
        cell.imshow(mallow.render(scene, simulation, camera=camera))
        cell.set(xticks=[], yticks=[])
        if cell in axes[0]:
            cell.set_title(f"frame {frame}")
    heights.append(simulation.positions[:, 2].max())
    row[0].set_ylabel(f"alpha {float(scene.materials[0].material.alpha):g}")
figure.savefig(file, dpi=100)
print("heights at the end:", [round(float(height), 1) for height in heights])
assert heights[0] > heights[-1], "the solid stands higher than the fluid"
