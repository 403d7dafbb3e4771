"""Whether the folders of the engine and the tools include what edges.txt allows, and nothing else.

usage: check_includes.py PROJECT
"""

import pathlib
import re
import sys

project = pathlib.Path(sys.argv[1])
# Examples are applications: they take installed headers alone.
folders = {f.name: f for base in ("engine", "tools") for f in (project / base).iterdir()
           if f.is_dir() and f.name != "examples" and any(f.rglob("*.h"))}
faults = []

allowed = {}
for line in (project / "tests/includes/edges.txt").read_text().splitlines():
    if line.startswith("#"):
        continue
    folder, named = line.split(":")
    allowed[folder] = set(named.split())
    for name in sorted(allowed[folder] - set(allowed)):
        faults.append(f"edges.txt: {folder} takes {name}, which is not on a line above")
for folder in sorted(set(folders) ^ set(allowed)):
    faults.append(f"edges.txt and the folders differ in {folder}")

found = {folder: set() for folder in folders}
for folder, path in folders.items():
    for source in sorted([*path.rglob("*.h"), *path.rglob("*.cpp")]):
        for header in re.findall(r'^#include ["<]([^">]+)[">]', source.read_text(), re.M):
            top = header.split("/")[0]
            other = "include" if top == "mallow" else top
            if "/" not in header or other == folder or other not in folders:
                continue
            found[folder].add(other)
            if other not in allowed.get(folder, ()):
                faults.append(f"{source.relative_to(project)} includes {header}: {folder} does not take {other}")
for folder, named in allowed.items():
    for name in sorted(named - found.get(folder, set())):
        faults.append(f"edges.txt: {folder} takes {name}, which it does not include")

for fault in faults:
    print(fault)
print(f"{sum(len(names) for names in found.values())} edges between {len(folders)} folders")
sys.exit(1 if faults else 0)
