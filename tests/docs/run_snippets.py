"""Runs the lines of shells and the sweeps that stand in the pages: run_snippets.py SOURCE_FOLDER MALLOW_PROGRAM

The blocks of a page are run in a folder of its own, as they stand; what is a placeholder there (SCENE, DIR, A...) is one here. Runs
take two frames, and sweeps three points.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE, PROGRAM = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PAGES = [SOURCE / "README.md", *sorted((SOURCE / "tools/docs").glob("*.md"))]
SCENE = """
[solver]
gravity = [0, 0, -9.81]
[[material]]
name = "dough"
alpha = 0.3
plastic_yield = 0.1
rest_density = 1000
[[body]]
material = "dough"
box = { count = [4, 4, 4], spacing = 0.01, corner = [0, 0, 0.02] }
skin = "box.obj"
[[collider]]
plane = {}
[run]
frames = 2
frame_time = 0.02
[render]
width = 64
height = 48
"""
BOX = """v 0 0 0.02\nv 0.04 0 0.02\nv 0.04 0.04 0.02\nv 0 0.04 0.02\nv 0 0 0.06\nv 0.04 0 0.06\nv 0.04 0.04 0.06\nv 0 0.04 0.06
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""
BUNNY = SOURCE / "data/meshes/bunny00.off"  # which tools/fetch_meshes fetches
# Programs that may not be there, and windows.
NEEDS = {"--on slurm": None, "--on parallel": "parallel", "mallow view": None, "--film": "ffmpeg", "MESH": "true" if BUNNY.exists() else None}
# How a line may end that is right.
FINE = ("nothing is left to run", " differ")
problems = []


def run(command, folder):
    environment = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
    return subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True)


def scratch(folder):
    """The program, with few frames, and what placeholders stand for."""
    (folder / "bin").mkdir()
    program = folder / "bin/mallow"
    program.write_text(f'''#!/bin/bash
[[ "$1" == run && "$*" != *--resume* && "$*" != *--frames* ]] && exec {PROGRAM} "$@" --frames 2 --threads 1
exec {PROGRAM} "$@"
''')
    program.chmod(0o755)
    (folder / "scene.toml").write_text(SCENE)
    (folder / "box.obj").write_text(BOX)
    for name in ("run", "a", "b"):
        run(f"{PROGRAM} run scene.toml --out {name} --threads 1 --checkpoint-every 1 --no-film --no-images", folder)


def filled_in(command, new_folder):
    """A line with names in place of its placeholders."""
    for name, value in {"SCENE": "scene.toml", "SPEC": "sweep.toml", "MESH": str(BUNNY), "FILE.csv": "series.csv",
                        "FILE": "film.mp4", "A B": "a b"}.items():
        command = re.sub(rf"(?<![\w.]){re.escape(name)}(?![\w.])", value, command)
    makes = re.search(r"mallow (run (?!--resume)|tradeoff|sweep)", command)
    return re.sub(r"\bDIR\b", new_folder if makes else "run", command)


def run_page(page, blocks, sweep, folder):
    scratch(folder)
    (folder / "sweep.toml").write_text(sweep.replace("drop.toml", "scene.toml"))
    before = re.findall(r"into `(\w+\.toml)`:\n\n```toml\n(.*?)^```", page.read_text(), re.M | re.S)
    for name, text in before:
        (folder / name).write_text(text)
    count = 0
    for number, line in enumerate("".join(blocks).splitlines()):
        command = re.sub(r"\s+#.*$", "", line)
        needed = [program for text, program in NEEDS.items() if text in command]
        if not command.startswith("mallow ") or any(p is None or not shutil.which(p) for p in needed):
            continue
        begin = time.monotonic()
        done = run(filled_in(command, f"new{number}"), folder)
        print(f"{time.monotonic() - begin:6.1f} s  {command}")
        count += 1
        if done.returncode != 0 and not any(text in done.stderr for text in FINE):
            problems.append(f"{page.relative_to(SOURCE)}: '{command}' says {done.stderr or done.stdout}")
    return count


def sweeps(page):
    return [re.sub(r"^(points|frames) = \d+", lambda f: f"{f[1]} = {3 if f[1] == 'points' else 2}", text, flags=re.M)
            for text in re.findall(r"^```toml\n(scene = .*?)^```", page.read_text(), re.M | re.S)]


def main():
    count, sweep = 0, [text for page in PAGES for text in sweeps(page)][0]
    for page in PAGES:
        blocks = re.findall(r"^```sh\n(.*?)^```", page.read_text(), re.M | re.S)
        if blocks:
            with tempfile.TemporaryDirectory() as folder:
                count += run_page(page, blocks, sweep, pathlib.Path(folder))
    print("\n".join(problems))
    if count < 20:
        print(f"only {count} lines were found")
    return 1 if problems or count < 20 else 0


sys.exit(main())
