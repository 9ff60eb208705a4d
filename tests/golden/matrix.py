"""The matrix of bit-identical results. Builds analysis/golden for several platforms, each with the compilers that exist
for it and at several optimization levels, and runs it. The program uses every instruction set of the processor. If the platform
differs from this machine, it runs in an emulator.

    bash tests/golden/matrix.sh                    prints it as a Markdown table; installs the required packages
    bash tests/golden/matrix.sh aarch64 wasm       only these platforms

tests/core/test_golden.py runs some of these cells. Compiled objects are cached in build/golden until their command or one
of their sources changes.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

REPO = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(Path(__file__).resolve().parent), str(REPO / "tools/scons")]

import emulators
import installed
import libraries
import rooms
import scu

HIGHWAY = Path(installed.highway_folder())
ZIG = Path(installed.zig_program())
BUILT = REPO / "build/golden"
GOLDEN = json.loads((REPO / "tests/golden/core.json").read_text(encoding="utf-8"))

# The rooms that determine the digests. Other rooms, such as streaming and drawing, do not affect instances. The room
# that takes the longest to compile is first.
ROOMS = ["sampling", "base", "terrain", "rules", "rows", "placement", "state", "query", "near", "surface"]
COMMON = ["-std=c++20", "-ffp-contract=off", "-DHWY_STATIC_DEFINE"]
# Release builds also treat warnings as errors, because -O3 reports different warnings than -O2.
RELEASE = ["-DNDEBUG", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]


@dataclass(frozen=True)
class Platform:
    name: str
    zig: str  # zig's name for the target, including the C library to link.
    emulator: str  # The name of the emulator, which emulators.py starts.
    gnu: str = ""  # The prefix of Debian's cross g++; "" if there is none.
    flags: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()  # Additional sources to compile.
    suffix: str = ""


PLATFORMS = [
    Platform("x86_64", "x86_64-linux-musl", "qemu"),
    # By default, 32-bit x86 uses the 80-bit x87 floating-point unit.
    Platform("i386", "x86-linux-musl", "qemu", "i686-linux-gnu-", ("-msse2", "-mfpmath=sse")),
    Platform("aarch64", "aarch64-linux-musl", "qemu", "aarch64-linux-gnu-"),
    Platform("riscv64", "riscv64-linux-musl", "qemu", "riscv64-linux-gnu-"),
    # This C++ library does not support exceptions. The program that computes the digests throws none.
    Platform("wasm", "wasm32-wasi", "node", "", ("-msimd128", "-fignore-exceptions"), ("tests/golden/no_exceptions.cpp",), ".wasm"),
    Platform("Windows", "x86_64-windows-gnu", "wine", suffix=".exe"),
]
NATIVE = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())

# The fused level permits fused multiply-add instructions. The other platforms always have them, or never.
LEVELS = {level: [level] for level in ("-O0", "-O1", "-O2", "-O3", "-Os")} | {"-O3 fused": ["-O3", "-march=x86-64-v3"]}
ZIG_LEVELS = LEVELS | {"-O3 fused": ["-O3", "-march=x86_64_v3"]}  # zig has its own processor names.


@dataclass(frozen=True)
class Cell:
    platform: Platform
    compiler: str  # The compiler's name: g++, clang++ or zig.
    level: str

    @property
    def name(self) -> str:
        return f"{self.platform.name} {self.compiler} {self.level}"

    @property
    def optimization(self) -> list[str]:
        return (ZIG_LEVELS if self.compiler == "zig" else LEVELS)[self.level]

    @property
    def native(self) -> bool:
        """Returns true if programs of this cell are for this machine's processor."""
        return self.platform.name == NATIVE

    @property
    def own(self) -> bool:
        """Returns true if the compiler belongs to this machine and uses the machine's include folders."""
        return self.native and self.compiler != "zig"


def cells() -> list[Cell]:
    """Returns all cells of the matrix."""
    matrix_cells = []
    for each in PLATFORMS:
        native = each.name == NATIVE
        # Without optimization, the program takes minutes even natively, which is too slow in qemu.
        lowest = "-O1" if any("qemu" in str(word) for word in emulators.command(each.emulator, each.name, NATIVE)) else "-O0"
        compilers = (["g++", "clang++"] if native else ["g++"] if each.gnu else []) + ["zig"]
        for compiler in compilers:
            levels = ["-O0", "-O1", "-O2", "-O3", "-Os"] if native and compiler != "zig" else [lowest, "-O2", "-O3"]
            levels += ["-O3 fused"] if each.name == "x86_64" else []
            matrix_cells += [Cell(each, compiler, level) for level in levels]
    return matrix_cells


