"""Holds the pages of the documentation to what is there: links, options, scenes, programs and messages.

check_pages.py SOURCE_FOLDER MALLOW_PROGRAM
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import messages

SOURCE, PROGRAM = pathlib.Path(sys.argv[1]), sys.argv[2]
PAGES = [SOURCE / "README.md", *sorted((SOURCE / "tools").rglob("*.md")), *sorted((SOURCE / "engine").glob("*.md")),
         SOURCE / ".github/CONTRIBUTING.md", *sorted((SOURCE / "bench").glob("*.md"))]
problems = []


def problem(page, text, place):
    line = text.count("\n", 0, place) + 1
    return lambda what: problems.append(f"{page.relative_to(SOURCE)}:{line}: {what}")


def anchors(page):
    """Of the headings, as GitHub names them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check_links(page, text):
    for found in re.finditer(r"\]\(([^)\s]+)\)", text):
        target, _, anchor = found[1].partition("#")
        if re.match(r"\w+:", target):
            continue
        file = (page.parent / target).resolve() if target else page
        if not file.exists():
            problem(page, text, found.start())(f"no {target}")
        elif anchor and anchor not in anchors(file):
            problem(page, text, found.start())(f"no heading {anchor} in {target}")


def help_of(command, known={}):
    if command not in known:
        known[command] = subprocess.run([PROGRAM, *command.split(), "--help"], capture_output=True, text=True).stdout
    return known[command]


def check_options(page, text):
    """What follows `mallow COMMAND`, in a line of code: options that it has."""
    for found in re.finditer(r"\bmallow ([a-z]+)\b([^`\n]*)", text):
        code = text.rfind("`", 0, found.start()) > text.rfind("\n", 0, found.start()) or in_block(text, found.start())
        if not code:
            continue
        usage = help_of(found[1])
        if not usage:
            problem(page, text, found.start())(f"no command {found[1]}")
        for option in re.findall(r"(?<!\S)(--[a-z][a-z-]*)", found[2].split("#")[0]):
            if option not in usage:
                problem(page, text, found.start())(f"mallow {found[1]} has no {option}")


def in_block(text, place):
    return text.count("\n```", 0, place) % 2 == 1


def check_programs(page, text):
    """A whole program stands in tools/examples as it is, and is compiled and run there."""
    examples = {file.name: file.read_text() for file in (SOURCE / "tools/examples").glob("*.cpp")}
    for found in re.finditer(r"^```cpp\n(.*?)^```", text, re.M | re.S):
        if not any(found[1] in example for example in examples.values()):
            problem(page, text, found.start())("no example has this program")


def check_cmake(page, text):
    """Lines of CMake stand in a project of tests/install."""
    built = [line for name in ("consumer", "embedded")
             for line in (SOURCE / f"tests/install/{name}/CMakeLists.txt").read_text().splitlines()]
    for found in re.finditer(r"^```cmake\n(.*?)^```", text, re.M | re.S):
        for line in found[1].splitlines():
            if line not in built:
                problem(page, text, found.start())(f"no project of tests/install has '{line}'")


def check_scenes(page, text):
    for found in re.finditer(r"^```toml\n(.*?)^```", text, re.M | re.S):
        if found[1].startswith("scene ="):
            continue  # a sweep, which run_snippets.py runs
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "scene.toml"
            scene.write_text(found[1])
            run = subprocess.run([PROGRAM, "info", scene], capture_output=True, text=True)
            if run.returncode != 0 or "warning" in run.stderr:
                problem(page, text, found.start())(f"mallow info says {run.stderr}")
    for found in re.finditer(r"data/scenes/[\w/]+\.toml", text):
        if not (SOURCE / found[0]).exists():
            problem(page, text, found.start())(f"no {found[0]}")


def strings():
    """All strings of the sources, those in several parts joined."""
    sources = [*(SOURCE / "engine").rglob("*.cpp"), *(SOURCE / "engine").rglob("*.h"), *(SOURCE / "tools").rglob("*.cpp"),
               *(SOURCE / "tools").rglob("*.h")]
    return re.sub(r'"\s*\n?\s*"', "", "\n".join(file.read_text() for file in sources))


def check_messages(page, text):
    """What rows quote is said somewhere, and what the sources say is quoted."""
    everything, quoted = strings(), set()
    for row in re.finditer(r"^\| (`[^|]*`) \|", text, re.M):
        for found in re.finditer(r"`([^`]+)`", row[1]):
            quoted.add(found[1])
            if found[1] not in everything:
                problem(page, text, row.start())(f"nothing says '{found[1]}'")
    for file, line, said in messages.messages(SOURCE):
        if not any(part in said for part in quoted):
            problems.append(f"{file}:{line}: {page.name} has no line for '{said}'")


def check_sources(name, text):
    """Keys of sources, "[Steffe 1996, table of foods]", stand in REFERENCES.md."""
    known = re.findall(r"\*\*([^*]+)\*\*", (SOURCE / "engine/REFERENCES.md").read_text())
    for found in re.finditer(r"(?<!!)\[(?=[A-Z])([^\],]+)[^\]]*\](?!\()", text):
        if " ".join(re.sub(r"\n#?", " ", found[1]).split()) not in known:
            problems.append(f"{name}: no source {found[1]} in REFERENCES.md")


def check_materials(page, text):
    """A section for each material by name, with its picture, and a row for each number of its file that says the same."""
    sections = dict(re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", text, re.M | re.S))
    files = {file.stem: file.read_text() for file in (SOURCE / "data/materials").glob("*.toml")}
    if set(sections) != set(files):
        problems.append(f"{page.name}: sections {sorted(set(sections) ^ set(files))} are on one side alone")
    for name, section in sections.items():
        rows = re.findall(r"^\| `(\w+)` \| ([^|]*) \|", section, re.M)
        numbers = re.findall(r"^(?!about|color|finish)(\w+) = (.*)$", files.get(name, ""), re.M)
        if [key for key, _ in rows] != [key for key, _ in numbers]:
            problems.append(f"{page.name}: {name} has rows {rows}, and numbers {numbers}")
        for (key, here), (_, value) in zip(rows, numbers):
            if not re.match(re.escape(value) + r"(?![\w.])", here):
                problems.append(f"{page.name}: {name} has {key} = {value}, not {here}")
        if f"pictures/materials/{name}.jpg" not in section:
            problems.append(f"{page.name}: {name} has no picture")
        check_sources(f"data/materials/{name}.toml", files.get(name, ""))
    check_sources(page.name, text)


for page in PAGES:
    text = page.read_text()
    check_links(page, text)
    check_options(page, text)
    if page.name not in ("STEP.md", "ADDING.md"):
        check_programs(page, text)
    check_cmake(page, text)
    check_scenes(page, text)
    if page.name == "errors.md":
        check_messages(page, text)
    if page.name == "materials_by_name.md":
        check_materials(page, text)
print("\n".join(problems))
sys.exit(1 if problems else 0)
