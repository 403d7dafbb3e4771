#!/usr/bin/env python3
"""Runs the cells of a notebook and writes a page of Markdown with what they gave: run_notebook.py NOTEBOOK FOLDER.

As Jupyter does, without it: cells run one after the other in one process; below each stand what it printed, the value
of its last line, and the figures of matplotlib that it made. Ends with 1 where a cell fails, and says which.
"""
import ast
import contextlib
import io
import json
import sys
import traceback
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


def run(source, names):
    """What a cell prints, and its last value, as text."""
    tree = ast.parse(source)
    last = None
    if tree.body and isinstance(tree.body[-1], ast.Expr) and not source.rstrip().endswith(";"):
        last = ast.Expression(tree.body.pop().value)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(tree, "cell", "exec"), names)
        value = eval(compile(last, "cell", "eval"), names) if last else None
    return printed.getvalue() + (f"{value!r}\n" if value is not None else "")


def figures(folder, name, count):
    """Links to the pictures of all figures that are open, which are closed."""
    links = ""
    for number in pyplot.get_fignums():
        count += 1
        pyplot.figure(number).savefig(folder / f"{name}_{count}.png", dpi=100)
        links += f"![]({name}_{count}.png)\n\n"
    pyplot.close("all")
    return links, count


def main(notebook, folder):
    folder.mkdir(parents=True, exist_ok=True)
    names, page, pictures = {"__name__": "__main__"}, "", 0
    for number, cell in enumerate(json.loads(notebook.read_text())["cells"], 1):
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            page += source + "\n\n"
            continue
        try:
            text = run(source, names)
        except Exception:
            print(f"{notebook}: cell {number} fails:\n{source}\n\n{traceback.format_exc()}", file=sys.stderr)
            return 1
        page += f"```python\n{source}\n```\n\n" + (f"```\n{text}```\n\n" if text else "")
        links, pictures = figures(folder, notebook.stem, pictures)
        page += links
    (folder / f"{notebook.stem}.md").write_text(page)
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
