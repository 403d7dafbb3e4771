"""Fast animation of viscoelastic materials: mallow's library of C++ under the same names.

    import mallow
    simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
    simulation.add_collider(mallow.Collider())
    body = mallow.sample(mallow.Lattice(count=[15, 15, 15], spacing=0.02, corner=[0, 0, 0.2]))
    simulation.add_body(body, mallow.materials.jelly(), "cube")
    simulation.advance(0.5)
    print(simulation.positions.mean(axis=0))

Numbers, units, ranges and errors are those of the headers mallow/*.h, which the doc strings are made of. Arrays of a
simulation (positions, velocities, ids and the like) are views without a copy and cannot be written; they always read
memory that is there, and show what the rows hold now: copy what you mean to keep past the next step. Meshes that were
drawn stay as they were drawn. One thread may use an object at a time: another one gets BusyError.
"""
from . import _mallow
from ._mallow import *  # noqa: F401, F403
from ._mallow import __version__, materials  # noqa: F401


def _adopt():
    """Everything is mallow's, whatever file it is made in."""
    for name, value in vars(_mallow).items():
        if not name.startswith("_") and isinstance(value, type):
            value.__module__ = "mallow"


_adopt()

if hasattr(_mallow, "Renderer"):
    from ._pictures import render  # noqa: F401

__all__ = sorted(name for name in globals() if not name.startswith("_"))