@dataclass
class Outcome:
    """The result of building and running a cell."""

    digests: dict[str, str] = field(default_factory=dict)
    instruction_sets: list[str] = field(default_factory=list)  # The instruction sets that the program used, the best one first.
    absent: str = ""  # The reason why the cell cannot run here; "" if it can.
    failure: str = ""  # The error of a compiler or of the program; "" if there is none.

    @property
    def differing(self) -> list[str]:
        return [name for name in {**GOLDEN, **self.digests} if self.digests.get(name) != GOLDEN.get(name)]

    def text(self) -> str:
        if self.absent:
            return "unavailable"
        if self.failure:
            return "**failed**"
        return f"**{len(self.differing)} differ**" if self.differing else "same"


@cache
def header_folder() -> str:
    """Returns a folder with the headers of GLM, for compilers that must not find the other headers of the machine."""
    return libraries.copied_headers(str(REPO / "build/headers"))


def compiler_of(cell: Cell) -> tuple[list[str], str]:
    """Returns the compile command of a cell, and the reason why the compiler is unavailable. The reason is empty if the
    compiler is available."""
    if cell.compiler == "zig":
        return [str(ZIG), "c++", "-target", cell.platform.zig, "-fno-sanitize=undefined", "-g0"], "" if ZIG.is_file() else "zig is not installed"
    name = cell.compiler if cell.native else cell.platform.gnu + cell.compiler
    return [name], "" if shutil.which(name) else f"{name} is not installed"


def absence(cell: Cell) -> str:
    """Returns the reason why a cell cannot be built or run here. Empty if it can."""
    return compiler_of(cell)[1] or ("" if cell.own else emulators.absence(cell.platform.emulator, cell.platform.name, NATIVE))


def flags_of(cell: Cell) -> list[str]:
    release = RELEASE if cell.level.startswith("-O3") else []
    includes = ["-Iextension", "-I.", "-isystem", str(HIGHWAY), *([] if cell.own else ["-isystem", header_folder()])]
    return [*COMMON, *includes, *cell.platform.flags, *cell.optimization, *release]


@cache
def core_sources() -> list[Path]:
    """Returns the sources to compile, as for a packed library. Most of them are files that each include several sources
    of the core. Some sources must be compiled alone."""
    paths = []
    for room in ROOMS:
        for group in scu.groups(str(REPO), rooms.sources(str(REPO), f"core/{room}")):
            path = REPO / group[0] if len(group) == 1 else BUILT / "joined" / group[0].replace("/", "-")
            if len(group) > 1 and not (path.is_file() and path.read_text(encoding="utf-8") == scu.text_of(group)):
                path.parent.mkdir(parents=True, exist_ok=True)
                partial = path.with_suffix(f".{threading.get_ident()}")  # Several threads may write this file at the same time.
                partial.write_text(scu.text_of(group), encoding="utf-8")
                partial.replace(path)
            paths.append(path)
    return paths


def sources(cell: Cell) -> list[Path]:
    ours = [REPO / path for path in ("tests/analysis/golden.cpp", *cell.platform.sources)]
    return [*core_sources(), *ours, *(HIGHWAY / "hwy" / f"{name}.cc" for name in libraries.HIGHWAY_SOURCES)]


class Failed(Exception):
    pass


def call(command: list[str]) -> None:
    environment = {**os.environ, **installed.zig_environment(str(ZIG))}
    result = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=REPO, env=environment, check=False)
    if result.returncode != 0:
        raise Failed(f"{' '.join(command)}\n{result.stderr[-4000:]}")


@cache
def version_of(compiler: str) -> str:
    """Returns the output of `compiler --version`. Empty for zig, whose folder name contains the version."""
    return subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False).stdout if "zig" not in compiler else ""


def fingerprint(command: list[str], needed: list[Path]) -> str:
    """Returns a hash of everything that an object depends on."""
    digest = hashlib.sha256("\0".join([version_of(command[0]), *command]).encode())
    for path in needed:
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def compiled(cell: Cell, source: Path) -> Path:
    """Returns the object file of a source. Compiles it if any of its dependencies has changed."""
    foreign = source.suffix == ".cc"
    name = source.name if foreign else source.relative_to(REPO).as_posix()
    out = BUILT / re.sub(r"[ +]+", "_", cell.name) / name.replace("/", "-")
    made, known = out.with_suffix(".o"), out.with_suffix(".needed")
    # Highway's sources are third-party code, so they are compiled without warnings. They need the same instruction sets
    # as our sources.
    theirs = ["-w", "-include", "extension/core/base/instruction_sets.hpp"] if foreign else []
    command = [*compiler_of(cell)[0], *flags_of(cell), *theirs, "-c", str(source if foreign else name)]
    if made.is_file() and known.is_file():
        mark, *needed = known.read_text(encoding="utf-8").split("\n")
        if fingerprint(command, [REPO / path for path in needed]) == mark:
            return made
    made.parent.mkdir(parents=True, exist_ok=True)
    call([*command, "-MMD", "-MF", f"{made}.d", "-o", str(made)])
    rule = Path(f"{made}.d")
    needed = rule.read_text(encoding="utf-8").replace("\\\n", " ").split(": ", 1)[1].split()
    rule.unlink()
    mark = fingerprint(command, [REPO / path for path in needed])
    known.write_text("\n".join([mark, *needed]), encoding="utf-8")
    return made


