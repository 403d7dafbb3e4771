"""Calls everything in the module with random arguments, right and wrong: fuzz.py [SECONDS] [SEED].

Whatever happens must be an exception of Python; a crash ends the process, and what it was doing stands in the file
fuzz.last. Threads use the same objects at the same time.
"""
import faulthandler
import os
import random
import re
import resource
import sys
import tempfile
import threading
import time
import warnings

import mallow
import numpy
from support import SCENE, cube

# Those that take longer the larger a number is, and would take minutes or all memory.
SLOW = {"mesh_shape", "mesh_collider", "implicit_shape", "moai_shape", "Renderer", "distance_field", "DistanceField"}
ALLOWED = (mallow.Error, TypeError, ValueError, AttributeError, KeyError, IndexError, OverflowError, MemoryError,
           RuntimeError, OSError, NotImplementedError, BufferError, UnicodeError)


class Fuzzer:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.numbers = numpy.random.default_rng(seed)
        self.pool = []
        self.log = open("fuzz.last", "w")
        self.calls = self.refused = 0
        self.classes = [value for value in vars(mallow).values()
                        if isinstance(value, type) and not issubclass(value, Exception)]
        self.functions = [value for name, value in vars(mallow).items()
                          if callable(value) and not isinstance(value, type) and not name.startswith("_")
                          and name not in SLOW and name not in ("render", "write_whole")]
        self.fill()

    def fill(self):
        """The pool anew. Other threads see it when it is whole."""
        cubes = [cube(3), cube(2, alpha=1.0), cube(3, plastic_yield=0.1, temperature=300.0)]
        simulation, surfacer = cubes[0], mallow.Surfacer()
        simulation.step()
        skin = mallow.Skin(simulation, simulation.bodies()[0], mallow.surface(simulation.positions, 1))
        self.pool = [*cubes, surfacer, mallow.parse_scene(SCENE),
                     mallow.sample(mallow.Lattice([3, 3, 3], 1, [8, 0, 1])),
                     mallow.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
                     surfacer.draw(simulation), simulation.save(), mallow.snapshot(simulation), skin,
                     mallow.Emitter(radius=1.5, pose=mallow.Pose([0, 0, 9]), most_particles=200),
                     *simulation.bodies(), *simulation.collider_ids()]

    def number(self):
        return self.random.choice([0, 1, -1, 2, 3, 0.5, 1e-3, -0.0, 1e30, -1e30, float("nan"), float("inf"),
                                   2**31, 2**32 + 1, 2**64 - 1, -2**63, 10**30, True, self.random.random(),
                                   self.random.randint(0, 30)])

    def array(self):
        shape = self.random.choice([(3,), (3,), (3,), (1, 3), (5, 3), (0,), (0, 3), (4,), (2, 2, 3), (), (27,), (3, 27)])
        kind = self.random.choice(["f4", "f8", "f4", "i4", "i8", "u4", "u8", "?", "c8", ">f4", "S3", "O", "u1", "f2"])
        with numpy.errstate(all="ignore"):
            array = self.numbers.normal(0, self.random.choice([1, 1, 10, 1e20]), shape).astype(kind, casting="unsafe")
        if array.ndim and self.random.random() < 0.3:
            array = array[::self.random.choice([-1, 2])]
        return array.T if self.random.random() < 0.1 else array

    def value(self):
        pick = self.random.random()
        if pick < 0.45 and self.pool:
            return self.random.choice(self.pool)
        if pick < 0.6:
            return self.number()
        if pick < 0.75:
            return self.array()
        if pick < 0.8:
            return [float(self.number() if self.random.random() < 0.3 else self.random.uniform(-5, 5)) for _ in range(3)]
        return self.random.choice([
            None, "", "paste", "jelly", "\x00", "x" * 300, b"", b"bytes", [], (), {}, [[0, 1], [2, 3]], object(),
            mallow, int, lambda *arguments: None, lambda *arguments: 1.0, self.fail, [self.number(), self.number()],
            os.path.join(self.folder, "file"), "/nowhere/file.ply", self.random.choice(self.classes)])

    def of_type(self, kind):
        """A value of the type that a signature names, most times."""
        kind = re.sub(r"^(Optional\[|Union\[)|\]$", "", kind.replace("mallow._mallow.", "").replace("mallow.", ""))
        kind = self.random.choice(kind.split(", ")) if not kind.startswith(("Callable", "List")) else kind
        if kind == "float":
            return self.random.choice([0.1, 0.5, 1.0, 2.0, self.random.uniform(0, 3), self.number()])
        if kind == "int":
            return self.random.choice([0, 1, 2, 8, self.number()])
        if kind == "bool":
            return self.random.random() < 0.5
        if kind == "Vector":
            return [self.random.uniform(-6, 12) for _ in range(3)]
        if kind == "numpy.ndarray":
            simulations = [value for value in self.pool if isinstance(value, mallow.Simulation)]
            try:
                picked = self.random.choice(simulations)
                return self.random.choice([picked.ids[::3], picked.ids[:1], picked.positions, picked.ids, self.array()])
            except (IndexError, mallow.Error):
                return self.array()
        if kind.startswith("Callable"):
            return self.random.choice([self.fail, lambda *arguments: None, lambda *arguments: self.random.uniform(-1, 1)])
        if kind.startswith("List["):
            return [self.of_type(kind[5:]) for _ in range(self.random.randint(0, 3))]
        if kind in ("str", "os.PathLike"):
            return self.random.choice(["cube", "jelly", os.path.join(self.folder, "file"), "file.ply"])
        found = [value for value in self.pool if type(value).__name__ == kind]
        made = getattr(mallow, kind, None)
        try:
            if self.random.random() < 0.02:
                return made.__new__(made)  # nobody constructs it
            return self.random.choice(found) if found and self.random.random() < 0.8 else made()
        except ALLOWED:
            return self.value()

    def fitting(self, function):
        """Arguments as one of the signatures has them, most of them."""
        signatures = re.findall(r"^(?:\d+\. )?\w+\((.*)\) -> ", getattr(function, "__doc__", None) or "", re.M)
        signatures = [text for text in signatures if not text.startswith("*args")]
        if not signatures or self.random.random() < 0.2:
            return [self.value() for _ in range(self.random.choice([0, 1, 1, 2, 2, 3, 4]))]
        parts = [part for part in re.split(r", (?=\w+: )", self.random.choice(signatures)) if ": " in part]
        kinds = [part.split(": ", 1)[1].split(" = ")[0] for part in parts if not part.startswith("self: ")]
        return [self.of_type(kind) if self.random.random() < 0.9 else self.value() for kind in kinds]

    @staticmethod
    def shown(value):
        try:
            return repr(value)[:200]
        except ALLOWED:
            return f"a bare {type(value).__name__}"

    @staticmethod
    def fail(*arguments):
        raise ValueError("on purpose")

    def call(self, function, name):
        arguments = self.fitting(function)
        self.log.seek(0)
        self.log.truncate()
        self.log.write(f"{name} {[self.shown(argument) for argument in arguments]}\n")
        self.log.flush()
        self.calls += 1
        try:
            with numpy.errstate(all="ignore"):
                made = function(*arguments)
        except ALLOWED:
            self.refused += 1
            return
        self.keep(made)

    def keep(self, made):
        if isinstance(made, (tuple, list)) and not isinstance(made, str):
            for part in list(made)[:3]:
                self.keep(part)
        elif made is not None and type(made).__module__.startswith(("mallow", "numpy")):
            if isinstance(made, mallow.Simulation) and made.particle_count > 20000:
                return
            self.pool.append(made)

    def touch(self, value):
        """Reads all of an array, or an attribute of an object, or sets one."""
        if isinstance(value, numpy.ndarray):
            value.tobytes()
            return
        names = [name for name in dir(type(value)) if not name.startswith("__")]
        if not names:
            return
        name = self.random.choice(names)
        try:
            if isinstance(getattr(type(value), name, None), property):
                if self.random.random() < 0.5:
                    self.keep(getattr(value, name))
                else:
                    setattr(value, name, self.value())
                repr(value)
            elif name == "advance":  # takes as long as one asks for
                value.advance(self.random.choice([0, -1, float("nan"), 2 * value.step().time_step]))
            elif name != "_fields":
                self.call(getattr(value, name), f"{type(value).__name__}.{name}")
        except ALLOWED:
            self.refused += 1

    def run(self, seconds, folder):
        self.folder = folder
        stop = time.monotonic() + seconds
        background = threading.Thread(target=self.disturb, args=(stop,))
        background.start()
        watched = 0
        most = 250 * seconds  # as many as two cores take: a faster machine shall not come where nobody was
        while time.monotonic() < stop and self.calls < most:
            if self.calls >= watched:
                faulthandler.dump_traceback_later(300, exit=True)
                watched = self.calls + 200
            pick = self.random.random()
            if pick < 0.2:
                function = self.random.choice(self.functions)
                self.call(function, function.__name__)
            elif pick < 0.35:
                self.call(self.random.choice(self.classes), "class")
            elif pick < 0.45:
                self.matching()
            else:
                self.touch(self.random.choice(self.pool))
            if len(self.pool) > 150 or self.random.random() < 0.0005:
                self.random.shuffle(self.pool)
                del self.pool[60:]
                self.pool += [cube(3)]
            if self.random.random() < 0.0005:
                self.fill()
        background.join()
        faulthandler.cancel_dump_traceback_later()

    def matching(self):
        """A class with keywords that it has: more of these calls come through."""
        kind = self.random.choice([kind for kind in self.classes if hasattr(kind, "_fields")])
        names = self.random.sample(kind._fields, min(len(kind._fields), self.random.randint(0, 3)))
        self.call(lambda *ignored: kind(**{name: self.value() for name in names}), kind.__name__)

    def disturb(self, stop):
        """Uses whatever there is from another thread."""
        other = random.Random(1)
        while time.monotonic() < stop:
            try:
                value = other.choice(self.pool)
                if isinstance(value, mallow.Simulation):
                    other.choice([lambda: value.positions.sum(), value.events, lambda: repr(value), value.step])()
                elif isinstance(value, mallow.Mesh):
                    value.vertices.sum()
            except ALLOWED:
                pass
            time.sleep(0.001)


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    faulthandler.enable()
    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_AS, (12 << 30, 12 << 30))  # what asks for more gets MemoryError
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder if len(sys.argv) < 4 else sys.argv[3])
        fuzzer = Fuzzer(seed)
        fuzzer.run(seconds, folder)
        print(f"{fuzzer.calls} calls in {seconds:g} s, {fuzzer.refused} refused, seed {seed}")


if __name__ == "__main__":
    main()
