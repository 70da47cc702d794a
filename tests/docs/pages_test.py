"""Checks the project's pages: links point to what is there, sentences are short, and so is the first page.

    python3 tests/docs/pages_test.py [ROOT]

A page is every Markdown file but those that bench/run writes. Sentences of doc comments in public headers are
checked, too. Exit status 1 if a page or a header breaks a rule.
"""

import pathlib
import re
import sys

MOST_WORDS_OF_A_SENTENCE = 30
MOST_WORDS_OF_README = 900
# Folders whose files pages may name in `code`; what they name must exist.
ROOMS = ("kernel/", "layouts/", "tests/", "bench/", "tools/", ".ci/")
# A full stop after these does not end a sentence.
ABBREVIATIONS = ("eq.", "fig.", "vs.", "e.g.", "i.e.", "cf.")


def pages(root):
    for path in sorted(root.rglob("*.md")):
        parts = path.relative_to(root).parts
        written_by_bench = parts[:2] == ("bench", "results") and len(parts) > 3
        if not written_by_bench and not any(p.startswith(("build", ".git", "out")) for p in parts[:-1]):
            yield path


def without_code(text):
    """The text with fenced blocks blanked, so that line numbers stay."""
    return re.sub(r"^```.*?^```", lambda m: "\n" * m.group().count("\n"), text, flags=re.M | re.S)


def slug(heading):
    """The anchor that a heading gets on the usual forges."""
    heading = re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading.strip().lower())
    return re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")


def anchors(path):
    return {slug(h) for h in re.findall(r"^#+ (.*)$", without_code(path.read_text()), flags=re.M)}


def broken_links(root, page, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text)):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        if not path.exists():
            yield f"links to {target}, which is not there"
        elif anchor and path.suffix == ".md" and anchor not in anchors(path):
            yield f"links to {target}, a heading that is not there"
    for name in re.findall(r"`([^`\s]+)`", without_code(text)):
        if name.startswith(ROOMS) and not any(c in name for c in "<{") and not list(root.glob(name.rstrip("/"))):
            yield f"names `{name}`, which is not there"


def blocks(text):
    """Paragraphs, list items and table cells, each with the line it starts on, without marks."""
    block, start = [], 1
    lines = without_code(text).split("\n") + [""]
    for number, line in enumerate(lines, 1):
        is_item = re.match(r"\s*([-*]|\d+\.) ", line)
        is_table = line.lstrip().startswith("|")
        if not line.strip() or is_item or is_table or line.startswith("#"):
            if block:
                yield start, " ".join(block)
            block = []
        if is_table:
            for cell in line.strip().strip("|").split("|"):
                yield number, cell
        elif line.strip() and not line.startswith("#"):
            if not block:
                start = number
            block.append(re.sub(r"^\s*([-*]|\d+\.) ", "", line).strip())


def plain(text):
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "code", text)
    return re.sub(r"[*_]{1,2}", "", text)


def sentences(text):
    sentence = []
    for word in plain(text).split():
        sentence.append(word)
        if re.search(r"[.!?][)\"”]*$", word) and word.lower() not in ABBREVIATIONS:
            yield sentence
            sentence = []
    if sentence:
        yield sentence


def long_sentences(text):
    for line, block in blocks(text):
        for sentence in sentences(block):
            words = sum(any(c.isalnum() for c in word) for word in sentence)
            if words > MOST_WORDS_OF_A_SENTENCE:
                yield line, f"a sentence of {words} words: {' '.join(sentence[:8])} ..."


def doc_comments(text):
    """The header with its /// comments as paragraphs and everything else blanked, so that line numbers stay."""
    lines = []
    for line in text.split("\n"):
        whole, trailing = re.match(r"\s*///(?!<)(.*)", line), re.search(r"///<(.*)", line)
        if whole:
            said = whole.group(1)
            is_code = said.startswith("     ") or said.strip().startswith("@")
            lines.append("" if is_code else said.strip())
        elif trailing:
            lines.append("- " + trailing.group(1).strip())  # a block of its own
        else:
            lines.append("")
    return "\n".join(lines)


def headers(root):
    return [header for room in ("kernel", "kernel/reference", "layouts")
            for header in sorted((root / room / "include").rglob("*.hpp"))]


def check(root):
    complaints = []
    for page in pages(root):
        name, text = page.relative_to(root), page.read_text()
        complaints += [f"{name} {complaint}" for complaint in broken_links(root, page, text)]
        complaints += [f"{name}:{line}: {complaint}" for line, complaint in long_sentences(text)]
    for header in headers(root):
        found = long_sentences(doc_comments(header.read_text()))
        complaints += [f"{header.relative_to(root)}:{line}: {complaint}" for line, complaint in found]
    words = len((root / "README.md").read_text().split())
    if words > MOST_WORDS_OF_README:
        complaints.append(f"README.md has {words} words; it may have {MOST_WORDS_OF_README}")
    return complaints


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__ + "/../../..").resolve()
    found = list(pages(root))
    if root / "README.md" not in found:
        print(f"no README.md under {root}", file=sys.stderr)
        return 2
    complaints = check(root)
    print("\n".join(complaints) or f"{len(found)} pages and {len(headers(root))} headers are as they should be")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
