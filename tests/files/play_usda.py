# Plays a series of USD files as a program with value clips does, and prints what it shows of each frame as JSON. An own
# reader after "USDA File Format Specification" and "Value Clips" of openusd.org, for want of OpenUSD in Debian; strict, as
# it knows nothing but what these pages say and the types that UsdGeomMesh, UsdGeomSubset and UsdPreviewSurface give their
# attributes. Argument: the series.
import json
import os
import re
import sys

TOKEN = re.compile(
    r'\s*(?:#[^\n]*\n\s*)*("(?:[^"\\\n]|\\.)*"|@@@.*?@@@|@[^@\n]*@|<[^>\n]*>|[A-Za-z_][A-Za-z0-9_:.]*|'
    r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|[(){}\[\]=,:])")
# What the schemas say of the attributes that mallow writes.
TYPES = {
    "Mesh": {"extent": "float3[]", "faceVertexCounts": "int[]", "faceVertexIndices": "int[]", "points": "point3f[]",
             "normals": "normal3f[]", "velocities": "vector3f[]", "primvars:displayColor": "color3f[]",
             "primvars:group": "int[]", "doubleSided": "uniform bool", "orientation": "uniform token",
             "subdivisionScheme": "uniform token", "subsetFamily:materialBind:familyType": "uniform token"},
    "GeomSubset": {"elementType": "uniform token", "familyName": "uniform token", "indices": "int[]"},
    "Material": {"outputs:surface": "token"},
    "Shader": {"info:id": "uniform token", "inputs:diffuseColor": "color3f", "inputs:roughness": "float",
               "outputs:surface": "token"},
    "Xform": {}, "Scope": {},
}


class Layer:
    def __init__(self, file):
        self.text = open(file, encoding="utf-8").read()
        assert self.text.startswith("#usda 1.0\n"), "header"
        self.at = len("#usda 1.0\n")
        self.token = None
        self.next()
        self.metadata = self.block() if self.token == "(" else {}
        self.prims = {}
        while self.token is not None:
            self.prim("")

    def next(self):
        rest = TOKEN.match(self.text, self.at)
        if rest is None:
            assert not self.text[self.at:].strip(), f"no token: {self.text[self.at:self.at + 40]!r}"
        was, self.token, self.at = self.token, rest and rest[1], rest.end() if rest else len(self.text)
        return was

    def expect(self, token):
        assert self.token == token, f"{token!r} expected, {self.token!r} found"
        self.next()

    def value(self):
        if self.token in ("[", "("):
            close = "]" if self.next() == "[" else ")"
            values = []
            while self.token != close:
                values.append(self.value())
                if self.token != close:
                    self.expect(",")
            self.next()
            return values
        if self.token == "{":
            return self.dictionary()
        token = self.next()
        if token[0] in '"@<':
            return json.loads(token) if token[0] == '"' else token.strip("@<>")
        return token if token[0].isalpha() else float(token) if re.search("[.eE]", token) else int(token)

    def typed_name(self):
        """`uniform token orientation`: what stands before the name, and the name."""
        words = [self.next()]
        if words[0] in ("uniform", "custom"):
            words.append(self.next())
        if self.token == "[":
            self.next()
            self.expect("]")
            words[-1] += "[]"
        return " ".join(words), self.next()

    def dictionary(self):
        self.expect("{")
        found = {}
        while self.token != "}":
            _, name = self.typed_name()
            self.expect("=")
            assert name not in found, name
            found[name] = self.value()
        self.next()
        return found

    def samples(self):
        self.expect("{")
        found = {}
        while self.token != "}":
            time = float(self.next())
            self.expect(":")
            assert time not in found, time
            found[time] = self.value()
            if self.token != "}":
                self.expect(",")
        self.next()
        return found

    def block(self):
        self.expect("(")
        found = {}
        while self.token != ")":
            words = [self.next()]
            while self.token != "=":
                words.append(self.next())
            self.next()
            assert words[-1] not in found, words
            found[words[-1]] = self.value()
        self.next()
        return found

    def prim(self, parent):
        self.expect("def")
        kind, name = self.next(), json.loads(self.next())
        assert re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", name), name
        path = f"{parent}/{name}"
        assert path not in self.prims, path
        prim = self.prims[path] = {"type": kind, "metadata": self.block() if self.token == "(" else {}, "values": {},
                                   "samples": {}, "declared": {}, "relations": {}}
        self.expect("{")
        while self.token != "}":
            if self.token == "def":
                self.prim(path)
                continue
            type_name, name = self.typed_name()
            if type_name == "rel":
                self.expect("=")
                prim["relations"][name] = self.value()
                continue
            base = re.sub(r"\.(timeSamples|connect)$", "", name)
            assert TYPES[kind].get(base) == type_name, f"{path}: {type_name} {base}"
            if name.endswith(".timeSamples"):
                self.expect("=")
                prim["samples"][base] = self.samples()
            elif name.endswith(".connect"):
                self.expect("=")
                prim["relations"][base] = self.value()
            else:
                prim["declared"].setdefault(base, {})
                if self.token == "=":
                    self.next()
                    assert base not in prim["values"], base
                    prim["values"][base] = self.value()
                if self.token == "(":
                    prim["declared"][base] = self.block()
        self.next()


