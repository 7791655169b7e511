#!/usr/bin/env python3
"""Checks that every source file includes its own header before anything else, which proves that the header stands alone,
and that every header is guarded: by #pragma once, or by Highway's toggle where it is compiled once for each instruction set.

usage: check_own_headers.py [ROOT]      prints one line per violation; exit status 1 when there is one
"""
import re
import sys
from pathlib import Path

FOLDERS = ("engine", "server")
FIRST_INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)', re.MULTILINE)

GUARD = re.compile(r"^#pragma once$|^#if defined\(\w+_H\) == defined\(HWY_TARGET_TOGGLE\)$", re.MULTILINE)


def violations(root):
    for header in sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.h")):
        name = header.relative_to(root).as_posix()
        if not GUARD.search(header.read_text()):
            yield f"{name}: is not guarded"
        source = header.with_suffix(".cpp")
        if not source.exists():
            continue
        first = FIRST_INCLUDE.search(source.read_text())
        if first is None or first.group(1) != name:
            yield f"{source.relative_to(root).as_posix()}: includes {first and first.group(1)} before its own header"


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    found = list(violations(root))
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
