"""Failing allocations inside the engine: the library must report each, leave its data unchanged and continue.

tests/allocations/failing_allocations.c, preloaded into the engine, makes allocations fail. Most failures of small allocations
crash Godot itself, because it writes through the null pointer. The library cannot prevent that, so each crash is attributed by
its location. The library is responsible if its code crashed or if an exception escaped from it. It is also responsible if the
engine crashed in a call other than the one whose allocation failed.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from conftest import REPO, new_project, run
from test_engine import ENGINE, assert_passed

LIBRARY = "libthicket"
# Libraries whose crashes and allocations are attributed to their callers.
SERVANTS = re.compile(r"/(?:libc|libm|libstdc\+\+|libgcc_s|ld-linux[\w-]*|libfailing_allocations)[\d.-]*\.so")
NODES = REPO / "extension/nodes"
THREADLESS = "[threading]\nworker_pool/max_threads=0\n"


@pytest.fixture(scope="module")
def preload(tmp_path_factory) -> Path:
    """Builds the library to preload and returns its path."""
    built = tmp_path_factory.mktemp("preload") / "libfailing_allocations.so"
    source = REPO / "tests/allocations/failing_allocations.c"
    completed = run([os.environ.get("CC", "cc"), "-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o", built, source], timeout=60)
    assert completed.returncode == 0, completed.stderr
    return built


@dataclass
class Frame:
    module: str
    offset: int

    @property
    def ours(self) -> bool:
        return LIBRARY in self.module

    def __str__(self) -> str:
        if not self.ours:
            return "%s+0x%x" % (Path(self.module).name, self.offset)
        named = subprocess.run(["addr2line", "-fCe", self.module, hex(self.offset - 1)], capture_output=True, text=True, check=False)
        return named.stdout.split("\n")[0]


@dataclass
class Outcome:
    """The result of a process in which one allocation failed."""

    number: int
    log: str
    sections: dict[str, list[Frame]] = field(default_factory=dict)
    end: str = ""  # "end", "crash" or "hang". Empty if the process ended in another way.

    @classmethod
    def read(cls, path: Path) -> Outcome:
        outcome = cls(int(path.stem), path.with_suffix(".log").read_text(errors="replace"))
        section = ""
        for line in path.read_text().splitlines():
            if line.startswith("\t"):
                module, offset = line.split()
                if not SERVANTS.search(module):
                    outcome.sections[section].append(Frame(module, int(offset, 16)))
            else:
                section = line.split()[0]
                outcome.sections[section] = []
                outcome.end = section if section != "failed" else outcome.end
        return outcome

    def call_into_the_engine(self, section: str) -> Frame | None:
        """Returns the library's innermost frame in a section, or None."""
        return next((frame for frame in self.sections.get(section, []) if frame.ours), None)

    @property
    def kind(self) -> str:
        if self.end == "end":
            return "went on"
        if self.end == "crash":
            # If the engine tail-called the C library, the engine's frame is not on the stack, so compare the library's frames
            # instead.
            engine_allocated = not self.sections["failed"][0].ours
            same_call = self.call_into_the_engine("crash") == self.call_into_the_engine("failed")
            return "the engine's" if engine_allocated and same_call else "ours"
        # The C library terminates the program if it cannot allocate the library's thread-local data.
        return "the system's" if not self.end and "thread-local data" in self.log else "ours"

    def __str__(self) -> str:
        texts = ["allocation %d: %s" % (self.number, self.end or "ended")]
        for section, frames in self.sections.items():
            texts += ["  " + section, *("    %s" % frame for frame in frames[:12])]
        return "\n".join([*texts, self.log[-800:]])


def sweep(godot, preload: Path, folder: Path, scene: str, first: int, last: int, step: int) -> list[Outcome]:
    """Runs a scene once for each allocation of a range, with that allocation failing. The processes are forked where the scene starts."""
    (folder / "project").mkdir()
    (folder / "outcomes").mkdir()
    project = new_project(folder / "project", THREADLESS)
    jobs = min(os.cpu_count() or 1, 4)
    environment = {
        **os.environ, "LD_PRELOAD": str(preload), "THICKET_SWEEP": f"{first} {last} {step} {jobs}",
        "THICKET_SWEEP_FOLDER": str(folder / "outcomes"),
    }  # fmt: skip
    godot(["--path", project, "--script", ENGINE / f"{scene}.gd"], timeout=1800, env=environment)
    return [Outcome.read(path) for path in sorted((folder / "outcomes").glob("*.txt"), key=lambda path: int(path.stem))]


