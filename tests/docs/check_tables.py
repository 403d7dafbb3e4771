"""Holds tables of the benchmarks' pages to the results that were committed.

check_tables.py SOURCE_FOLDER [--write]    --write puts the numbers of the results in place of others

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
WRITE = "--write" in sys.argv
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


def compare(page, file, key, columns, table):
    """Problems of a table of a page, and its lines with the numbers of the results."""
    with open(page.parent / file, newline="") as text:
        results = list(csv.DictReader(text))
    problems, lines = [], []
    for line in table:
        name, *cells = line.strip("|").split("|")
        rows = [row for row in results if row[key] == name.strip()]
        if not rows:
            problems.append(f"{page.name}: no {key} {name.strip()} in {file}")
        for place, (cell, column) in enumerate(zip(cells, columns, strict=True)):
            here = re.findall(NUMBER, cell)
            if not column or not here:
                continue
            there = expected(rows, column)
            if there[1:] == there[:-1]:  # a theory is the same for all
                there = there[:len(here)]
            values = [shown(value, text) for text, value in zip(here, there)]
            if len(here) != len(there) or values != here:
                problems.append(f"{page.name}: {name.strip()} has {cell.strip()} for {column}, {file} has {there}")
            if len(here) == len(there):
                cells[place] = re.sub(NUMBER, lambda _: values.pop(0), cell)
        lines.append("|" + "|".join([name, *cells]) + "|")
    return problems, lines


def look_at(page):
    """Problems of all tables of a page, and its text with the numbers of the results."""
    problems, text = [], page.read_text()

    def table(found):
        columns = [column.strip() for column in found[4].split("|")]
        here, lines = compare(page, found[2], found[3], columns, found[6].splitlines())
        problems.extend(here)
        return found[1] + found[5] + "\n".join(lines) + "\n"

    pattern = r"(<!-- (\S+\.csv) (\w+): ([^>]*) -->\n)(\|.*\n\|[-: |]+\n)((?:\|.*\n)+)"
    text, tables = re.subn(pattern, table, text)
    return problems, tables, text


def follow(page):
    """Problems of a page; where it is written anew, those that are left."""
    problems, tables, text = look_at(page)
    if WRITE and text != page.read_text():
        page.write_text(text)
        problems, tables, _ = look_at(page)
    return problems, tables


pages = [follow(page) for page in (SOURCE / "bench").glob("*.md")]
problems = [problem for found, _ in pages for problem in found]
tables = sum(count for _, count in pages)
if tables < 3:
    problems.append(f"only {tables} tables name their results")
print("\n".join(problems))
sys.exit(1 if problems else 0)
