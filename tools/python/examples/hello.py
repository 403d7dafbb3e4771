"""A cube of jelly falls on the floor: says how high it is."""
import mallow

simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
simulation.add_collider(mallow.Collider(shape=mallow.Plane(), friction=0.3))
cube = mallow.sample(mallow.Lattice(count=[10, 10, 10], spacing=0.02, corner=[-0.1, -0.1, 0.2]))
simulation.add_body(cube, mallow.materials.jelly(), "cube")
for _ in range(5):
    simulation.advance(0.1)
    heights = simulation.positions[:, 2]
    print(f"{simulation.time:.1f} s: from {heights.min():.3f} to {heights.max():.3f} m")
assert 0 < heights.min() and heights.max() < 0.4, "it stays above the floor and below where it began"
