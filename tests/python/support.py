"""What the tests of the Python module share."""
import mallow


def cube(count=4, height=1.0, **material):
    """A simulation of a small cube above a floor, in the paper's units."""
    simulation = mallow.Simulation()
    simulation.add_collider(mallow.Collider())
    body = mallow.sample(mallow.Lattice(count=[count] * 3, spacing=1, corner=[0, 0, height]))
    simulation.add_body(body, mallow.Material(**{"alpha": 0.5, **material}), "cube")
    return simulation


SCENE = """
[[material]]
name = "paste"
alpha = 0.3
[[body]]
material = "paste"
box = { count = [4, 4, 4], spacing = 1, corner = [0, 0, 1] }
[[collider]]
plane = {}
[run]
frames = 3
"""
