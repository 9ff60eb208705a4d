"""Tests the statistics of the sampler's sets against maximal sets by naive dart throwing, and against uniform
distributions.

All seeds are fixed, so every run computes the same values. A hypothesis is rejected if its p-value is below ALPHA. The
p-values of deliberately wrong sets (Bridson's method, tiles colored by phase) must be far below it. Nothing else needs
tuning, because the spread of each feature is estimated from independent seeds."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from analysis.estimators import cross_correlation
from analysis.measured import ALPHA, DIRECTIONS, FEATURES, JAMMED_COVERAGE, WRONG, Measured
from analysis.point_sets import CELL, LATTICE_BITS, RADIUS, in_radii, lattice_points
from analysis.significance import mean_differs_from, means_differ, z_of_mean

WINDOW = 64.0  # Width of the windows in radii.
BORDER = 8.0
SIDE = WINDOW + 2.0 * BORDER
SETS = 128  # Number of independent seeds of each kind.
# The minimum corner of the requested rectangle, which contains the origin. It is not on a line of the lattice.
CORNER = -29.0
TILE = 15.5


def of_reference(sets: list[np.ndarray]) -> Measured:
    return Measured([points - BORDER for points in sets], WINDOW)


def of_sampler(poissontiles: ModuleType, first_seed: int, levels: int) -> Measured:
    rect = (CORNER, CORNER, CORNER + SIDE, CORNER + SIDE)
    sets = [lattice_points(poissontiles, rect, seed, levels=levels, tile=TILE) for seed in range(first_seed, first_seed + SETS)]
    return Measured([in_radii(points, (CORNER + BORDER, CORNER + BORDER)) for points in sets], WINDOW)


@pytest.fixture(scope="session")
def darts(references) -> Measured:
    return of_reference(references.darts(SIDE, 1, SETS))


@pytest.fixture(scope="session")
def sampled(poissontiles) -> Measured:
    return of_sampler(poissontiles, 1001, levels=1)


@pytest.mark.parametrize("feature", FEATURES)
def test_sampler_agrees_with_naive_darts(darts, sampled, feature):
    p = means_differ(darts.rows(feature), sampled.rows(feature))
    assert p > ALPHA, f"{feature} differ: p = {p:.2g}"


@pytest.mark.parametrize("feature", FEATURES)
def test_naive_darts_agree_with_themselves(darts, feature):
    """Checks that two halves of the reference agree. Otherwise, the p-values would be meaningless."""
    first, second = darts.rows(feature)[: SETS // 2], darts.rows(feature)[SETS // 2 :]
    p = means_differ(first, second)
    assert p > ALPHA, f"{feature} differ: p = {p:.2g}"


@pytest.fixture(scope="session")
def wrong_sets(references) -> dict[str, Measured]:
    return {
        "colored": of_reference(references.colored(SIDE, 8, 1, SETS)),
        "bridson": of_reference(references.bridson(SIDE, 1, SETS // 2)),
    }


@pytest.mark.parametrize(
    ("kind", "feature"),
    [("colored", "density"), ("colored", "pairs"), ("colored", "rings")]
    + [("bridson", feature) for feature in FEATURES],
)
def test_wrong_sets_are_detected(darts, wrong_sets, kind, feature):
    """Checks that deliberately wrong sets are detected. The seams of colored tiles (8 radii wide) add about 1 % to the
    density, and Bridson's sets have a different distribution."""
    p = means_differ(darts.rows(feature), wrong_sets[kind].rows(feature))
    assert p < WRONG, f"{kind} is not distinguished from darts by its {feature}: p = {p:.2g}"


@pytest.mark.parametrize("feature", FEATURES)
def test_progressive_set_agrees_with_naive_darts(feature, progressive):
    p = means_differ(progressive[0].rows(feature), progressive[1].rows(feature))
    assert p > ALPHA, f"{feature} differ: p = {p:.2g}"


@pytest.fixture(scope="session")
def progressive(references, poissontiles) -> tuple[Measured, Measured]:
    """Returns (naive darts, sampler) with three levels."""
    return of_reference(references.progressive(SIDE, 3, 1, SETS)), of_sampler(poissontiles, 2001, levels=3)


def test_progressive_set_differs_from_plain_darts(darts, progressive):
    """Checks that the two distributions differ. Otherwise, the comparison above could not distinguish them."""
    assert means_differ(darts.pairs, progressive[1].pairs) < WRONG


def test_near_pairs_have_no_direction(sampled):
    p = mean_differs_from(sampled.directions, 1.0 / DIRECTIONS)
    assert p > ALPHA, f"directions differ: p = {p:.2g}"


class Tally:
    """Counts of five million points. For each of 48 seeds, it samples a square with an edge length of 565 cells, about 400
    radii. The edge length is a multiple of five cells, so that every phase and class covers the same area."""

    SEEDS = 48
    SIDE = 565 * CELL / RADIUS
    PHASES = 5
    CLASSES = 5

    def __init__(self, poissontiles: ModuleType, levels: int):
        self.count, self.phase, self.tag = [], [], []
        corner = 1000.25
        rect = (corner, -corner, corner + self.SIDE, self.SIDE - corner)
        for seed in range(3001, 3001 + self.SEEDS):
            self.add(lattice_points(poissontiles, rect, seed, levels=levels))

    def add(self, points: np.ndarray):
        self.count.append(len(points))
        phase = [(axis & (CELL - 1)) * self.PHASES >> LATTICE_BITS for axis in points.T]
        cell = [(axis >> LATTICE_BITS) % self.CLASSES for axis in points.T]
        self.phase.append(np.bincount(phase[0] + self.PHASES * phase[1], minlength=self.PHASES**2) / len(points))
        self.tag.append(np.bincount(cell[0] + self.CLASSES * cell[1], minlength=self.CLASSES**2) / len(points))


