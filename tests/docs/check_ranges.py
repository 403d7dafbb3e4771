"""Holds the ranges that public headers say of settings, in prose, to those that are checked.

check_ranges.py SOURCE_FOLDER MALLOW_PROGRAM
"""
import pathlib
import re
import subprocess
import sys

SOURCE, PROGRAM = pathlib.Path(sys.argv[1]), sys.argv[2]
sys.path.insert(0, str(SOURCE / "tools/python"))
from read_docs import Reader  # noqa: E402

# Where the settings of a config stand in scene files.
SECTIONS = {
    "SolverConfig": "solver", "Material": "material[]", "SurfaceConfig": "surface", "RunConfig": "run",
    "RenderConfig": "render", "Emitter": "emitter[]", "Collider": "collider[]", "SceneMaterial": "material[]",
    "Lattice": "body[].box", "Sampling": "body[].sphere", "Placement": "body[].mesh", "SphereSource": "body[].sphere",
    "PointsSource": "body[].points", "Sphere": "collider[].sphere", "Capsule": "collider[].capsule",
    "Cylinder": "collider[].cylinder", "Cone": "collider[].cone", "MeshColliderSource": "collider[].mesh",
    "ScenePaint": "body[].paint[]",
}
RANGE = r"in \[(-?[\d.]+), (-?[\d.]+)\]|(>=?) (-?[\d.]+)"


def ranges(text):
    """Every range that a text names; what whole numbers end at is no bound that anybody meant."""
    found = []
    for low, high, sign, bound in re.findall(RANGE, text):
        if sign:
            found.append(f"{sign} {float(bound):g}")
        elif high == "2147483647":
            found.append(f">= {float(low):g}")
        else:
            found.append(f"in [{float(low):.9g}, {float(high):.9g}]")
    return found


def allowed():
    """Per key of scene files, the range that is checked, or None."""
    keys = {}
    for line in subprocess.run([PROGRAM, "keys"], capture_output=True, text=True, check=True).stdout.splitlines():
        if line and not line.startswith("#"):
            said = ranges(line.rpartition("; ")[2])
            keys[line.split()[0]] = said[0] if said else None
    return keys


keys, reader, problems, compared = allowed(), Reader(), [], 0
for header in sorted((SOURCE / "engine/include/mallow").glob("*.h")):
    reader.read(header)
for name, doc in reader.docs.items():
    config, _, member = name.rpartition(".")
    key = f"{SECTIONS.get(config)}.{member}"
    if key not in keys or (keys[key] is None and not ranges(doc["text"])):
        continue
    compared += 1
    said = ranges(doc["text"])
    if keys[key] not in said:
        problems.append(f"{name} says {said}, {key} is {keys[key]}")
if compared < 60:
    problems.append(f"only {compared} settings were found in the headers and in `mallow keys`")
print("\n".join(problems) or f"{compared} ranges are said as they are checked")
sys.exit(1 if problems else 0)
