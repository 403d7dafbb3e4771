"""Vector types, intrinsics and builtins of compilers stand in four headers and nowhere else: core/lanes.h says which.

check_port.py SOURCE_FOLDER
"""
import pathlib
import re
import sys

SOURCE = pathlib.Path(sys.argv[1])
HEADERS = {SOURCE / "engine/core" / name for name in ("port.h", "lanes.h", "cluster_lanes.h", "wide_lanes.h")}
WORDS = re.compile(r"vector_size|\w*intrin\.h|\b_mm\d*_\w+|\b__m\d+\w*|__builtin_\w+|\barm_neon\.h")

problems, files = [], 0
for folder in ("engine", "tools", "bench"):
    for file in sorted((SOURCE / folder).rglob("*")):
        if file.suffix not in (".h", ".cpp") or file in HEADERS:
            continue
        files += 1
        for number, line in enumerate(file.read_text().splitlines(), 1):
            for word in WORDS.findall(line):
                problems.append(f"{file.relative_to(SOURCE)}:{number}: {word} belongs in engine/core/port.h")
for header in HEADERS:
    if not WORDS.search(header.read_text()) and header.name != "wide_lanes.h":
        problems.append(f"{header.relative_to(SOURCE)} has none: is it still a part of a port?")
if files < 100:
    problems.append(f"only {files} files were looked at")
print("\n".join(problems))
sys.exit(1 if problems else 0)
