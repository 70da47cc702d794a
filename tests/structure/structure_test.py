#!/usr/bin/env python3
"""Fails, with file and number, where the tree outgrows its limits, or the kernel calls what rounds otherwise elsewhere.

usage: structure_test.py [FOLDER...]

Without folders it checks those of CHECKED. Run by ctest as `structure`; by hand, `structure_test.py kernel` lists
what stands in kernel.
"""
import collections
import pathlib
import re
import sys

MOST_FILES = 15  # in a folder; README.md and CMakeLists.txt count, folders do not
MOST_LINES = 400  # in a C++ file
MOST_FUNCTION_LINES = 60  # head and body
MOST_PARAMETERS = 6
MOST_EQUAL_LINES = 6  # in a row, twice in a folder of UNIQUE; blank lines, braces and comments are not counted

# Tests are left out: a folder there is a kind of test, with a file for each thing tested.
CHECKED = ["bench", "kernel", "layouts", "tools"]
UNIQUE = ["kernel"]
# Bits are promised to be the same on every machine there. Square roots are; what else libraries round is not.
SAME_BITS = ["kernel/include", "kernel/simd", "kernel/src", "layouts"]
ROUNDED = re.compile(
    r"std::(a?sin|a?cos|a?tan|atan2|[sct]..?h|exp2?|expm1|log|log2|log10|log1p|pow|cbrt|hypot|[tl]gamma|erfc?)\("
)
# All files of the top level, but for hidden ones.
TOP_FILES = {"CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md"}
# Folders of measured results, which grow with every machine.
DATA = ["bench/results"]

ROOT = pathlib.Path(__file__).resolve().parents[2]
CPP = {".cpp", ".hpp"}


def files_below(folder):
    """All files, but for hidden ones and Python's own."""
    for path in sorted((ROOT / folder).rglob("*")):
        parts = path.relative_to(ROOT).parts
        if path.is_file() and not any(part.startswith((".", "__")) for part in parts):
            yield path


def name(path):
    return path.relative_to(ROOT).as_posix()


def is_data(folder):
    return any(folder == data or folder.startswith(data + "/") for data in DATA)


TOKEN = re.compile(
    r"""//[^\n]*|/\*.*?\*/"""
    r"""|R"(?P<tag>[^(\s]*)\(.*?\)(?P=tag)\""""
    r"""|"(?:\\.|[^"\\\n])*\""""
    r"""|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'"""
    r"""|^[ \t]*\#(?:\\\n|[^\n])*""",
    re.DOTALL | re.MULTILINE,
)


def without_text(source):
    """The source without comments, literals and preprocessor lines, every line in its place."""
    return TOKEN.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), source)


def without_brackets(text):
    """The text without what stands between brackets of any kind, those of templates included."""
    previous = None
    while text != previous:
        previous = text
        text = re.sub(r"\([^()<>{}\[\]]*\)|\[[^()<>{}\[\]]*\]|\{[^()<>{}\[\]]*\}|<[^()<>{}\[\]]*>", " ", text)
    return text


def parameters_of(head):
    """How many parameters the function of a head has; none if it is no function's."""
    head = re.sub(r"operator\s*\(\s*\)", "operator_call", head)
    head = re.sub(r"->|<=>|<=|>=|<<=?|operator\s*[<>]", " ", head)
    opening = None
    angles = 0
    for i, c in enumerate(head):
        angles += (c == "<") - (c == ">")
        if c == "(" and angles <= 0:
            opening = i
            break
    if opening is None or "=" in head[:opening].replace("operator=", "") or not head[:opening].strip():
        return None
    depth = 0
    for end in range(opening, len(head)):
        depth += (head[end] == "(") - (head[end] == ")")
        if depth == 0:
            break
    inner = head[opening + 1 : end]
    if inner.strip() in ("", "void"):
        return 0
    return without_brackets(inner).count(",") + 1