def program_of(cell: Cell, pool: ThreadPoolExecutor) -> Path:
    """Builds the program `analysis/golden` of a cell. `pool` runs the compilers."""
    objects = list(pool.map(lambda source: compiled(cell, source), sources(cell)))
    program = objects[0].parent / f"golden{cell.platform.suffix}"
    if not program.is_file() or program.stat().st_mtime < max(each.stat().st_mtime for each in objects):
        static = [] if cell.own else ["-static"]
        linked = program.with_name(f"partial{cell.platform.suffix}")
        call([*compiler_of(cell)[0], *cell.optimization, *static, *map(str, objects), "-o", str(linked)])
        linked.replace(program)
    return program


def outcome_of(cell: Cell, pool: ThreadPoolExecutor) -> Outcome:
    """Builds and runs a cell."""
    reason = absence(cell)
    if reason:
        return Outcome(absent=reason)
    try:
        program = program_of(cell, pool)
        runner = [] if cell.own else emulators.command(cell.platform.emulator, cell.platform.name, NATIVE)
        result = subprocess.run(
            [*runner, program], capture_output=True, text=True, errors="replace", timeout=3600, env=emulators.environment(cell.platform.emulator), check=False
        )
    except (Failed, subprocess.TimeoutExpired) as failed:
        return Outcome(failure=str(failed))
    if result.returncode != 0:
        return Outcome(failure=f"{program} returned {result.returncode}\n{result.stdout[-1000:]}{result.stderr[-4000:]}")
    return Outcome(json.loads(result.stdout), re.findall(r"golden: (\S+) computed", result.stderr))


def table(outcomes: dict[Cell, Outcome]) -> str:
    """Returns a table with a row for each platform and compiler, and a column for each level."""
    lines = [
        f"| Platform | Compiler | {' | '.join(f'`{level}`' for level in LEVELS)} | Instruction sets |",
        "| --- | --- |" + " --- |" * (len(LEVELS) + 1),
    ]
    for row in dict.fromkeys((cell.platform, cell.compiler) for cell in outcomes):
        mine = {cell.level: outcome for cell, outcome in outcomes.items() if (cell.platform, cell.compiler) == row}
        seen = dict.fromkeys(name for outcome in mine.values() for name in outcome.instruction_sets)
        texts = [mine[level].text() if level in mine else "" for level in LEVELS]
        lines.append(f"| {row[0].name} | {row[1]} | {' | '.join(texts)} | {', '.join(seen)} |")
    together = hashlib.sha256(json.dumps(GOLDEN, sort_keys=True).encode()).hexdigest()[:16]
    lines += ["", f"same: all {len(GOLDEN)} digests of tests/golden/core.json, which together are `{together}`, on each instruction set."]
    reasons = {f"- {cell.platform.name} {cell.compiler}: {outcome.absent}" for cell, outcome in outcomes.items() if outcome.absent}
    return "\n".join(lines + sorted(reasons))


def main(names: list[str]) -> int:
    known = [each.name for each in PLATFORMS]
    if not set(names) <= set(known):
        print(f"no such platform: {' '.join(names)}; the platforms are {' '.join(known)}", file=sys.stderr)
        return 2
    wanted = [cell for cell in cells() if not names or cell.platform.name in names]
    outcomes: dict[Cell, Outcome] = {}
    with ThreadPoolExecutor(os.cpu_count()) as pool, ThreadPoolExecutor(os.cpu_count()) as runs:
        for cell, outcome in zip(wanted, runs.map(lambda cell: outcome_of(cell, pool), wanted), strict=True):
            outcomes[cell] = outcome
            print(f"{cell.name}: {outcome.text()} {outcome.absent}", file=sys.stderr)
            if outcome.failure or (outcome.differing and not outcome.absent):
                print(outcome.failure or "\n".join(outcome.differing), file=sys.stderr)
    print(table(outcomes))
    return int(any(outcome.failure or (outcome.differing and not outcome.absent) for outcome in outcomes.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
