"""Tests the program bench/billion with a thousandth of its points. The program must generate the same set for any order of tiles, stay within its
memory limit, and print all documented values. tests/core/test_billion.cpp tests the checks of the program."""

from __future__ import annotations

import json
import re

import pytest
from conftest import REPO, run

RESIDENT_LIMIT = 64_000_000
KEYS = set(
    "points_asked seed tile_cells tile_radii order threads verify gaps points tiles side_cells side_radii "
    "radius_squared least_squared pairs too_close misplaced doubled tiles_missing tiles_repeated gap_tiles uncovered "
    "changed coverage coverage_error coverage_reference coverage_z coverage_lattice_loss blocks digest seconds "
    "points_per_second cpu_seconds cpu_nanoseconds_per_point sampling_seconds checking_seconds gap_seconds "
    "checking_share rim_points resident_bytes resident_limit compiler broken".split()
)
# Values that depend only on the set and the region.
SAME = ["points", "side_cells", "least_squared", "pairs", "coverage", "coverage_error", "digest"]


def billion(core_tool, *arguments: str, expected: int = 0, timeout: float = 300) -> dict:
    result = core_tool("bench/billion", *arguments, timeout=timeout)
    assert result.returncode == expected, result.stdout + result.stderr
    return json.loads(result.stdout)


@pytest.fixture(scope="module")
def first(core_tool) -> dict:
    return billion(core_tool, "points=1e6", "gaps=16", "order=rows", "threads=1")


def test_a_million_points_fulfill_every_guarantee(first):
    assert set(first) == KEYS
    assert first["broken"] == []
    assert 1_000_000 <= first["points"] < 1_050_000
    assert first["radius_squared"] == 2 * 4**14 <= first["least_squared"]
    assert [first[key] for key in ("too_close", "misplaced", "doubled", "uncovered", "changed")] == [0] * 5
    assert first["tiles_missing"] == first["tiles_repeated"] == 0
    # There are about 3.5 times as many pairs within twice the radius as points.
    assert first["pairs"] > 3 * first["points"]
    assert first["gap_tiles"] >= 4
    assert first["coverage"] == pytest.approx(first["points"] / first["side_cells"] ** 2 * 1.5707963267948966)
    # In a jammed set, the standard deviation of counts is about a quarter of that of independent points.
    assert 0.15 < first["coverage_error"] / first["coverage"] * first["points"] ** 0.5 < 0.4
    assert abs(first["coverage_z"]) <= 4.0
    assert re.fullmatch("[0-9a-f]{32}", first["digest"])


@pytest.mark.parametrize(
    "arguments",
    [
        ("order=shuffled", "threads=2"),
        ("order=hilbert", "threads=2", "tile=90"),
        ("order=shuffled", "threads=1", "tile=181"),
    ],
    ids=" ".join,
)
def test_a_different_order_produces_the_same_set(core_tool, first, arguments):
    other = billion(core_tool, "points=1e6", "gaps=0", *arguments)
    assert {key: other[key] for key in SAME} == {key: first[key] for key in SAME}
    assert other["resident_bytes"] < RESIDENT_LIMIT
    assert other["gap_tiles"] == 0


def test_a_different_seed_produces_a_different_set(core_tool):
    one, two = (billion(core_tool, "points=1e5", "gaps=1", f"seed={seed}") for seed in (2**64 - 1, 0))
    assert one["side_cells"] == two["side_cells"] and one["digest"] != two["digest"]
    assert one["gap_tiles"] == one["tiles"]


def test_memory_does_not_grow_with_the_points(core_tool, first):
    assert first["resident_bytes"] < RESIDENT_LIMIT == first["resident_limit"]
    small = billion(core_tool, "points=2e5", "gaps=16", "order=rows", "threads=1")
    # Only the points along a row of tiles are kept, with 8 bytes each. Keeping all points would add 6.4 MB. The
    # resident size of the program itself varies by less than 1 MB.
    assert first["resident_bytes"] - small["resident_bytes"] < 2_000_000


def test_too_much_memory_violates_a_guarantee(core_tool):
    """Checks that, with many threads and large tiles, the program reports that it has exceeded the memory limit, and how much
    memory it used."""
    spent = billion(core_tool, "points=3e6", "tile=512", "threads=36", "verify=no", expected=1)
    assert spent["broken"] == ["memory"]
    assert spent["resident_bytes"] >= RESIDENT_LIMIT


def test_without_verification_no_guarantee_is_reported(core_tool):
    bare = billion(core_tool, "points=1e5", "verify=no")
    assert set(bare) == KEYS
    unseen = "least_squared pairs too_close misplaced doubled gap_tiles uncovered changed digest checking_share".split()
    assert all(bare[key] is None for key in unseen)
    assert bare["points"] >= 1e5


def test_the_source_names_every_key():
    """Checks that the comment at the head of billion.cpp documents every key, because the page of results uses these
    keys."""
    head = (REPO / "tests/bench/billion.cpp").read_text(encoding="utf-8").split("#include")[0]
    documented = set(re.findall(r"\w+", head))
    assert KEYS <= documented, KEYS - documented


@pytest.mark.parametrize(
    "argument",
    ["points=nan", "points=1e12", "points=999", "points=1e6x", "seed=-1", "seed=", "tile=15", "tile=64.5"]
    + ["order=random", "threads=0", "threads=257", "verify=maybe", "gaps=-1", "color=green", "points", ""],
)
def test_wrong_arguments_are_rejected(build_dir, argument):
    result = run([build_dir / "bench/billion", argument], timeout=60)
    assert result.returncode == 2
    assert result.stdout == ""
    assert "usage: billion" in result.stderr
    assert argument.split("=")[0] in result.stderr


@pytest.mark.full
def test_a_hundred_million_points_fulfill_every_guarantee(core_tool):
    runs = [billion(core_tool, "points=1e8", f"order={order}", timeout=3600) for order in ("rows", "shuffled")]
    assert all(each_run["broken"] == [] and each_run["points"] > 100_000_000 for each_run in runs), runs
    assert runs[0]["digest"] == runs[1]["digest"]
