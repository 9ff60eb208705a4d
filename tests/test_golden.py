"""The same bits on every instruction set, optimization level and compiler: the program `analysis/golden` computes its
digests on all instruction sets of this processor, and is built here once more with other compilers and levels.

tests/golden/core.json changes only when the law of the sets or the placement is changed on purpose. Then:
    scons tests && build/<config>/analysis/golden > tests/golden/core.json
and the commit says why: every world that was made before changes with it."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest
from conftest import ARCH, REPO, run

GOLDEN = json.loads((REPO / "tests/golden/core.json").read_text(encoding="utf-8"))
FLAGS = ["-std=c++20", "-ffp-contract=off", "-pthread", "-Iextension", "-I."]
# The build itself has -O2 and, for releases, -O3. Processors with fused multiply-add offer a temptation.
FUSED = ["-march=x86-64-v3"] if ARCH == "x86_64" else []
VARIANTS = [("g++", ["-O0"]), ("g++", ["-O3", *FUSED]), ("clang++", ["-O1"]), ("clang++", ["-O3", *FUSED])]
# The rest of the matrix.
MORE_VARIANTS = [(compiler, [level]) for compiler in ("g++", "clang++") for level in ("-O0", "-O1", "-O2", "-O3", "-Os")]
MORE_VARIANTS = [variant for variant in MORE_VARIANTS if variant not in VARIANTS]


def compare(printed: str):
    assert json.loads(printed) == GOLDEN


def test_digests_of_every_instruction_set(core_tool):
    done = core_tool("analysis/golden")
    assert done.returncode == 0, done.stderr
    compare(done.stdout)


ROOMS = ["base", "sampling", "terrain", "rules", "placement"]


def sources() -> list[Path]:
    """The rooms that the digests come from; streaming decides nothing that is drawn."""
    rooms = [path for room in ROOMS for path in sorted((REPO / "extension/core" / room).rglob("*.cpp"))]
    return [*rooms, REPO / "tests/analysis/golden.cpp"]


def fingerprint(command: list[str]) -> str:
    """Changes with everything that the program is made of."""
    digest = hashlib.sha256("\0".join(command).encode())
    folders = [REPO / "extension/core", REPO / "tests/analysis", REPO / "tests/bench/common"]
    for path in sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in (".cpp", ".hpp", ".inc")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def build(compiler: str, flags: list[str]) -> Path:
    """The program `analysis/golden` from this compiler; kept until one of its sources changes."""
    command = [compiler, *FLAGS, *flags, *(path.relative_to(REPO).as_posix() for path in sources())]
    program = REPO / "build" / "golden" / f"{compiler}{''.join(flags)}-{fingerprint(command)}"
    if not program.is_file():
        program.parent.mkdir(parents=True, exist_ok=True)
        for older in program.parent.glob(f"{compiler}{''.join(flags)}-*"):
            older.unlink()
        built = run([*command, "-lhwy", "-o", program], timeout=900, cwd=REPO)
        assert built.returncode == 0, built.stderr
    return program


@pytest.fixture(scope="module")
def builds() -> Iterator[dict[str, Future[Path]]]:
    """All variants of a plain run, a compiler on each core: they take minutes."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        there = [variant for variant in VARIANTS if shutil.which(variant[0])]
        yield {str(variant): pool.submit(build, *variant) for variant in there}


def name_of(variant: tuple[str, list[str]]) -> str:
    return variant[0] + "".join(variant[1])


@pytest.mark.full
@pytest.mark.parametrize("variant", MORE_VARIANTS, ids=name_of)
def test_digests_of_the_whole_matrix(variant):
    if not shutil.which(variant[0]):
        pytest.skip(f"{variant[0]} is not installed")
    done = run([build(*variant)], timeout=600)
    assert done.returncode == 0, done.stderr
    compare(done.stdout)


@pytest.mark.parametrize("variant", VARIANTS, ids=name_of)
def test_digests_of_every_compiler_and_level(builds, variant):
    if str(variant) not in builds:
        pytest.skip(f"{variant[0]} is not installed")
    done = run([builds[str(variant)].result()], timeout=300)
    assert done.returncode == 0, done.stderr
    compare(done.stdout)
