"""Reads what `mallow run --out` writes, without Blender. Files may come from strangers: every count is checked against
the bytes that are there."""
import json
import os
import re
import sys

import numpy as np


class ImportFailure(Exception):
    """What keeps a folder from being opened, in words."""


MOST_BYTES = 0x7FFFFFFF
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "uint8": "u1", "uint": "<u4", "int": "<i4"}


def read_bytes(file):
    if not os.path.isfile(file):
        raise ImportFailure(f"{file}: there is no such file")
    if os.path.getsize(file) > MOST_BYTES:
        raise ImportFailure(f"{file}: is over 2 GiB")
    with open(file, "rb") as opened:
        return opened.read()


def read_ply(file):
    """Vertices (n, 3), triangles (m, 3), bodies (n) and velocities (n, 3) or None of a surface of mallow."""
    content = read_bytes(file)
    end = content.find(b"end_header\n", 0, 1 << 20)
    if not content.startswith(b"ply\n") or end < 0:
        raise ImportFailure(f"{file}: is not a PLY file")
    lines = content[:end].decode("latin-1").split("\n")
    if "format binary_little_endian 1.0" not in lines:
        raise ImportFailure(f"{file}: is not a binary PLY, as surfaces of mallow are")
    columns, counts, element = [], {}, ""
    for words in (line.split() for line in lines):
        if words[:1] == ["element"] and len(words) == 3 and words[2].isdecimal():
            element = words[1]
            counts[element] = int(words[2])
        elif words[:1] == ["property"] and element == "vertex":
            if len(words) != 3 or words[1] not in PLY_TYPES or words[2] in dict(columns):
                raise ImportFailure(f"{file}: has vertices that are not those of mallow: {' '.join(words)}")
            columns.append((words[2], PLY_TYPES[words[1]]))
    row, names = np.dtype(columns), dict(columns)
    face = np.dtype([("corners", "u1"), ("vertices", "<u4", (3,))])
    if list(counts) != ["vertex", "face"] or not {"x", "y", "z"} <= set(names):
        raise ImportFailure(f"{file}: is not a mesh of mallow")
    n, m = counts["vertex"], counts["face"]
    begin = end + len(b"end_header\n")
    if len(content) - begin != n * row.itemsize + m * face.itemsize:
        raise ImportFailure(f"{file}: is cut off, or has other faces than triangles")
    vertices = np.frombuffer(content, row, n, begin)
    faces = np.frombuffer(content, face, m, begin + n * row.itemsize)
    triangles = faces["vertices"].astype(np.int64)
    if m and (faces["corners"] != 3).any():
        raise ImportFailure(f"{file}: has other faces than triangles")
    if m and triangles.max() >= n:
        raise ImportFailure(f"{file}: a triangle has a vertex that is not there")

    def vectors(x, y, z):
        return np.stack([vertices[x], vertices[y], vertices[z]], axis=1).astype(np.float32)

    places = vectors("x", "y", "z")
    if not np.isfinite(places).all():
        raise ImportFailure(f"{file}: a vertex is not finite")
    bodies = vertices["material_id"].astype(np.int64) if "material_id" in names else np.zeros(n, np.int64)
    moving = {"vx", "vy", "vz"} <= set(names)
    return places, triangles, bodies, np.nan_to_num(vectors("vx", "vy", "vz")) if moving else None


def bodies_of_triangles(triangles, bodies):
    """The body of most corners, the smallest of three that differ, as in the other formats of mallow."""
    a, b, c = (bodies[triangles[:, k]] for k in range(3))
    return np.where((a == b) | (a == c), a, np.where(b == c, b, np.minimum(np.minimum(a, b), c)))


def read_scene(file):
    """Sections of a scene.toml as lists of tables, of which those values are kept that are numbers, texts, lists or
    truths on one line: mallow writes the others, which nothing here asks for, on one line too."""
    sections, table = {}, {}
    decoder = json.JSONDecoder()
    for line in read_bytes(file).decode("utf-8", "replace").splitlines():
        head = re.match(r"\s*\[+([A-Za-z_.]+)\]+", line)
        if head:
            table = {}
            sections.setdefault(head[1], []).append(table)
            continue
        pair = re.match(r"\s*([A-Za-z_]+)\s*=\s*(.*)", line)
        if not pair:
            continue
        try:
            table[pair[1]] = decoder.raw_decode(pair[2])[0]
        except (ValueError, RecursionError):
            pass
    return sections


def read_texture_coordinates(file):
    """(u, v) of each corner of each triangle of an OBJ, polygons split as mallow splits them; None without any."""
    places, corners = [], []
    for line in read_bytes(file).decode("utf-8", "replace").replace("\\\n", " ").split("\n"):
        words = line.split("#")[0].split()
        if words[:1] == ["vt"]:
            places.append([float(words[1]), float(words[2]) if len(words) > 2 else 0.0])
        elif words[:1] == ["f"]:
            face = [int(parts[1]) if len(parts) > 1 and parts[1] else 0 for parts in (w.split("/") for w in words[1:])]
            face = [i - 1 if i > 0 else len(places) + i if i < 0 else -1 for i in face]
            for k in range(2, len(face)):
                corners.extend((face[0], face[k - 1], face[k]))
    if not places:
        return None
    index = np.array(corners, np.int64)
    if index.size and (index.max() >= len(places) or index.min() < -1):
        raise ImportFailure(f"{file}: a face has texture coordinates that are not there")
    return np.array(places + [[0.0, 0.0]], np.float32)[index]  # -1: a corner that has none


