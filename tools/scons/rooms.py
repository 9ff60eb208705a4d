"""Defines the rooms (modules) of the sources, the rooms that each may include, and the tests of each room of the
core."""

import os
import re

import programs

# Each room, and the rooms whose headers it includes. A room is listed after all rooms that it includes. Tests compare
# the sources, CONTRIBUTING.md and ARCHITECTURE.md with this table.
ROOMS = {
    "core/base": [],
    "core/sampling": ["core/base"],
    "core/terrain": ["core/base"],
    "core/surface": ["core/base", "core/sampling", "core/terrain"],
    "core/model": [],
    "core/rules": ["core/base", "core/terrain"],
    "core/rows": ["core/base", "core/sampling", "core/rules"],
    "core/placement": ["core/base", "core/sampling", "core/terrain", "core/surface", "core/rules", "core/rows"],
    "core/state": ["core/base", "core/sampling"],
    "core/query": ["core/base", "core/sampling", "core/rows", "core/placement", "core/state"],
    "core/near": ["core/base", "core/placement", "core/state", "core/query"],
    "core/streaming": ["core/base"],
    "core/drawing": ["core/base", "core/placement", "core/streaming"],
    "core/explain": ["core/base", "core/sampling", "core/terrain", "core/surface", "core/rules", "core/placement"],
    "core/impostor": ["core/base"],
    "core/heightmap": ["core/base", "core/terrain"],
    "core/c_api": ["core/base", "core/sampling"],
    "bindings": [],
    "nodes/common": ["core/base"],
    "nodes/impostor": ["core/impostor", "nodes/common"],
    "nodes/ground": ["core/base", "core/terrain", "core/heightmap", "nodes/common"],
    "nodes/sampler": ["core/base", "core/sampling", "core/surface", "nodes/common"],
    "nodes/model": ["core/base", "core/model", "core/near", "nodes/common"],
    "nodes/layer": [
        "core/base", "core/model", "core/rules", "core/rows", "core/placement", "core/state", "core/query", "core/streaming", "core/drawing",
        "nodes/common", "nodes/model",
    ],
    "nodes/biome": ["core/rules", "nodes/common", "nodes/ground", "nodes/layer"],
    "nodes/region": ["core/base", "core/rules", "nodes/common", "nodes/layer"],
    "nodes/gameplay": ["core/base", "core/placement", "core/state", "core/query", "core/near", "nodes/common", "nodes/model", "nodes/layer"],
    "nodes/workers": [
        "core/base", "core/sampling", "core/terrain", "core/placement", "core/state", "core/near", "core/streaming",
        "nodes/common", "nodes/ground", "nodes/layer",
    ],
    "nodes/drawing": [
        "core/base", "core/placement", "core/near", "core/streaming", "core/drawing",
        "nodes/common", "nodes/model", "nodes/layer", "nodes/workers",
    ],
    "nodes/explain": ["core/sampling", "core/explain", "nodes/common", "nodes/ground", "nodes/layer", "nodes/workers"],
    "nodes/scatter": [
        "core/base", "core/terrain", "core/rules", "core/rows", "core/placement", "core/near", "core/streaming", "core/explain",
        "nodes/common", "nodes/ground", "nodes/layer", "nodes/biome", "nodes/region", "nodes/gameplay",
        "nodes/workers", "nodes/drawing", "nodes/explain",
    ],
    "nodes": ["nodes"],  # This part registers the classes of all rooms.
}  # fmt: skip
CORE = [room for room in ROOMS if room.startswith("core/")]
NODES = [room for room in ROOMS if room.split("/")[0] == "nodes"]

# Subfolders of rooms that have separate tests.
PARTS = {"core/domain": "core/sampling/domain"}
TESTED = ["core/base", "core/sampling", *PARTS, *CORE[2:]]

TESTS = "tests/core"
PREFIX = "core_tests_"
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def sources(root, room):
    """Returns the sources of a room, relative to root, sorted by name. "nodes" has only the sources that are not in any
    other room."""
    pattern = "extension/%s/" % room + ("*.cpp" if room == "nodes" else "**/*.cpp")
    return programs.find(root, [pattern])


def reached_from(room):
    """Returns the rooms that a room includes, directly or indirectly, in the order of the table."""
    found, left = set(), [room]
    while left:
        new = set(ROOMS.get(left.pop(), [])) - found
        found |= new
        left += new
    return [each for each in ROOMS if each in found]


def requested(targets):
    """Returns the targets that are test programs of a single room: core_tests_rules, core_tests_query, ..."""
    return [name for name in targets if name.startswith(PREFIX)]


def tests_of(root, name):
    """Returns the sources of the program core_tests_ROOM, and the rooms of the core to link it with. A test belongs to
    the last room that it includes, directly or through its fixtures."""
    wanted = "core/" + name[len(PREFIX) :]
    if wanted not in TESTED:
        raise SystemExit("thicket: %s: no such room; the rooms are %s" % (name, ", ".join(room[5:] for room in TESTED)))
    files, needed = [], set()
    for file in sorted(os.listdir(os.path.join(root, TESTS))):
        if not file.endswith(".cpp"):
            continue
        path = TESTS + "/" + file
        included = rooms_included(root, path, set())
        # Files without tests, such as the one with the main function, are part of every program.
        if not file.startswith("test_") or max(included, key=TESTED.index, default="") == wanted:
            files.append(path)
            needed |= included
    needed.update(os.path.dirname(PARTS[part]) for part in PARTS if part in needed)
    needed.update(*(reached_from(room) for room in needed))
    return files, [room for room in CORE if room in needed]


def rooms_included(root, path, seen):
    """Returns the rooms of the core that a test file includes, directly or through other test files."""
    found = set()
    seen.add(path)
    with open(os.path.join(root, path), encoding="utf-8") as file:
        names = INCLUDE.findall(file.read())
    for name in names:
        room = next((part for part, folder in PARTS.items() if name.startswith(folder)), "/".join(name.split("/")[:2]))
        if room in TESTED:
            found.add(room)
            continue
        for folder in (os.path.dirname(path), "."):
            other = os.path.normpath(os.path.join(folder, name))
            if other not in seen and os.path.isfile(os.path.join(root, other)):
                found |= rooms_included(root, other, seen)
    return found
