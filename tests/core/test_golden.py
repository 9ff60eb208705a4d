"""Tests that results are bit-identical on every platform, compiler, optimization level and instruction set. The program
`analysis/golden` computes the digests with all instruction sets of the processor. These tests also build and run it for
cells of the matrix in tests/golden/matrix.py. `bash tests/golden/matrix.sh` prints the complete matrix.

tests/golden/core.json changes only if the distribution of the sets or the placement is changed on purpose. To update
it, run:
    scons tests && build/<config>/analysis/golden > tests/golden/core.json
The commit must explain the reason, because the change affects every existing world."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import pytest
from golden.matrix import GOLDEN, NATIVE, PLATFORMS, Outcome, cells, outcome_of

# The cells of a run without --full: two compilers with low and full optimization, and a second processor. Only x86_64
# has the level "fused".
FUSED = "-O3 fused" if NATIVE == "x86_64" else "-O3"
OTHER = "aarch64" if NATIVE == "x86_64" else "x86_64"
PLAIN = {f"{NATIVE} {each}" for each in ("g++ -O1", f"g++ {FUSED}", "clang++ -O1", f"clang++ {FUSED}")} | {f"{OTHER} zig -O3"}
# With --full, every compiler of every platform and every level is covered by a cell. The remaining cells combine these
# differently and would take another hour, so only matrix.sh runs them.
LONGER = [f"{NATIVE} {each}" for each in ("g++ -O2", "clang++ -O0", "clang++ -Os", f"zig {FUSED}")]
LONGER += [f"{each.name} {one}" for each in PLATFORMS if each.name != NATIVE for one in ("g++ -O2", "zig -O3")]
CELLS = {cell.name: cell for cell in cells() if cell.name in PLAIN or cell.name in LONGER}


@pytest.fixture(scope="module")
def outcome(request: pytest.FixtureRequest) -> Iterator[Callable[[str], Outcome]]:
    """Provides outcome(name), which returns the result of a cell. All cells of the selected tests are built in the background, with one compiler
    per core, because building them takes minutes."""
    cases = [item.callspec.params for item in request.session.items if item.path == request.path and hasattr(item, "callspec")]
    with ThreadPoolExecutor(os.cpu_count()) as compilers, ThreadPoolExecutor(os.cpu_count()) as runs:
        made: dict[str, Future[Outcome]] = {}

        def begin(name: str) -> Future[Outcome]:
            if name not in made:
                made[name] = runs.submit(outcome_of, CELLS[name], compilers)
            return made[name]

        for case in cases:
            begin(case["name"])
        yield lambda name: had(begin(name).result())
        for each in made.values():
            each.cancel()


def had(one: Outcome) -> Outcome:
    if one.absent:
        pytest.skip(one.absent)
    assert not one.failure, one.failure
    return one


def test_digests_of_every_instruction_set(core_tool):
    result = core_tool("analysis/golden")
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout) == GOLDEN


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in PLAIN else pytest.mark.full) for name in CELLS])
def test_digests_of_a_cell(outcome, name):
    assert outcome(name).digests == GOLDEN


VECTORS = {
    "x86_64": ["SSE2", "SSSE3", "SSE4"],
    "i386": ["SSE2", "SSSE3", "SSE4"],
    "aarch64": ["NEON"],
    "riscv64": [],
    "wasm": ["WASM"],
    "Windows": ["SSE2", "SSSE3", "SSE4"],
}
EMULATED = {"EMU128", "SCALAR"}
# The cells with all instruction sets. At the level "fused", compilers omit the narrower ones.
FULLEST = [f"{NATIVE} g++ -O1", f"{NATIVE} clang++ -O1", *(f"{each.name} zig -O3" for each in PLATFORMS if each.name != NATIVE)]


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in PLAIN else pytest.mark.full) for name in FULLEST])
def test_instruction_sets_of_a_cell(outcome, name):
    """Checks that, according to its output, the program has computed all digests with the expected instruction sets."""
    used_sets = outcome(name).instruction_sets
    assert set(VECTORS[CELLS[name].platform.name]) <= set(used_sets)
    assert set(used_sets) & EMULATED


def test_widths_of_this_processor(outcome):
    """Checks that the program uses the wide vector instruction sets that the system reports for this processor."""
    words = {"avx2": "AVX2", "avx512vl": "AVX3"}
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            flags = next((line.split() for line in file if line.startswith("flags")), [])
    except OSError:
        pytest.skip("this system has no /proc/cpuinfo")
    expected_sets = {words[flag] for flag in flags if flag in words}
    if not expected_sets:
        pytest.skip("/proc/cpuinfo lists no wide vectors for this processor")
    assert expected_sets <= set(outcome(f"{NATIVE} g++ -O1").instruction_sets)