def is_number(value):
    """Also keeps out what no setting means: infinite, not a number, or too large for Blender."""
    return isinstance(value, (int, float)) and abs(value) < 1e9


def is_color(value):
    return isinstance(value, list) and len(value) == 3 and all(is_number(x) for x in value)


class Run:
    """A folder that `mallow run --out` wrote."""

    def __init__(self, folder):
        self.folder = os.path.realpath(folder)
        report = os.path.join(self.folder, "report.json")
        try:
            self.report = json.loads(read_bytes(report))
            groups = list(self.report["groups"])
            # Whose slot another body has by now: numbers from the end, which stay when more follow.
            self.past = [(int(p["slot"]), int(p["until"])) for p in self.report.get("past_bodies", [])]
            bodies = dict(enumerate(groups)) | {-1 - k: p for k, p in enumerate(self.report.get("past_bodies", []))}
            self.names = {b: str(g["name"]) for b, g in bodies.items()}
            self.spacings = {b: g.get("spacing") for b, g in bodies.items()}
            looks = {b: (str(g["material"]), g.get("color")) for b, g in bodies.items()}
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
            raise ImportFailure(f"{report}: is not the report of a run") from error
        self.scene = read_scene(os.path.join(self.folder, "scene.toml"))
        if not self.frames():
            raise ImportFailure(f"{self.folder}: has no surfaces; `mallow surface {self.folder}` draws them")
        materials = {m.get("name"): m for m in self.scene.get("material", [])}
        self.looks = {}
        for body, (name, color) in looks.items():
            material = materials.get(name, {})
            if not is_color(color):  # past bodies and reports of earlier versions have none
                color = material.get("color", next((c for m, c in looks.values() if m == name and is_color(c)), None))
            finish = material.get("finish")
            self.looks[body] = (tuple(color) if is_color(color) else (0.8, 0.8, 0.8),
                                finish if isinstance(finish, str) else "jelly")
        self._textures = {}
        self.skins = {}  # files, of each body that has some
        numbers = {name: body for body, name in self.names.items()}
        for b, body in enumerate(self.scene.get("body", [])):
            name = body.get("group") or f"body[{b}]"
            if isinstance(body.get("skin"), str) and body["skin"] and name in numbers:
                self.skins.setdefault(numbers[name], []).append(body["skin"])

    def bodies_at(self, frame, slots):
        """Slots of a frame as numbers of the bodies that had them then."""
        bodies = slots.copy()
        for k in reversed(range(len(self.past))):  # the first that ended later
            slot, until = self.past[k]
            if frame < until:
                bodies[slots == slot] = -1 - k
        return bodies

    def surface_file(self, frame):
        return os.path.join(self.folder, "surface", f"frame_{frame:06d}.ply")

    def frames(self):
        """Frames that have surfaces, ascending."""
        folder = os.path.join(self.folder, "surface")
        names = os.listdir(folder) if os.path.isdir(folder) else []
        return sorted(int(name[6:-4]) for name in names if re.fullmatch(r"frame_[0-9]{6,9}\.ply", name))

    def render(self, key, default, length=None):
        """A number of the scene's section [render], or a list of numbers."""
        value = self.scene.get("render", [{}])[0].get(key, default)
        numbers = value if isinstance(value, list) else [value]
        right = len(numbers) == length if isinstance(value, list) else length is None
        return value if right and all(is_number(x) for x in numbers) else default

    def speed(self):
        """Simulated seconds in a second of the film, by which velocities lead from one frame to the next."""
        time = self.report.get("frame_time")
        return time * self.render("frames_per_second", 30) if is_number(time) and time > 0 else 1.0

    def spacing(self, body):
        """Of a body's particles [m]."""
        spacing = self.spacings[body]
        return spacing if is_number(spacing) and spacing > 0 else 1.0

    def texture_coordinates(self, body):
        """Of each corner of a body's skin, or None."""
        if body not in self._textures:
            self._textures[body] = self._read_textures(body)
        return self._textures[body]

    def _read_textures(self, body):
        parts = []
        for skin in self.skins.get(body, []):
            file = os.path.join(self.folder, skin)
            try:
                parts.append(read_texture_coordinates(file) if file.lower().endswith(".obj") else None)
            except (ImportFailure, ValueError, IndexError, OverflowError) as error:
                print(f"mallow: {self.names[body]} has no texture coordinates: {error}", file=sys.stderr)
                parts.append(None)
        return np.concatenate(parts) if parts and all(p is not None for p in parts) else None
