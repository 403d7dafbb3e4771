"""Writes mallow/__init__.pyi: the names, signatures and doc strings of the module, for editors and type checkers.

make_stubs.py FOLDER: of the package in FOLDER/mallow, which must be importable.
"""
import inspect
import keyword
import re
import sys
from pathlib import Path

HEAD = '''# Made by make_stubs.py of the module itself.
import os
import typing
from typing import Any, Callable, Iterator, Optional, Sequence, Union as _Union

import numpy

Vector = _Union[numpy.ndarray, Sequence[float]]  # three numbers
Quaternion = _Union[numpy.ndarray, Sequence[float]]  # x, y, z, w
Array = _Union[numpy.ndarray, Sequence[Any]]
'''
SIGNATURE = re.compile(r"^(?:\d+\. )?(\w+)\((.*)\) -> (.+)$")


def type_text(text, is_argument):
    """A type as pybind11 writes it, as Python has it."""
    text = re.sub(r"mallow\.(_mallow\.)?|\[\d+\]", "", text)
    text = re.sub(r"\bUnion\[(?=[A-Z].*[,\]])", "_Union[", text)
    text = text.replace("Tuple[", "typing.Tuple[").replace("List[", "Sequence[" if is_argument else "list[")
    text = text.replace("os.PathLike", "_Union[str, os.PathLike]").replace("capsule", "Any")
    if is_argument:
        text = text.replace("numpy.ndarray", "Array")
    else:
        text = re.sub(r"\b(Vector|Quaternion)\b", "numpy.ndarray", text)
    return re.sub(r"Callable\[\[(.*?)\], (.*?)\]", r"Callable[[\1], \2]", text)


def split(arguments):
    """Arguments at the commas that are outside of brackets."""
    parts, depth, part = [], 0, ""
    for character in arguments:
        depth += character in "[({"
        depth -= character in "])}"
        if character == "," and depth == 0:
            parts.append(part.strip())
            part = ""
        else:
            part += character
    return [*parts, part.strip()] if part.strip() else parts


def argument(text):
    name, colon, rest = text.partition(": ")
    if not colon:
        return text
    kind, equals, _ = rest.partition(" = ")
    return f"{name}: {type_text(kind, True)}" + (" = ..." if equals else "")


def indented(text, depth):
    pad = "    " * depth
    body = text.replace("\\", "\\\\").replace('"""', "'''").strip()
    if body.endswith('"'):
        body += " "
    return f'{pad}"""' + body.replace("\n", "\n" + pad) + '"""\n'


def function(name, value, depth, is_static=False):
    doc = value.__doc__ or ""
    pad = "    " * depth
    found = []
    for line in doc.splitlines():
        match = SIGNATURE.match(line)
        if match and match.group(1) == name:
            found.append([match, []])
        elif found:
            found[-1][1].append(line)
    overloads = found[1:] if len(found) > 1 and found[0][0].group(2).startswith("*args") and "Overloaded" in doc else found
    text = ""
    for match, lines in overloads:
        arguments = [argument(part) for part in split(match.group(2))]
        if depth and not is_static and arguments:
            arguments[0] = "self"
        if any(keyword.iskeyword(part.partition(":")[0]) for part in arguments):
            continue
        if is_static:
            text += f"{pad}@staticmethod\n"
        if len(overloads) > 1:
            text += f"{pad}@typing.overload\n"
        text += f"{pad}def {name}({', '.join(arguments)}) -> {type_text(match.group(3), False)}:\n"
        text += indented("\n".join(lines) or "...", depth + 1)
    return text or f"{pad}def {name}(*args: Any, **kwargs: Any) -> Any: ...\n"


CHOICES = set()  # enumerations, which may be words


def getter_type(value):
    """What a property gives, as pybind11 writes it; None where that is not known."""
    match = SIGNATURE.match((value.fget.__doc__ or "").strip().split("\n")[0]) or re.match(
        r"()(\(.*\)) -> (.+)", (value.fget.__doc__ or "").strip().split("\n")[0])
    return match.group(3) if match else None


