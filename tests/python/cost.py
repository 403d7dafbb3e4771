"""How much longer 100 steps take from Python than from C++: cost.py PROGRAM [ROUNDS], PROGRAM being python_cost.

What calls cost is the difference of the two in a scene of one particle, where it is most of a step; it counts as a share
of the steps of 3,375 particles of Fig. 3 on one thread. All are timed in turns; the least of each counts,
and where it is too much there are up to 30 rounds, as others take processors away.
"""
import subprocess
import sys
import time

import mallow


def seconds(side):
    simulation = mallow.Simulation(mallow.SolverConfig(time_step=0.15, support_radius=2.9, threads=1))
    simulation.add_collider(mallow.Collider(friction=0.3))
    cube = mallow.Lattice(count=[side] * 3, spacing=22 / 15, corner=[-11, -11, 10], jitter=0)
    simulation.add_body(mallow.sample(cube), mallow.Material(alpha=0.3))
    simulation.step()
    begin = time.perf_counter()
    for _ in range(100):
        simulation.step()
        simulation.positions
    return time.perf_counter() - begin, simulation.state_hash()


def seconds_of_cpp(side):
    words = subprocess.run([sys.argv[1], str(side)], capture_output=True, text=True, check=True).stdout.split()
    return float(words[0]), int(words[1])


rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
least, hashes = {}, {}
for turn in range(max(rounds, 30)):
    for side in (1, 15):
        for of in (seconds, seconds_of_cpp):
            taken, state = of(side)
            least[side, of] = min(taken, least.get((side, of), taken))
            hashes.setdefault(side, set()).add(state)
    calls = least[1, seconds] - least[1, seconds_of_cpp]
    share = calls / least[15, seconds_of_cpp]
    if turn + 1 >= rounds and share < 0.02:
        break
print(f"100 steps: {1e3 * least[15, seconds]:.2f} ms from Python, {1e3 * least[15, seconds_of_cpp]:.2f} ms from C++; "
      f"calls take {1e4 * calls:.2f} us a step, {share:.4f} of it")
assert all(len(states) == 1 for states in hashes.values()), "the same scene has the same bits"
assert share < 0.02, "a call of Python costs microseconds"
