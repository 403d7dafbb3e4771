"""What stands as Python in the pages runs as it stands, in a folder of its own."""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PAGES = [SOURCE / "README.md", *sorted((SOURCE / "tools").rglob("*.md"))]


class Snippets(unittest.TestCase):
    def test_run(self):
        count = 0
        for page in PAGES:
            for snippet in re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S):
                count += 1
                with self.subTest(page=str(page.relative_to(SOURCE))), tempfile.TemporaryDirectory() as folder:
                    run = subprocess.run([sys.executable, "-c", snippet], cwd=folder, env=os.environ,
                                         capture_output=True, text=True)
                    self.assertEqual(run.returncode, 0, run.stderr)
        self.assertGreaterEqual(count, 2)


if __name__ == "__main__":
    unittest.main()