def given_type(value):
    """What may be given to a property, or to the constructor for it."""
    kind = getter_type(value)
    if not kind:
        return "Any"
    text = re.sub(r"\blist\[|typing\.Tuple\[(.*), \.\.\.\]$", lambda found: f"Sequence[{found[1]}]" if found[1] else "Sequence[",
                  type_text(kind, True))
    text = re.sub(r"\b(\w+)\b", lambda found: f"_Union[{found[0]}, str]" if found[0] in CHOICES else found[0], text)
    return text.replace("Schedule", "_Union[Schedule, float, Sequence[Any]]")


def attribute(name, value, depth):
    """A property: its type is that of its getter."""
    known = getter_type(value)
    kind = type_text(known, False) if known else "Any"
    pad = "    " * depth
    text = f"{pad}@property\n{pad}def {name}(self) -> {kind}:\n" + indented(value.__doc__ or "...", depth + 1)
    if value.fset:
        text += f"{pad}@{name}.setter\n{pad}def {name}(self, value: {given_type(value)}) -> None: ...\n"
    return text


def constructor(value, depth):
    """Of a struct: all of its fields, each left out as it is by default. Those of a scene go by name alone."""
    fields = [f"{name}: {given_type(getattr(value, name))} = ..." for name in value._fields]
    if value.__name__ == "Scene":
        fields.insert(0, "*")
    return "    " * depth + f"def __init__({', '.join(['self', *fields])}) -> None: ...\n"


def klass(name, value, depth):
    pad = "    " * depth
    bases = [base.__name__ for base in value.__bases__ if base.__name__ not in ("object", "pybind11_object")]
    text = f"{pad}class {name}" + (f"({', '.join(bases)})" if bases else "") + ":\n"
    text += indented((value.__doc__ or "...").split("\n\nMembers:")[0], depth + 1)
    for key, member in vars(value).items():
        if isinstance(member, type):
            text += klass(key, member, depth + 1)
        elif isinstance(member, property):
            text += attribute(key, member, depth + 1)
        elif isinstance(member, staticmethod):
            text += function(key, member.__func__, depth + 1, True)
        elif key == "__init__" and hasattr(value, "_fields"):
            text += constructor(value, depth + 1)
        elif key == "__init__" and not any(SIGNATURE.match(line) for line in (member.__doc__ or "").splitlines()):
            continue  # none, or one of Python
        elif key in ("__init__", "__len__", "__iter__", "__int__", "__float__") or (
                not key.startswith("_") and callable(member) and not isinstance(member, value)):
            text += function(key, member, depth + 1)
        elif isinstance(member, value) and not key.startswith("_"):
            text += f"{pad}    {key}: {name}\n"
        elif issubclass(value, Exception) and not key.startswith("_"):
            text += f"{pad}    {key}: Any\n"
    return text


def main(folder):
    sys.path.insert(0, folder)
    import mallow
    CHOICES.update(name for name, value in vars(mallow).items() if hasattr(value, "__members__"))
    text = HEAD + "\n__version__: str\n\n"
    for name, value in vars(mallow).items():
        if name.startswith("_"):
            continue
        if isinstance(value, type):
            text += klass(name, value, 0) + "\n"
        elif inspect.ismodule(value):
            if name == "materials":
                text += "class materials:\n" + indented(value.__doc__, 1)
                for key, member in vars(value).items():
                    if not key.startswith("_"):
                        text += function(key, member, 1, True)
                text += "\n"
        elif inspect.isbuiltin(value):
            text += function(name, value, 0) + "\n"
        elif inspect.isfunction(value):
            text += f"def {name}{inspect.signature(value)}:\n" + indented(value.__doc__ or "...", 1) + "\n"
    (Path(folder) / "mallow" / "__init__.pyi").write_text(text)


if __name__ == "__main__":
    main(sys.argv[1])
