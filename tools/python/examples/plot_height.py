"""Drops a cube of dough and one of jelly, and plots how high their middles are. plot_height.py [PNG]"""
import sys

import matplotlib
import numpy

import mallow

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


def drop(material):
    simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
    simulation.add_collider(mallow.Collider(friction=0.5))
    cube = mallow.sample(mallow.Lattice(count=[8, 8, 8], spacing=0.025, corner=[-0.1, -0.1, 0.3]))
    body = simulation.add_body(cube, material)
    times, heights = [], []
    while simulation.time < 1.2:
        simulation.step()
        times.append(simulation.time)
        heights.append(simulation.motion(body).center_of_mass[2])
    return numpy.array(times), numpy.array(heights)


figure, axes = pyplot.subplots(figsize=(6, 3.5), layout="constrained")
for preset in ("jelly", "dough"):
    times, heights = drop(mallow.find_preset(preset).material)
    axes.plot(times, heights, label=mallow.find_preset(preset).about)
    before = times < 0.2
    fall = heights[0] - 9.81 / 2 * times[before] ** 2
    assert abs(heights[before] - fall).max() < 0.01, "it falls freely until it lands"
axes.set(xlabel="time [s]", ylabel="height of the middle [m]", ylim=(0, None))
axes.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "height.png", dpi=120)