@pytest.fixture(scope="session")
def plain_tally(poissontiles) -> Tally:
    return Tally(poissontiles, 1)


@pytest.fixture(scope="session")
def progressive_tally(poissontiles) -> Tally:
    return Tally(poissontiles, 3)


@pytest.fixture(params=["plain_tally", "progressive_tally"])
def tally(request) -> Tally:
    return request.getfixturevalue(request.param)


def test_coverage_matches_the_jammed_state(plain_tally):
    tally = plain_tally
    assert sum(tally.count) >= 5_000_000
    coverage = np.array(tally.count) * np.pi * 0.25 / tally.SIDE**2
    error = coverage.std(ddof=1) / np.sqrt(len(coverage))
    assert error < 1e-4, "there are too few points for a conclusion"
    z = z_of_mean(coverage, JAMMED_COVERAGE)
    assert abs(z) < 4.0, f"coverage {coverage.mean():.6f} is {z:.1f} standard errors from {JAMMED_COVERAGE}"


def test_positions_within_cells_are_uniform(tally):
    expected = 1.0 / tally.PHASES**2
    p = mean_differs_from(np.array(tally.phase)[:, :-1], expected)
    assert p > ALPHA, f"some positions within cells are more likely: p = {p:.2g}"


def test_no_class_of_cells_is_preferred(tally):
    """Checks that the position of a cell does not influence the points. The last bits of dart times contain this position modulo 5, to break ties."""
    p = mean_differs_from(np.array(tally.tag)[:, :-1], 1.0 / tally.CLASSES**2)
    assert p > ALPHA, f"some positions of cells modulo 5 are preferred: p = {p:.2g}"


@pytest.mark.parametrize(("levels", "even"), [*((levels, False) for levels in range(1, 9)), *((levels, True) for levels in range(2, 9))])
def test_prefix_of_rank_q_has_a_fraction_q_of_the_points(poissontiles, levels, even):
    """Checks 40 windows that are 256 radii wide, which is at least twice the coarsest radius."""
    side, seeds = 256.0, 40
    rect = (-side / 2, 0.0, side / 2, side)
    sets = [np.sort(poissontiles.sample(rect, 1.0, seed, levels=levels, even=even).ranks) for seed in range(4001, 4001 + seeds)]
    shares = np.concatenate([[2.0**-10, 2.0**-8, 2.0**-6], np.arange(1, 16) / 16.0])
    # The surplus is a difference, not a quotient. For correct ranks, its mean is zero, regardless of how much the number of
    # points varies.
    surplus = np.array([np.searchsorted(ranks, shares * 2.0**32) - shares * len(ranks) for ranks in sets])
    p = mean_differs_from(surplus, 0.0)
    # The test of this guarantee runs fifteen times, so each test gets a fifteenth of ALPHA.
    assert p > ALPHA / 15, f"surplus of {shares}: {surplus.sum(axis=0) / sum(map(len, sets))}, p = {p:.2g}"


CROSS_EDGES = np.linspace(0.0, 3.0, 13)


def cross_p(pairs: list[tuple[np.ndarray, np.ndarray]]) -> float:
    """Returns the p-value of "the two windows of a pair are independent". The pairs must be independent of each other."""
    rows = [cross_correlation(a, b, WINDOW, CROSS_EDGES) for a, b in pairs]
    return mean_differs_from(np.array(rows), 1.0)


def window(poissontiles: ModuleType, seed: int, offset_cells=(0, 0), **options) -> np.ndarray:
    """Returns a window of a set, with its border. Its corner is shifted from the origin by `offset_cells`."""
    shift = np.asarray(offset_cells) * CELL / RADIUS
    low = shift - BORDER
    high = shift + WINDOW + BORDER
    return in_radii(lattice_points(poissontiles, (*low, *high), seed, **options), shift)


RELATIONS: dict[str, Callable[[ModuleType, int], tuple[np.ndarray, np.ndarray]]] = {
    "seed and next seed": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed + 1)),
    "seed and seed + 2^32": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed + 2**32)),
    "layer and next layer": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed, layer=1)),
    "layer and seed swapped": lambda poissontiles, seed: (window(poissontiles, seed, layer=1), window(poissontiles, 1, layer=seed)),
    "place and 2^8 cells east": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed, (2**8, 0))),
    "place and 2^16 cells east": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed, (2**16, 0))),
    "place and 2^22 cells south": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed, (0, 2**22))),
    "place and its opposite": lambda poissontiles, seed: (window(poissontiles, seed), window(poissontiles, seed, (-(2**22), -(2**22)))),
}


@pytest.mark.parametrize("relation", RELATIONS)
def test_sets_are_independent(poissontiles, relation):
    seeds = range(5001, 5001 + 2 * 40, 2)
    p = cross_p([RELATIONS[relation](poissontiles, seed) for seed in seeds])
    assert p > ALPHA / len(RELATIONS), f"{relation} are related: p = {p:.2g}"


def test_a_dependence_is_detected(poissontiles):
    """Checks that a set is found to depend on a second set that contains every third of its points."""
    pairs = []
    for seed in range(5001, 5001 + 2 * 40, 2):
        a, b = window(poissontiles, seed), window(poissontiles, seed + 1)
        pairs.append((a, np.concatenate([a[::3], b[1::3], b[2::3]])))
    assert cross_p(pairs) < WRONG
