"""Drops the same cube with alpha from 0 to 1, and plots how far each has spread and how high it stands.
sweep_alpha.py [PNG]"""
import sys

import matplotlib
import numpy

import mallow

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


def drop(alpha):
    """Width and height at the end [spacings]."""
    simulation = mallow.Simulation(mallow.SolverConfig(time_step=0.15))
    simulation.add_collider(mallow.Collider(friction=0.3))
    cube = mallow.sample(mallow.Lattice(count=[10, 10, 10], spacing=1, corner=[-5, -5, 5]))
    simulation.add_body(cube, mallow.Material(alpha=alpha, update_threshold=3, viscosity=0.5))
    simulation.advance(40)
    low, high = numpy.quantile(simulation.positions, [0.02, 0.98], axis=0)
    return max(high[:2] - low[:2]), high[2]


alphas = numpy.linspace(0, 1, 6)
widths, heights = zip(*(drop(alpha) for alpha in alphas))
figure, axes = pyplot.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(alphas, widths, "o-", label="width")
axes.plot(alphas, heights, "s-", label="height")
axes.set(xlabel="alpha: elastic solid (0) to fluid (1)", ylabel="after 40 s [spacings]", ylim=(0, None))
axes.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "alpha.png", dpi=120)
assert widths[-1] > 1.3 * widths[0] and heights[-1] < heights[0], "a fluid spreads, a solid stands"
