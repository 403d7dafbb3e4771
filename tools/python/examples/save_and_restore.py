"""Saves a state to a file, reads it back, and goes on with the same bits. save_and_restore.py [FILE]"""
import sys

import mallow

file = sys.argv[1] if len(sys.argv) > 1 else "state.checkpoint"
simulation = mallow.Simulation(mallow.SolverConfig(gravity=[0, 0, -9.81]))
simulation.add_collider(mallow.Collider())
simulation.add_body(mallow.sample(mallow.Lattice(count=[6, 6, 6], spacing=0.02, corner=[0, 0, 0.05])),
                    mallow.materials.dough(), "cube")
simulation.advance(0.1)

state = simulation.save()
state.chunks = [*state.chunks, mallow.Chunk("game.score", b"7")]
mallow.write_checkpoint(file, state)
simulation.advance(0.2)

saved = mallow.read_checkpoint(file)
again = mallow.Simulation.restore(saved)
again.advance(0.2)
print("score", saved.find("game.score"), "- the same bits:", again.state_hash() == simulation.state_hash())
assert again.state_hash() == simulation.state_hash() and saved.find("game.score") == b"7"
