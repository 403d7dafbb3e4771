"""A whirl of air turns a falling cube about the z axis: a force of one's own, called once a step."""
import numpy

import mallow

DRAG = 0.2  # [1/s]
TURN = 0.5  # [rad/s]


def blow(particles, accelerations):
    """Drags particles along with air that turns about the z axis."""
    x, v = particles.positions, particles.velocities
    accelerations[:, 0] += DRAG * (-TURN * x[:, 1] - v[:, 0])
    accelerations[:, 1] += DRAG * (TURN * x[:, 0] - v[:, 1])


simulation = mallow.Simulation(mallow.SolverConfig(support_radius=2))
simulation.add_collider(mallow.Collider())
simulation.add_body(mallow.sample(mallow.Lattice(count=[6, 6, 6], corner=[-3, -3, 2])), mallow.Material(alpha=0.3))
simulation.set_force(blow)
simulation.advance(20)

x, v = simulation.positions, simulation.velocities
spin = numpy.sum(x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) / numpy.sum(x[:, :2] ** 2)
print(f"the cube turns by {spin:.2f} rad/s, the air by {TURN} rad/s")
assert 0.5 * TURN < spin < 1.2 * TURN


def fail(particles, accelerations):
    raise ValueError("the wind has died down")


simulation.set_force(fail)
before = simulation.state_hash()
try:
    simulation.step()
except ValueError as error:
    print("what a force raises ends the step:", error)
assert simulation.state_hash() == before, "and nothing has moved"
