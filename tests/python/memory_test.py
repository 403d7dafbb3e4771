"""Memory stays the same however many scenes are made and dropped. memory_test.py [SCENES]"""
import sys
import unittest

import mallow
from support import SCENE

SCENES = 2000


def resident():
    """[bytes]"""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def make_and_drop():
    scene = mallow.parse_scene(SCENE)
    simulation = mallow.build(scene, threads=1)
    simulation.set_force(lambda particles, accelerations: accelerations.fill(simulation.time))
    simulation.step()
    views = simulation.positions, simulation.ids
    surfacer = mallow.Surfacer(scene.surface, 1)
    meshes = [surfacer.draw(simulation).vertices for _ in range(2)]
    simulation.remove_particles(simulation.ids[:3])
    try:
        simulation.remove_particles([0, 0])
    except mallow.ConfigError:
        pass
    return mallow.Simulation.restore(simulation.save(), 1), views, meshes


class Memory(unittest.TestCase):
    @unittest.skipUnless(sys.platform == "linux", "reads /proc")
    def test_is_flat(self):
        for _ in range(SCENES // 4):
            make_and_drop()
        before = resident()
        for _ in range(SCENES):
            make_and_drop()
        grown = resident() - before
        print(f"{SCENES} scenes: {grown / SCENES:.1f} bytes a scene, {resident() / 2**20:.0f} MiB in all")
        self.assertLess(grown, 4 * 2**20)


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].isdigit():
        SCENES = int(sys.argv.pop(1))
    unittest.main()