def heads_of(source):
    """(line of a head, its text, line of the end of its body or none) for what stands outside functions."""
    text = without_text(source)
    scopes = []  # for each open brace: "scope", "body" with its head, or "other"
    parentheses = 0
    start = 0  # of the head that is being read
    i = 0
    while i < len(text):
        c = text[i]
        inside_function = any(kind != "scope" for kind, _ in scopes)
        if inside_function and c not in "{}":
            i += 1
            continue
        if c in "()":
            parentheses += (c == "(") - (c == ")")
        elif c == "{":
            head = text[start:i]
            if inside_function or parentheses > 0 or not text[i - 1].isspace():
                scopes.append(("other", start))  # an initialiser, or a block in a body
            elif re.match(r"\s*(?:template\s*<.*>\s*)?(?:inline\s+)?(?:namespace|class|struct|union|extern)\b", head, re.DOTALL):
                scopes.append(("scope", start))
                start = i + 1
            elif parameters_of(head) is not None:
                scopes.append(("body", start))
            else:
                scopes.append(("other", start))
        elif c == "}":
            kind, begin = scopes.pop()
            if kind == "body":
                head = text[begin : text.index("{", begin)]
                first = begin + len(head) - len(head.lstrip())
                yield text.count("\n", 0, first) + 1, text[begin:i].lstrip(), text.count("\n", 0, i) + 1
            if kind in ("body", "scope"):
                start = i + 1
        elif c == ";" and parentheses == 0:
            head = text[start:i]
            yield text.count("\n", 0, start + len(head) - len(head.lstrip())) + 1, head.strip(), None
            start = i + 1
        elif c == ":" and re.search(r"\b(?:public|private|protected)\s*$", text[start:i]):
            start = i + 1
        i += 1


def check_source(path, complain):
    source = path.read_text()
    lines = source.count("\n")
    if lines > MOST_LINES:
        complain(f"{name(path)}: {lines} lines, at most {MOST_LINES}")
    for line, head, end in heads_of(source):
        title = f"{name(path)}:{line}"
        if end is not None and end - line + 1 > MOST_FUNCTION_LINES:
            complain(f"{title}: a function of {end - line + 1} lines, at most {MOST_FUNCTION_LINES}")
        parameters = parameters_of(head)
        if parameters is not None and parameters > MOST_PARAMETERS:
            complain(f"{title}: a function of {parameters} parameters, at most {MOST_PARAMETERS}")


def check_includes(path, complain):
    for number, line in enumerate(path.read_text().split("\n"), 1):
        if re.match(r'\s*#\s*include\s*["<].*\.cpp[">]', line):
            complain(f"{name(path)}:{number}: a source file is included")


def check_bits(path, complain):
    if not any(name(path).startswith(folder + "/") for folder in SAME_BITS):
        return
    for number, line in enumerate(without_text(path.read_text()).split("\n"), 1):
        for found in ROUNDED.finditer(line):
            complain(f"{name(path)}:{number}: std::{found.group(1)} rounds otherwise elsewhere; see math/elementary.hpp")


def check_files(folder, complain):
    counts = collections.Counter(name(path.parent) for path in files_below(folder))
    for subfolder, count in sorted(counts.items()):
        if count > MOST_FILES and not is_data(subfolder):
            complain(f"{subfolder}: {count} files, at most {MOST_FILES}")


def check_top(complain):
    """Whatever a program left behind at the top level, where a commit of all would take it along."""
    for path in sorted(ROOT.iterdir()):
        if path.is_file() and not path.name.startswith(".") and path.name not in TOP_FILES:
            complain(f"{path.name}: no file of the top level")


def telling_lines(path):
    """(line number, line without blanks at its ends or twice) of what is not the same everywhere."""
    for number, line in enumerate(path.read_text().split("\n"), 1):
        line = " ".join(line.split())
        if len(line) > 3 and not line.startswith(("//", "#", "namespace", "using", "}  //", "} //")):
            yield number, line


def check_equal_lines(folder, complain):
    size = MOST_EQUAL_LINES + 1
    seen = {}
    for path in files_below(folder):
        if path.suffix not in CPP:
            continue
        lines = list(telling_lines(path))
        said_until = -1
        for i in range(len(lines) - size + 1):
            window = tuple(line for _, line in lines[i : i + size])
            here = (path, lines[i][0])
            other = seen.setdefault(window, here)
            if other == here or i <= said_until:
                continue
            said_until = i + size - 1
            complain(f"{name(path)}:{here[1]}: {size} lines and more that stand at {name(other[0])}:{other[1]} too")


def main(folders):
    complaints = []
    check_top(complaints.append)
    for folder in folders:
        if not (ROOT / folder).is_dir():
            sys.exit(f"structure_test.py: no folder {folder}")
        check_files(folder, complaints.append)
        for path in files_below(folder):
            if path.suffix in CPP:
                check_source(path, complaints.append)
                check_includes(path, complaints.append)
                check_bits(path, complaints.append)
        if folder.split("/")[0] in UNIQUE:
            check_equal_lines(folder, complaints.append)
    print("\n".join(complaints) if complaints else "within all limits: " + ", ".join(folders))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or CHECKED))
