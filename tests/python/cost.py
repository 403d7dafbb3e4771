"""How much longer 100 steps take from Python than from C++: cost.py PROGRAM [ROUNDS], PROGRAM being python_cost.

Both time the same scene, 3,375 particles of Fig. 3 on one thread, in turns; the least of each counts.
"""
import subprocess
import sys
import time

import mallow


def seconds():
    simulation = mallow.Simulation(mallow.SolverConfig(time_step=0.15, support_radius=2.9, threads=1))
    simulation.add_collider(mallow.Collider(friction=0.3))
    cube = mallow.Lattice(count=[15, 15, 15], spacing=22 / 15, corner=[-11, -11, 10], jitter=0)
    simulation.add_body(mallow.sample(cube), mallow.Material(alpha=0.3))
    simulation.step()
    begin = time.perf_counter()
    for _ in range(100):
        simulation.step()
        simulation.positions
    return time.perf_counter() - begin, simulation.state_hash()


rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
python, cpp, hashes = [], [], set()
for _ in range(rounds):
    least, state = seconds()
    python.append(least)
    hashes.add(state)
    words = subprocess.run(sys.argv[1], capture_output=True, text=True, check=True).stdout.split()
    cpp.append(float(words[0]))
    hashes.add(int(words[1]))
print(f"100 steps: {1e3 * min(python):.2f} ms from Python, {1e3 * min(cpp):.2f} ms from C++, "
      f"ratio {min(python) / min(cpp):.4f}")
assert len(hashes) == 1, "the same scene has the same bits"
assert min(python) / min(cpp) < 1.5, "a call of Python costs microseconds"
