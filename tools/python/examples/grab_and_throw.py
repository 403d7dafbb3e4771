"""Takes a cube of jelly by its top, lifts it, swings it and lets go."""
import mallow

simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
simulation.add_collider(mallow.Collider(friction=0.5))
cube = mallow.sample(mallow.Lattice(count=[8, 8, 8], spacing=0.02, corner=[-0.08, -0.08, 0.01]))
body = simulation.add_body(cube, mallow.materials.jelly(), "cube")
simulation.advance(0.2)

hit = simulation.raycast(origin=[0, 0, 1], direction=[0, 0, -1])
assert hit.body == body
held = simulation.pin(simulation.particles_in(hit.position, 0.04))
simulation.move_pin(held, [0, 0, 0.3], seconds=0.5)
simulation.advance(0.5)
lifted = simulation.motion(body)
print(f"lifted to {lifted.center_of_mass[2]:.2f} m")
simulation.set_velocity(held, [2, 0, 1])
simulation.advance(0.15)
simulation.unpin(held)
thrown = simulation.motion(body)
print("let go with", thrown.velocity.round(2), "m/s")
simulation.report_contacts(body)
while not any(event.kind == mallow.BodyEvent.Kind.touched for event in simulation.events()):
    simulation.step()
landed = simulation.motion(body).center_of_mass
print(f"lands {landed[0]:.2f} m away after {simulation.time:.2f} s")
assert lifted.center_of_mass[2] > 0.25 and thrown.velocity[0] > 1 and landed[0] > 0.5
