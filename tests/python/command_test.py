"""python3 -m mallow is the command line, and the package is whole where it is."""
import subprocess
import sys
import unittest
from pathlib import Path

import mallow


def run(*arguments):
    return subprocess.run([sys.executable, "-m", "mallow", *arguments], capture_output=True, text=True)


class Command(unittest.TestCase):
    def test_is_that_of_the_program(self):
        keys = run("keys")
        self.assertEqual((keys.returncode, keys.stdout), (0, mallow.describe_scene_keys()))
        self.assertIn(mallow.version(), run("--version").stdout)

    def test_exit_codes_come_through(self):
        self.assertNotEqual(run("run", "no_such_scene.toml").returncode, 0)

    def test_the_package_is_typed(self):
        self.assertTrue((Path(mallow.__file__).parent / "py.typed").exists())


if __name__ == "__main__":
    unittest.main()
