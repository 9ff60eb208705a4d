"""Tests the statistics of the single-domain samplers against maximal sets by naive dart throwing. The reference shares
no code with the samplers.

Hierarchical dart throwing has the same distribution as naive dart throwing, point by point. Therefore, the first part of a set,
in the order of acceptance, must also match naive darts. Wavefront sampling fills the domain from a corner, so its order
differs. These tests detect no difference in its complete sets, which is all that section 4.4 of the paper claims. All seeds are
fixed."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest
from analysis.measured import ALPHA, DENSITY, DIRECTIONS, FEATURES, JAMMED_COVERAGE, WRONG, Measured
from analysis.significance import mean_differs_from, means_differ, z_of_mean

WINDOW = 36.0  # Width of the windows in radii.
BORDER = 6.0
SIDE = WINDOW + 2.0 * BORDER
SETS = 128  # The number of independent seeds of each kind.

# The accumulator variant is not measured, because it produces the same points (tests/core/test_domain_determinism.cpp).
EQUIVALENT = [("hierarchical", "single"), ("hierarchical", "double")]
KINDS = [*EQUIVALENT, ("wavefront", "double")]
# Both precisions use the same random numbers, so equal seeds would give both the same deviations.
FIRST_SEED = {"single": 1001, "double": 2001}


def domains_of(poissontiles: ModuleType, method: str, size, first_seed: int, seeds: int, *, toroidal=True, **options) -> list[np.ndarray]:
    """Returns whole domains of size = (width, height) with radius 1, one for each seed, converted to double precision. `options` are passed to
    poissontiles.sample_domain."""
    return [
        poissontiles.sample_domain(size, 1.0, seed, method=method, toroidal=toroidal, **options).astype(np.float64)
        for seed in range(first_seed, first_seed + seeds)
    ]


def measured(sets: list[np.ndarray], part: float = 1.0) -> Measured:
    """Measures the first `part` of the points of each torus, shifted so that both seams pass through the middle of the
    window."""
    windows = []
    for points in sets:
        windows.append(np.mod(points[: round(part * len(points))] + 0.5 * SIDE, SIDE) - BORDER)
    return Measured(windows, WINDOW)


@pytest.fixture(scope="module")
def dart_sets(references) -> list[np.ndarray]:
    return references.darts(SIDE, 1, SETS)


@pytest.fixture(scope="module")
def darts(dart_sets) -> Measured:
    return measured(dart_sets)


@pytest.fixture(scope="module")
def domain_sets(poissontiles) -> dict[tuple[str, str], list[np.ndarray]]:
    return {kind: domains_of(poissontiles, kind[0], (SIDE, SIDE), FIRST_SEED[kind[1]], SETS, precision=kind[1]) for kind in KINDS}


@pytest.fixture(scope="module")
def domains(domain_sets) -> dict[tuple[str, str], Measured]:
    return {kind: measured(sets) for kind, sets in domain_sets.items()}


@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("kind", KINDS, ids="-".join)
def test_sets_agree_with_naive_darts(darts, domains, kind, feature):
    p = means_differ(darts.rows(feature), domains[kind].rows(feature))
    # The test of this guarantee runs twelve times, so each test gets a twelfth of ALPHA.
    assert p > ALPHA / 12, f"{feature} differ: p = {p:.2g}"


@pytest.mark.parametrize("kind", KINDS, ids="-".join)
def test_near_pairs_have_no_direction(domains, kind):
    p = mean_differs_from(domains[kind].directions, 1.0 / DIRECTIONS)
    assert p > ALPHA / 3, f"directions differ: p = {p:.2g}"


@pytest.mark.parametrize("part", [0.3, 0.9])
@pytest.mark.parametrize("kind", EQUIVALENT, ids="-".join)
def test_parts_of_sets_agree_with_naive_darts(dart_sets, domain_sets, kind, part):
    """Checks that the order of acceptance matches naive darts. At any time, darts must be equally likely everywhere
    in the uncovered area, and must not prefer small squares or certain rows."""
    p = means_differ(measured(dart_sets, part).pairs, measured(domain_sets[kind], part).pairs)
    assert p > ALPHA / 4, f"the first {part} of the points differ: p = {p:.2g}"


@pytest.fixture(scope="module")
def wrong_sets(poissontiles, references) -> dict[str, Measured]:
    """Returns sets of naive dart throwing that ends too early, and tiles colored by phase."""
    return {
        "early": measured(domains_of(poissontiles, "naive", (SIDE, SIDE), 3001, SETS, darts_each=40)),
        "colored": measured(references.colored(SIDE, 8, 1, SETS)),
    }


@pytest.mark.parametrize("feature", ["density", "pairs"])
@pytest.mark.parametrize("kind", ["early", "colored"])
def test_wrong_sets_are_detected(darts, wrong_sets, kind, feature):
    p = means_differ(darts.rows(feature), wrong_sets[kind].rows(feature))
    assert p < WRONG, f"{kind} is not distinguished from darts by its {feature}: p = {p:.2g}"


def test_a_different_order_is_detected(dart_sets, domain_sets):
    """Checks that the comparison of parts detects the order of the wavefront, which fills a corner first. Otherwise,
    the comparison would prove nothing."""
    wavefront = domain_sets["wavefront", "double"]
    assert means_differ(measured(dart_sets, 0.3).pairs, measured(wavefront, 0.3).pairs) < WRONG


def coverage(sets: list[np.ndarray], side: float) -> np.ndarray:
    return np.array([len(points) for points in sets]) * np.pi * 0.25 / side**2


@pytest.mark.parametrize("kind", [*EQUIVALENT, ("wavefront", "single")], ids="-".join)
def test_coverage_matches_the_jammed_state(poissontiles, kind):
    """Checks the coverage of two million points on tori."""
    side, seeds = 300.0, 32
    sets = domains_of(poissontiles, kind[0], (side, side), FIRST_SEED[kind[1]], seeds, precision=kind[1])
    assert sum(map(len, sets)) >= 2_000_000
    densities = coverage(sets, side)
    error = densities.std(ddof=1) / np.sqrt(seeds)
    assert error < 1.5e-4, "there are too few points for a conclusion"
    z = z_of_mean(densities, JAMMED_COVERAGE)
    assert abs(z) < 4.0, f"coverage {densities.mean():.6f} is {z:.1f} standard errors from {JAMMED_COVERAGE}"


@pytest.mark.full
def test_coverage_in_single_precision_lacks_only_the_loss_of_the_lattice(poissontiles):
    """Checks the coverage of 28 million points. At this width, a coordinate step is 2^-11 radii, and sets of such
    positions cover less than sets in the plane: 0.3 times the step in radii, measured in eight other sets. Squares that
    were abandoned too early would lower the coverage further."""
    side, seeds, step = 3700.0, 3, 2.0**-11
    densities = coverage(domains_of(poissontiles, "hierarchical", (side, side), 6001, seeds, precision="single"), side)
    # Counts of a jammed set have a standard deviation of sqrt(points) / 4.
    error = 0.25 * JAMMED_COVERAGE / np.sqrt(seeds * DENSITY * side**2)
    z = (densities.mean() - JAMMED_COVERAGE + 0.3 * step) / error
    assert abs(z) < 4.0, f"coverage {densities.mean():.6f} is {z:.1f} standard errors from the expected value"


def test_naive_darts_approach_the_jammed_state_at_the_known_rate(poissontiles):
    """Checks that four times as many darts halve the missing coverage. It is inversely proportional to the square root
    of the number of darts (Feder 1980, Swendsen 1981)."""
    side, seeds = 48.0, 16
    missing = []
    for darts_each in [25, 100, 400]:
        densities = coverage(domains_of(poissontiles, "naive", (side, side), 4001, seeds, darts_each=darts_each), side)
        assert z_of_mean(densities, JAMMED_COVERAGE) < -4.0
        missing.append(JAMMED_COVERAGE - densities.mean())
    assert 1.8 < missing[0] / missing[1] < 2.2
    assert 1.8 < missing[1] / missing[2] < 2.2


@pytest.mark.parametrize("method", ["naive", "hierarchical", "wavefront"])
@pytest.mark.parametrize("torus", [True, False], ids=["torus", "bounded"])
def test_all_four_sides_have_equal_densities(poissontiles, method, torus):
    """Checks that the densities near the four edges of a rectangular domain, as functions of the distance from the edge, are
    equal."""
    size, seeds = np.array([70.0, 41.0]), 96
    edges = np.linspace(0.0, 3.0, 9)
    rows, density = [], []
    for points in domains_of(poissontiles, method, size, 5001, seeds, toroidal=torus, darts_each=30):
        sides = []
        density.append(len(points) / size.prod())
        for axis, other in ((0, 1), (1, 0)):
            coordinate = points[:, axis]
            # The corners, where two edges meet, are excluded.
            is_inside = np.abs(points[:, other] - 0.5 * size[other]) < 0.5 * size[other] - edges[-1]
            for distance in (coordinate, size[axis] - coordinate):
                counts, _ = np.histogram(distance[is_inside], bins=edges)
                sides.append(counts / ((edges[1] - edges[0]) * (size[other] - 2.0 * edges[-1])))
        rows.append(sides)
    rows = np.array(rows)
    differences = rows[:, 1:] - rows[:, :1]
    p = mean_differs_from(differences.reshape(seeds, -1), 0.0)
    assert p > ALPHA / 6, f"edges differ: p = {p:.2g}"
    edge_density = z_of_mean(rows[:, :, 0].mean(axis=1) - density, 0.0)
    # Beyond the border of a bounded domain, no points exclude positions inside, so the density near the border is higher. A seam has points on both
    # sides.
    assert abs(edge_density) < 4.0 if torus else edge_density > 20.0
