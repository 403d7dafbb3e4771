"""Whatever the headers declare is in the module, under the same name, with what they say of it."""
import ast
import json
import os
import unittest
from pathlib import Path

import mallow

# What arrays, ids and exceptions of Python stand for, and what only C++ needs.
LEFT_OUT = {
    "VectorColumns", "RotationView", "StridedVectors", "LoopTask", "ShapeSource", "ObjOptions", "SceneReadOptions",
    "visit_parts",
    "level_set",  # an OpenVDB grid; level_set_vdb() is there
    "ConvexHull.data", "Executor.run", "ConfigError.__init__", "IoError.__init__", "StepError.__init__",
    "ConvexHull.__init__", "render.Image", "HullData", "Simulation.State", "StateAccess"}


class Names(unittest.TestCase):
    def setUp(self):
        self.docs = json.loads(Path(os.environ["MALLOW_PYTHON_DOCS"]).read_text())

    def names(self):
        for name, entry in self.docs.items():
            plain = name.split("#")[0]
            parts = plain.split(".")
            if plain in LEFT_OUT or parts[0] in LEFT_OUT or ".".join(parts[:2]) in LEFT_OUT:
                continue
            yield (parts[1:] if parts[0] == "render" else parts), entry

    def test_every_public_declaration_is_there(self):
        missing = []
        for parts, _ in self.names():
            found = mallow
            if parts[0] in ("Image", "Camera", "Renderer", "frame_camera", "write_png", "render") and not hasattr(
                    mallow, "Renderer"):
                continue
            for part in parts:
                found = getattr(found, part, None)
                if found is None and part == parts[-1] and parts[0] in ("StepError", "IoError"):
                    found = part  # of the instance
            if found is None:
                missing.append(".".join(parts))
        self.assertEqual(missing, [])

    def test_doc_strings_are_those_of_the_headers(self):
        self.assertIn("One step of algorithm 3.3", mallow.Simulation.step.__doc__)
        self.assertIn("upper bound of a step", mallow.SolverConfig.time_step.__doc__)
        self.assertIn("[s]", mallow.SolverConfig.time_step.__doc__)
        self.assertIn("-> Quaternion", mallow.Simulation.rotation.__doc__)
        self.assertIn("a number in [0, 1]", mallow.Material.alpha.__doc__)
        self.assertIn("Default: 0.5", mallow.Material.friction.__doc__)
        bare = [f"{name}.{key}" for name, value in vars(mallow).items() if isinstance(value, type)
                for key, member in vars(value).items()
                if not key.startswith("_") and isinstance(member, property) and member.__doc__ is None]
        self.assertEqual(bare, [])

    def test_stubs_name_everything_and_are_python(self):
        text = Path(mallow.__file__).with_suffix(".pyi").read_text()
        compile(text, "__init__.pyi", "exec")
        for name in mallow.__all__:
            if name != "materials":
                self.assertRegex(text, rf"(?m)^(class|def) {name}\b")
        self.assertNotRegex(text, r"def __init__\(\*args")
        self.assertNotRegex(text, r"\barg0\b")

    def test_stubs_name_the_fields_that_constructors_take(self):
        tree = ast.parse(Path(mallow.__file__).with_suffix(".pyi").read_text())
        seen = 0
        for kind in (node for node in tree.body if isinstance(node, ast.ClassDef)):
            fields = getattr(getattr(mallow, kind.name), "_fields", None)
            if fields is None:
                continue
            made = next(node for node in kind.body if isinstance(node, ast.FunctionDef) and node.name == "__init__")
            named = [argument.arg for argument in made.args.args[1:] + made.args.kwonlyargs]
            self.assertEqual(named, list(fields), kind.name)
            seen += 1
        self.assertGreater(seen, 50)


if __name__ == "__main__":
    unittest.main()
