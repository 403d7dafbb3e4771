"""Holds tables of the benchmarks' pages to the results that were committed.

check_tables.py SOURCE_FOLDER

Before such a table stands, in a comment, where its numbers are from, a cell each:
    <!-- results/table1.csv name: particles | fps1 | | 100 * surface_distance -->
`name` is the column of the CSV that the first cells of rows stand in. What is left empty is not looked at. Where the rows of
the CSV are numbers by kind, a kind stands before its column, `drop/height [m]: value`. A cell with several numbers, "9.9 / 9.8",
has those of the rows that fit, in their order.
"""
import csv
import pathlib
import re
import sys

SOURCE = pathlib.Path(sys.argv[1])
NUMBER = r"-?\d+(?:\.\d+)?"


def shown(value, like):
    """The number as the cell shows it, rounded to as many decimals."""
    return f"{float(value):.{len(like.partition('.')[2])}f}"


def expected(rows, column):
    """What the rows hold of `100 * test/quantity: value`, or of `100 * value`."""
    factor, _, rest = column.rpartition(" * ")
    kind, _, name = rest.rpartition(": ")
    if kind:
        test, _, quantity = kind.partition("/")
        rows = [row for row in rows if (row["test"], row["quantity"]) == (test, quantity)]
    return [float(factor or 1) * float(row[name]) for row in rows if row[name]]


def check(page, file, key, columns, table):
    """Problems of a table of a page."""
    with open(page.parent / file, newline="") as text:
        results = list(csv.DictReader(text))
    for line in table:
        name, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        rows = [row for row in results if row[key] == name]
        if not rows:
            yield f"{page.name}: no {key} {name} in {file}"
        for cell, column in zip(cells, columns, strict=True):
            here = re.findall(NUMBER, cell)
            if not column or not here:
                continue
            there = expected(rows, column)
            if there[1:] == there[:-1]:  # a theory is the same for all
                there = there[:len(here)]
            if len(here) != len(there) or any(shown(value, text) != text for text, value in zip(here, there)):
                yield f"{page.name}: {name} has {cell} for {column}, {file} has {there}"


problems, tables = [], 0
for page in (SOURCE / "bench").glob("*.md"):
    for found in re.finditer(r"<!-- (\S+\.csv) (\w+): ([^>]*) -->\n\|.*\n\|[-: |]+\n((?:\|.*\n)+)", page.read_text()):
        tables += 1
        columns = [column.strip() for column in found[3].split("|")]
        problems += check(page, found[1], found[2], columns, found[4].splitlines())
if tables < 3:
    problems.append(f"only {tables} tables name their results")
print("\n".join(problems))
sys.exit(1 if problems else 0)
