#!/usr/bin/env python3
"""Makes what Markdown pages link to and show work in the pages that Doxygen made of them: relink.py SOURCE HTML.

Doxygen leaves links to files of the repository as they are in the page, relative to where that lies. Pictures are
copied beside the pages, other files are linked to where they are. Ends with 1 where one is nowhere.
"""
import os
import re
import shutil
import sys
import urllib.parse
from pathlib import Path

ELSEWHERE = re.compile(r"^(https?:|mailto:|javascript:|data:|#)")
LINK = re.compile(r'(?P<key>\b(?:href|src|data))="(?P<to>[^"]+)"')
PICTURES = {".jpg", ".png", ".svg", ".webp", ".gif"}


def pages_by_name(source):
    """The Markdown file that each page was made of, by the name that Doxygen gives the page."""
    pages = {"index.html": source / "README.md"}
    for folder in (".", ".github", "bench", "engine", "tests", "tools/docs", "tools/python"):
        for path in (source / folder).glob("*.md"):
            name = re.sub(r"[/.]", "_", str(path.relative_to(source).with_suffix("")))
            pages[f"md_{name}.html"] = path
    return pages


def relink(page, made_of, source, html):
    missing = []

    def link(match):
        to, hash_mark, anchor = match["to"].partition("#")
        name = urllib.parse.unquote(to)
        if ELSEWHERE.match(match["to"]) or (html / name).exists():
            return match[0]
        found = Path(os.path.normpath(made_of.parent / name))
        if not found.exists():
            missing.append(f"{page.name}: {match['to']}")
            return match[0]
        if found.suffix in PICTURES:
            there = Path("pictures") / found.relative_to(source)
            (html / there).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(found, html / there)
        else:
            there = os.path.relpath(found, html)
        return f'{match["key"]}="{urllib.parse.quote(str(there))}{hash_mark}{anchor}"'

    text = page.read_text(encoding="utf-8")
    linked = LINK.sub(link, text)
    if linked != text:
        page.write_text(linked, encoding="utf-8")
    return missing


def main(source, html):
    missing = []
    for name, made_of in sorted(pages_by_name(source).items()):
        if (html / name).exists():
            missing += relink(html / name, made_of, source, html)
    for one in missing:
        print(f"no such file: {one}", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()))