def check_mesh(of, interpolations):
    """What UsdGeomMesh demands of the values of one moment."""
    points, counts, corners = of["points"], of["faceVertexCounts"], of["faceVertexIndices"]
    assert sum(counts) == len(corners) and all(c == 3 for c in counts)
    assert all(0 <= c < len(points) for c in corners)
    for name in ("normals", "velocities"):
        assert name not in of or len(of[name]) == len(points), name
    if "normals" in of:
        assert interpolations["normals"] == "vertex"
    for name in ("primvars:displayColor", "primvars:group"):
        if name in of:
            size = {"uniform": len(counts), "constant": 1}[interpolations[name]]
            assert len(of[name]) == size, name
    if points:
        for k in range(3):
            column = [p[k] for p in points]
            assert of["extent"][0][k] == min(column) and of["extent"][1][k] == max(column), "extent"


def play(file):
    folder = os.path.dirname(file)
    series = Layer(file)
    root = "/" + series.metadata["defaultPrim"]
    clips = series.prims[root]["metadata"]["clips"]["default"]
    assert clips["primPath"] == root
    manifest = Layer(os.path.join(folder, clips["manifestAssetPath"]))
    reference = Layer(os.path.join(folder, series.prims[root]["metadata"]["references"]))
    layers = [Layer(os.path.join(folder, asset)) for asset in clips["assetPaths"]]
    for layer in (manifest, *layers):
        for name in ("metersPerUnit", "upAxis", "timeCodesPerSecond", "framesPerSecond"):
            assert layer.metadata[name] == series.metadata[name], name
    frames = {}
    for (start, clip), (stage_time, clip_time) in zip(clips["active"], clips["times"]):
        assert start == stage_time
        layer, frame = layers[clip], {}
        for path, prim in reference.prims.items():
            values = dict(prim["values"])
            for name in manifest.prims.get(path, {"declared": {}})["declared"]:
                samples = layer.prims[path]["samples"].get(name, {})
                if samples:  # the last sample at or before the time, as arrays of other sizes cannot be blended
                    values[name] = samples[max([t for t in samples if t <= clip_time], default=min(samples))]
            interpolations = {n: m.get("interpolation") for n, m in prim["declared"].items()}
            if prim["type"] == "Mesh":
                check_mesh(values, interpolations)
                faces = len(values["faceVertexCounts"])
            frame[path] = values
        subsets = [v["indices"] for p, v in frame.items() if reference.prims[p]["type"] == "GeomSubset"]
        if subsets:
            assert sorted(i for s in subsets for i in s) == list(range(faces)), "a partition of the faces"
        frames[str(int(stage_time))] = frame
    bindings = {p: prim["relations"]["material:binding"] for p, prim in reference.prims.items()
                if "material:binding" in prim["relations"]}
    for path, material in bindings.items():
        assert "MaterialBindingAPI" in reference.prims[path]["metadata"]["apiSchemas"], path
        assert reference.prims[material]["type"] == "Material", material
        shader, output = reference.prims[material]["relations"]["outputs:surface"].split(".")
        assert reference.prims[shader]["values"]["info:id"] == "UsdPreviewSurface" and output == "outputs:surface"
    return {"metadata": series.metadata, "frames": frames, "bindings": bindings}


try:
    json.dump(play(sys.argv[1]), sys.stdout)
except AssertionError as error:
    json.dump({"error": str(error) or "not as the schemas say"}, sys.stdout)
