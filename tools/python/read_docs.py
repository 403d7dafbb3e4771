"""What the headers say of every public declaration, by its name in Python.

read_docs.py HEADER... --cpp FILE writes it as the table that bindings/docs.h reads; --json FILE for the tests.
Comments that begin with /// stand before a declaration, those with ///< behind it. Overloads are counted from the
second on: Simulation.pin, Simulation.pin#2.
"""
import argparse
import json
import re
from pathlib import Path

SCOPE = re.compile(r"^(?:template <.*> )?(class|struct|enum class|enum|namespace)(?: MALLOW_EXPORT)? ([\w:]+)")
FUNCTION = re.compile(r"([\w~]+|operator\(\)|operator\[\]|operator=)\(")
FIELD = re.compile(r"(\w+)\s*(?:=[^;]*|\{[^;]*\})?;$")


def text_of(lines):
    """One paragraph for comments without empty lines between them; copies stay for resolve()."""
    paragraphs = [[]]
    for line in lines:
        if not line:
            paragraphs.append([])
        else:
            paragraphs[-1].append(line)
    return "\n\n".join(" ".join(paragraph) for paragraph in paragraphs if paragraph)


class Reader:
    def __init__(self):
        self.docs = {}

    def put(self, scopes, name, comment, kind):
        key = ".".join([scope for scope in scopes if scope] + [name])
        copied = re.match(r"@copydoc (\w+)", comment)
        if copied:
            source = ".".join([scope for scope in scopes if scope] + [copied.group(1)])
            comment = self.docs.get(source, {"text": comment})["text"]
        number = 2
        unique = key
        while unique in self.docs:
            if kind != "function":
                return
            unique = f"{key}#{number}"
            number += 1
        self.docs[unique] = {"text": comment, "kind": kind}

    def read(self, path):
        scopes, kinds, comment, statement, hidden = [], [], [], "", False
        behind = None  # the name whose ///< goes on
        depth = 0  # of braces in the body of a function
        for raw in Path(path).read_text().splitlines():
            line = raw.strip()
            if depth > 0:
                depth += line.count("{") - line.count("}")
                continue
            if line.startswith("///<"):
                if behind:
                    self.docs[behind]["text"] += " " + line[4:].strip()
                continue
            if line.startswith("///"):
                comment.append(line[3:].strip())
                continue
            if not line or line.startswith(("#", "//")):
                comment, behind = [], None
                continue
            code, _, trailing = line.partition("///<")
            code = re.sub(r"\s*//.*$", "", code).strip()
            trailing = trailing.strip()
            if behind and not trailing:
                behind = None
            if code in ("public:", "private:"):
                hidden = code == "private:"
                continue
            if code.startswith("};") or code == "}":
                if statement.endswith("{"):
                    statement = ""
                if scopes:
                    scopes.pop()
                    kinds.pop()
                    hidden = False
                comment = []
                continue
            statement = (statement + " " + code).strip()
            scope = SCOPE.match(statement)
            in_enum = bool(kinds) and kinds[-1] == "enum"
            if scope and statement.endswith("{"):
                kind = scope.group(1).split()[0]
                name = "" if kind == "namespace" and scope.group(2) == "mallow" else scope.group(2).split("::")[-1]
                if kind != "namespace" and not hidden:
                    self.put(scopes, name, text_of(comment), kind)
                scopes.append(name)
                kinds.append(kind)
                hidden, comment, statement = False, [], ""
                continue
            if in_enum:
                if code.endswith("{"):
                    continue
                for value in re.findall(r"(\w+)\s*(?:=\s*\w+)?,?", code):
                    self.put(scopes, value, trailing or text_of(comment), "value")
                    behind = ".".join([s for s in scopes if s] + [value])
                comment, statement = [], ""
                continue
            opens = statement.count("{") - statement.count("}")
            if not statement.endswith((";", "}")) and not (statement.endswith("{") and opens > 0):
                continue
            if opens > 0 and not re.search(r"\) (const )?(noexcept )?(: .*)?\{", statement):
                if not statement.startswith("template"):
                    continue
            self.declare(scopes, statement, trailing, text_of(comment), hidden)
            if not hidden and trailing and self.last:
                behind = self.last
            if opens > 0:  # the body of a function: to be passed over
                depth = opens
            comment, statement = [], ""

    last = None

    def declare(self, scopes, statement, trailing, comment, hidden):
        self.last = None
        if hidden or statement.startswith(("using", "friend", "static_assert")):
            return
        declared = SCOPE.match(statement)
        if declared:
            whole = re.search(r"\{(.*)\};$", statement)
            if whole and comment:
                self.put(scopes, declared.group(2), comment, "enum")
                for value in re.findall(r"\w+", whole.group(1)):
                    self.put([*scopes, declared.group(2)], value, comment, "value")
            return  # else of another header
        statement = re.sub(r"^template <[^>]*> ", "", statement)
        plain = re.sub(r"<[^<>]*(?:<[^<>]*>[^<>]*)*>", "", statement)
        function = FUNCTION.search(re.sub(r"=[^,;)]*", "", plain) if "(" in plain.split("=")[0] else "")
        if function:
            name = function.group(1)
            if name.startswith(("~", "operator")) or (scopes and name == scopes[-1]):
                name = "__init__" if scopes and name == scopes[-1] else None
                if not name:
                    return
            kind = "function"
        else:
            field = FIELD.search(plain)
            if not field:
                return
            name, kind = field.group(1), "field"
            if name.startswith(("k_", "operator")) or name.endswith("_"):
                return
            # several in one declaration
            declared = re.sub(r"\{[^{}]*\}|\([^()]*\)", "", plain)
            for other in re.findall(r"(\w+)(?: = [^,;]*)?[,;]", declared):
                if other != name:
                    self.put(scopes, other, trailing or comment, kind)
        self.put(scopes, name, trailing or comment, kind)
        self.last = ".".join([s for s in scopes if s] + [name])


def raw(text):
    """A literal of C++; long ones in pieces, as compilers bound them."""
    return "".join(f'R"~({text[at:at + 8000]})~"' for at in range(0, max(len(text), 1), 8000))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("headers", nargs="+")
    parser.add_argument("--cpp")
    parser.add_argument("--json")
    options = parser.parse_args()
    reader = Reader()
    for header in options.headers:
        reader.read(header)
    if options.json:
        Path(options.json).write_text(json.dumps(reader.docs, indent=1, ensure_ascii=False))
    if options.cpp:
        rows = "\n".join(f'    {{"{key}", {raw(entry["text"])}}},' for key, entry in sorted(reader.docs.items()))
        Path(options.cpp).write_text(
            '#include "docs.h"\n\nnamespace mallow::python {\n\nstd::span<const Doc> docs() {\n'
            f"  static constexpr Doc k_docs[] = {{\n{rows}\n  }};\n  return k_docs;\n}}\n\n}}  // namespace mallow::python\n")


if __name__ == "__main__":
    main()
