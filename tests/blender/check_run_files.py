# Damages files that the importer for Blender reads: each must be read or refused in words. Arguments: the folder of the
# importer, the folder of a run, one to write into. Exit code 77: there is no numpy.
import json
import os
import random
import shutil
import sys

try:
    import numpy as np
except ImportError:
    sys.exit(77)
importer, run, scratch = sys.argv[1:]
sys.path.insert(0, importer)
import run_files  # noqa: E402

random.seed(1)
run_files.print = lambda *words, **_: None  # thousands of lines
copy = os.path.join(scratch, "copy")
shutil.copytree(run, copy)
surface = os.path.join(copy, "surface", "frame_000000.ply")
whole = open(surface, "rb").read()
places, triangles, bodies, velocities = run_files.read_ply(surface)
assert len(places) == len(bodies) == len(velocities) and triangles.max() < len(places)
read = refused = 0


def try_it(file, content, action):
    global read, refused
    with open(file, "wb") as out:
        out.write(content)
    try:
        action()
        read += 1
    except run_files.ImportFailure as failure:
        assert str(failure), "says nothing"
        refused += 1


def read_surface():
    found = run_files.read_ply(surface)
    owners = run_files.bodies_of_triangles(found[1], found[2])
    assert len(owners) == len(found[1])


end = whole.index(b"end_header\n") + 11
for length in list(range(0, end + 40)) + [random.randrange(len(whole)) for _ in range(50)]:
    before = refused
    try_it(surface, whole[:length], read_surface)
    assert refused == before + 1, length
for _ in range(500):
    damaged = bytearray(whole)
    for _ in range(random.randint(1, 4)):
        damaged[random.randrange(end if random.random() < 0.6 else len(damaged))] = random.randrange(256)
    try_it(surface, bytes(damaged), read_surface)
for count in (b"4294967295", b"99999999999999999999", b"-1", b"1e3"):
    changed = whole.replace(str(len(places)).encode(), count, 1)
    before = refused
    try_it(surface, changed, read_surface)
    assert refused == before + 1, count
with open(surface, "wb") as out:
    out.write(whole)


def open_run():
    found = run_files.Run(copy)
    for body in found.names:
        found.texture_coordinates(body)
    found.speed(), found.render("eye", [0, 0, 0], 3), found.render("width", 960)


for name in ("report.json", "scene.toml"):
    file = os.path.join(copy, name)
    text = open(file, "rb").read()
    for trial in range(200):
        damaged = bytearray(text[: random.randrange(len(text))] if trial % 2 else text)
        for _ in range(random.randint(0, 5)):
            if damaged:
                damaged[random.randrange(len(damaged))] = random.randrange(256)
        try_it(file, bytes(damaged), open_run)
    for hostile in (b"[" * 200000, b'{"groups": [[[[[', b'{"groups": 3}', b"\xff\xfe", b"", b"[[body]]\nskin = 3\n",
                    b"[render]\neye = " + b"[" * 100000, b"[render]\nwidth = 1e999\neye = [NaN, 1, 2]\n"):
        try_it(file, hostile, open_run)
    with open(file, "wb") as out:
        out.write(text)

obj = os.path.join(scratch, "skin.obj")
good = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1 0 # a comment\nf 1/1 2/2 \\\n4/4 3/-2\nf 1 2 3/3\n"
with open(obj, "wb") as out:
    out.write(good)
corners = run_files.read_texture_coordinates(obj)
expected = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1], [0, 0], [0, 0], [0, 1]]
assert corners.tolist() == expected, corners
for bad in (b"f 1/7 2/2 3/3", b"f 1/-9 2/2 3/3", b"f 1/99999999999999999999999 2 3", b"vt x y", b"vt", b"f 1/a 2 3"):
    try:
        run_files.read_texture_coordinates(obj) if not open(obj, "wb").write(good + bad) else None
        run_files.read_texture_coordinates(obj)
        assert False, bad
    except (run_files.ImportFailure, ValueError, IndexError, OverflowError):
        pass
report = os.path.join(copy, "report.json")
text = open(report).read()
bodies = [{"name": name, "material": name, "spacing": 1.0} for name in ("now", "other")]
past = [{"slot": 0, "until": until, "name": name, "material": name, "spacing": 0.5} for until, name in ((2, "first"), (5, "second"))]
with open(report, "w") as out:
    json.dump({"groups": bodies, "past_bodies": past}, out)
found = run_files.Run(copy)
shown = {frame: [found.names[b] for b in found.bodies_at(frame, np.array([0, 1, 0]))] for frame in (0, 2, 5)}
assert shown == {0: ["first", "other", "first"], 2: ["second", "other", "second"], 5: ["now", "other", "now"]}, shown
assert found.spacing(-1) == 0.5 and set(found.looks) == set(found.names)
with open(report, "w") as out:
    out.write(text)
assert read > 100 and refused > 500, (read, refused)
print(f'{{"read": {read}, "refused": {refused}}}')
