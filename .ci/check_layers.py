#!/usr/bin/env python3
"""Checks every #include, and every ROOMS list of CMake, against .ci/layers.txt.

usage: check_layers.py [ROOT]      prints one line per violation; exit status 1 when there is one
"""
import re
import sys
from pathlib import Path

SOURCE_FOLDERS = ("engine", "server", "tests", "bench")
SUFFIXES = {".h", ".cpp", ".inc"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)
CMAKE_ROOM = re.compile(r"geosis_room\(\s*(\w+)([^)]*)\)", re.DOTALL)
CMAKE_KEYWORDS = {"SOURCES", "ROOMS", "LIBRARIES"}


class Layers:
    """rooms: room -> rooms it may include, in the file's order; excludes: folder -> refused <header> prefixes."""

    def __init__(self, text):
        self.rooms, self.excludes, self.mistakes = {}, {}, []
        for number, line in enumerate(text.splitlines(), 1):
            line = line.partition("#")[0].strip()
            if " excludes " in line:
                folder, _, prefixes = line.partition(" excludes ")
                self.excludes[folder] = tuple(prefixes.split())
            elif line:
                self._add_room(number, line)

    def _add_room(self, number, line):
        room, colon, allowed = line.partition(":")
        if not colon:
            self.mistakes.append(f".ci/layers.txt:{number}: neither a room nor an exclusion: {line}")
        for name in allowed.split():
            if name != "*" and name not in self.rooms:
                self.mistakes.append(f".ci/layers.txt:{number}: {room} names {name}, which is not written above it")
        self.rooms[room] = set(allowed.split())

    def room_of(self, path):
        """The most specific room that holds the path, or None."""
        inside = [room for room in self.rooms if path == room or path.startswith(room + "/")]
        return max(inside, key=len, default=None)

    def allows(self, room, target):
        if target == room or target in self.rooms[room]:
            return True
        is_product = target.split("/")[0] not in ("tests", "bench")
        return "*" in self.rooms[room] and is_product

    def refuses_header(self, path, header):
        return any(path.startswith(folder + "/") and header.startswith(prefix)
                   for folder, prefixes in self.excludes.items() for prefix in prefixes)


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def check_includes(root, layers):
    for folder in SOURCE_FOLDERS:
        for file in sorted(root.joinpath(folder).rglob("*")):
            if file.suffix not in SUFFIXES:
                continue
            path = file.relative_to(root).as_posix()
            room = layers.room_of(path)
            if room is None:
                yield f"{path}: in no room of .ci/layers.txt"
                continue
            for quoted, system in INCLUDE.findall(without_comments(file.read_text(encoding="utf-8"))):
                problem = check_quoted(root, layers, room, quoted) if quoted else check_system(layers, path, system)
                if problem:
                    yield f"{path}: {problem}"


def check_quoted(root, layers, room, header):
    if not root.joinpath(header).is_file():
        return f'"{header}" is no file below the repository root, the only include root'
    target = layers.room_of(header)
    if target is None or not layers.allows(room, target):
        return f'{room} must not include "{header}"'
    return None


def check_system(layers, path, header):
    if header.split("/")[0] in SOURCE_FOLDERS:
        return f"<{header}> is ours: include it in quotes"
    if layers.refuses_header(path, header):
        return f"must not include <{header}>"
    return None


def check_cmake(root, layers):
    """A target must not link a room whose headers it must not include."""
    by_name = {room.split("/")[-1]: room for room in layers.rooms}
    for file in sorted(root.glob("*/**/CMakeLists.txt")):
        path = file.relative_to(root).as_posix()
        if path.split("/")[0] not in ("engine", "server"):
            continue
        for name, arguments in CMAKE_ROOM.findall(file.read_text(encoding="utf-8")):
            for linked in words_after("ROOMS", arguments.split()):
                if name not in by_name or linked not in by_name:
                    yield f"{path}: {name} or {linked} is no room of .ci/layers.txt"
                elif not layers.allows(by_name[name], by_name[linked]):
                    yield f"{path}: {name} must not link {linked}"


def words_after(keyword, words):
    collecting = False
    for word in words:
        if word in CMAKE_KEYWORDS:
            collecting = word == keyword
        elif collecting:
            yield word


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent)
    layers = Layers(root.joinpath(".ci/layers.txt").read_text(encoding="utf-8"))
    problems = [*layers.mistakes, *check_includes(root, layers), *check_cmake(root, layers)]
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
