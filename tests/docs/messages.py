"""The messages of errors, as the sources have them: what each place that throws or collects one says."""
import pathlib
import re

CALL = re.compile(r"\b(?:ConfigError|IoError|StepError|RunFailure|BusyError|(?:py::)?(?:type|value)_error"
                  r"|\w*(?:checks?|problems?|warnings?|list|notes)\w*\.(?:add|push_back|emplace_back)|problem|fail|refuse|bad)\s*[({]")
STREAM = re.compile(r'\btext <<(?:"(?:[^"\\]|\\.)*"|[^";])*')
PARTS = re.compile(r'"((?:[^"\\]|\\.)*)"')
# What fails only where a file was damaged on purpose, or a programmer of the engine erred.
FOLDERS = ("engine", "tools")


def end_of(text, at):
    """Behind the bracket that closes the one before `at`."""
    depth = 1
    while depth and at < len(text):
        if text[at] in "\"'":
            quote = text[at]
            at += 1
            while at < len(text) and text[at] != quote:
                at += 2 if text[at] == "\\" else 1
        elif text[at] in "({[":
            depth += 1
        elif text[at] in ")}]":
            depth -= 1
        at += 1
    return at


def said(code):
    """What a piece of code says, with … for what it puts in."""
    words = [part for part in PARTS.findall(code)]
    return "…".join(words).replace('\\"', '"').replace("\\\\", "\\")


def messages(source):
    """(file, line, text) of every message: of all that has words in it."""
    found = []
    for folder in FOLDERS:
        for file in sorted((source / folder).rglob("*")):
            if file.suffix not in (".cpp", ".h"):
                continue
            text = file.read_text()
            joined = re.sub(r'"[ \t]*\n\s*"', "", text)
            for match in [*CALL.finditer(joined), *STREAM.finditer(joined)]:
                if match[0].startswith("text"):
                    code = match[0]
                else:
                    code = joined[match.end():end_of(joined, match.end())]
                    if re.search(r"[({]\s*$", code):
                        continue
                text_of = said(code)
                if re.search(r"[a-z]{2,} [a-z]", text_of) and not text_of.startswith(";"):  # which goes on with one
                    found.append((str(file.relative_to(source)), joined.count("\n", 0, match.start()) + 1, text_of))
    return found


if __name__ == "__main__":
    import sys
    for file, line, text in messages(pathlib.Path(sys.argv[1])):
        print(f"{file}:{line}: {text}")
