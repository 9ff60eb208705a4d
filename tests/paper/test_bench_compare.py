"""Tests the verdicts of tests/bench/compare.py: it must detect changes and not report noise."""

import importlib.util
import random
import subprocess
import sys

import pytest
from conftest import REPO

SPEC = importlib.util.spec_from_file_location("compare", REPO / "tests/bench/compare.py")
compare = sys.modules["compare"] = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(compare)


def noisy(median, turns, seed, spread=0.03):
    chance = random.Random(seed)
    return [median * (1.0 + spread * chance.uniform(-1.0, 1.0)) for _ in range(turns)]


def test_rows_of_a_benchmark_are_read():
    printed = """Measured on one core.
| measurement | median | lowest to highest round | rounds |
|---|---|---|---|
| tiles of 64 r: sampler, L = 1 | 4.50 M points/s | 4.43 to 4.52 | 5 |
| bytes per removal | 1,234.5 bytes | exact | 1 |
| points computed per point kept, L = 1 | 1.127 | exact | 1 |
| a jump: the call | 19 µs | 19 to 19 µs | 1 |
"""
    assert compare.read_rows(printed) == {
        "tiles of 64 r: sampler, L = 1": (4.5, "M points/s"),
        "bytes per removal": (1234.5, "bytes"),
        "points computed per point kept, L = 1": (1.127, ""),
        "a jump: the call": (19.0, "µs"),
    }


@pytest.mark.parametrize(
    ("unit", "better"),
    [("M points/s", True), ("per second", True), ("per ms", True), ("times", True), ("times the time", False), ("µs", False), ("bytes", False), ("", False)],
)
def test_units_determine_the_better_direction(unit, better):
    assert compare.more_is_better(unit) is better


@pytest.mark.parametrize(("factor", "unit", "verdict"), [(1.1, "M points/s", "better"), (0.9, "M points/s", "worse"), (1.1, "ms", "worse"), (0.9, "ms", "better")])
def test_a_changed_row_is_found(factor, unit, verdict):
    change = compare.compare("row", unit, noisy(4.0, 9, seed=1), noisy(4.0 * factor, 9, seed=2))
    assert change.verdict == verdict
    assert change.worse == (verdict == "worse")
    assert change.ratio == pytest.approx(factor, rel=0.04)


def test_noise_rarely_counts_as_a_change():
    moved = sum(compare.compare("row", "ms", noisy(4.0, 9, 2 * seed, 0.1), noisy(4.0, 9, 2 * seed + 1, 0.1)).moved for seed in range(2000))
    assert moved <= 2000 * compare.CHANCE


def test_a_change_below_the_minimum_is_ignored():
    assert not compare.compare("row", "ms", [1.0] * 20, [1.0 + 0.9 * compare.LEAST] * 20).moved
    assert compare.compare("row", "ms", [1.0] * 20, [1.0 + 1.1 * compare.LEAST] * 20).moved
    assert not compare.compare("row", "", [0.0] * 20, [0.0] * 20).moved


def test_many_turns_permit_outliers():
    assert [compare.outliers(turns) for turns in (1, 7, 8, 10, 11, 12, 14)] == [-1, -1, 0, 0, 0, 1, 1]
    late = [1.2] * 11 + [0.5]
    assert compare.compare("row", "ms", [1.0] * 12, late).worse
    assert not compare.compare("row", "ms", [1.0] * 9, late[-9:]).moved


def test_rows_of_only_one_commit_are_listed():
    base, new = {"a": (1.0, "ms"), "gone": (1.0, "ms")}, {"a": (2.0, "ms"), "fresh": (1.0, "ms")}
    changes, others = compare.compare_all([(base, new)] * 9)
    assert [(change.what, change.verdict) for change in changes] == [("a", "worse")]
    printed = compare.report(changes, others, 9)
    assert "| a | 1 ms | 2 ms | 2.000 | worse |" in printed
    assert "1 of 1 rows moved, 1 for the worse" in printed
    assert "Only in one of the two: gone; fresh." in printed


def test_too_few_turns_are_reported():
    assert "too few turns" in compare.report([], [], 7)
    assert "too few turns" not in compare.report([], [], 8)


def test_an_unknown_commit_is_rejected():
    completed = subprocess.run([sys.executable, "tests/bench/compare.py", "no-such-commit"], cwd=REPO, capture_output=True, text=True, check=False)
    assert completed.returncode != 0
    assert "no-such-commit" in completed.stderr
