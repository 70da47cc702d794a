#!/usr/bin/env python3
"""Fails, with their names, where headers of the kernel are included by no test.

usage: included_test.py [FOLDER...]

Every module has a test that includes it directly, so that it is tested by itself and not only through what uses it.
Without folders it checks those of CHECKED. Run by ctest as `included`; by hand, `included_test.py kernel/simd` lists
what stands in kernel/simd.
"""
import pathlib
import re
import sys

CHECKED = ["kernel/include", "kernel/reference", "kernel/simd", "kernel/src"]
# Folders that tests include from, and the longest first: a header goes by what is left of its path.
BASES = ["kernel/reference/include", "kernel/include", "kernel/src", "kernel"]

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def included_by_tests():
    """All that a test includes itself; what tests share in support does not count."""
    found = set()
    for path in (ROOT / "tests").rglob("*_test.cpp"):
        found.update(INCLUDE.findall(path.read_text()))
    return found


def include_name(path):
    name = path.relative_to(ROOT).as_posix()
    base = next(base for base in BASES if name.startswith(base + "/"))
    return name[len(base) + 1 :]


def main(folders):
    included = included_by_tests()
    headers = [path for folder in folders for path in sorted((ROOT / folder).rglob("*.hpp"))]
    if not headers:
        sys.exit(f"included_test.py: no headers in {', '.join(folders)}")
    missing = [path for path in headers if include_name(path) not in included]
    for path in missing:
        print(f"{path.relative_to(ROOT).as_posix()}: no test includes it")
    if not missing:
        print(f"a test includes each of {len(headers)} headers")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or CHECKED))