def check(outcomes: list[Outcome], least: int):
    kinds = Counter(outcome.kind for outcome in outcomes)
    print("allocations that failed: " + ", ".join("%d %s" % (count, kind) for kind, count in kinds.most_common()))
    assert len(outcomes) >= least
    ours = [outcome for outcome in outcomes if outcome.kind == "ours"]
    assert not ours, "%d of %d are caused by the library\n" % (len(ours), len(outcomes)) + "\n\n".join(map(str, ours[:10]))
    results = {outcome.number: re.findall(r"^result: (\d+)$", outcome.log, re.MULTILINE) for outcome in outcomes}
    assert len(results[0]) == 1, outcomes[0]
    silent = [outcome for outcome in outcomes if outcome.kind == "went on" and results[outcome.number] != results[0] and "ERROR" not in outcome.log]
    assert not silent, "%d failed silently\n" % len(silent) + "\n\n".join(map(str, silent[:10]))


ARRAY = r"(?:godot::)?(?:Packed\w+Array|TypedArray<[^;<>]+>|Array)"
DECLARED = re.compile(r"\b(%s|std::\w+<.+>|auto)\s*[&*]*\s+[&*]*(\w+)\b\s*[;={(,)]" % ARRAY)
GROWS = re.compile(r"(?<![\w:])((?:\w+(?:\.|->))*)(\w+)(?:\.|->)(?:resize|push_back|append|append_array|insert|fill|set)\(")
SENTENCES = "PackedStringArray"  # An array of messages. A missing message is harmless, because the engine has printed an error.


def unchecked(text: str, header: str, fields: set[str] = frozenset()) -> list[str]:
    """Returns the lines that grow an engine array or write to its elements without checking for failed allocations. `fields` contains the
    names of array members of objects."""
    members = {name: kind for kind, name in DECLARED.findall(header)}
    lines = []
    names = dict(members)
    for number, line in enumerate(text.splitlines(), 1):
        if "ptrw(" in line:
            lines.append("%d: %s" % (number, line.strip()))
        for owner, name in GROWS.findall(line):
            kind = "Array" if owner and name in fields else names.get(name, "") if not owner else ""
            if re.fullmatch(ARRAY, kind) and SENTENCES not in kind:
                lines.append("%d: %s" % (number, line.strip()))
        if line.startswith("}"):
            names = dict(members)
        for kind, name in DECLARED.findall(line):
            names[name] = kind
    return lines


def test_arrays_of_the_engine_grow_only_through_one_function():
    headers = "".join(path.read_text() for path in NODES.parent.rglob("*.hpp"))
    fields = {name for kind, name in re.findall(r"\b(%s) (\w+);" % ARRAY, headers) if SENTENCES not in kind}
    fields -= set(re.findall(r"\bstd::vector<.+> (\w+);", headers))
    found = []
    for path in sorted(NODES.rglob("*.[ch]pp")):
        header = path.with_suffix(".hpp")
        if path.name != "engine_arrays.hpp":
            lines = unchecked(path.read_text(), header.read_text() if header.is_file() else "", fields)
            found += ["%s:%s" % (path.relative_to(REPO), line) for line in lines]
    assert not found, "use nodes/common/engine_arrays.hpp:\n" + "\n".join(found)


def test_failing_large_allocations(godot, preload, tmp_path):
    """Large allocations fail in many kinds of calls, on all threads."""
    script = ENGINE / "test_allocations.gd"
    assert_passed(godot(["--verbose", "--path", new_project(tmp_path), "--script", script], timeout=600, env={**os.environ, "LD_PRELOAD": str(preload)}))


# The approximate number of allocations of each scene.
SCENES = {"allocation_scene": 8000, "allocation_grounds": 8500}


@pytest.mark.parametrize("scene", SCENES)
def test_some_allocations_of_a_scene_fail(godot, preload, tmp_path, scene):
    last = SCENES[scene]
    check(sweep(godot, preload, tmp_path, scene, 0, last, last // 50), 51)


@pytest.mark.full
@pytest.mark.parametrize("scene", SCENES)
def test_the_first_thousand_allocations_of_a_scene_fail(godot, preload, tmp_path, scene):
    check(sweep(godot, preload, tmp_path, scene, 0, 1000, 1), 1001)


@pytest.mark.full
@pytest.mark.parametrize("scene", SCENES)
def test_a_thousand_allocations_all_over_a_scene_fail(godot, preload, tmp_path, scene):
    last = SCENES[scene]
    check(sweep(godot, preload, tmp_path, scene, 0, last, last // 1000), 1000)
