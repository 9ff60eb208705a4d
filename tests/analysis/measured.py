"""The features that the statistical tests compare, one row per set, and the significance levels of the tests."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from .estimators import Spectrum, inside, near_pair_directions, pair_correlation

ALPHA = 1e-3  # A hypothesis is rejected if its p-value is below this number.
WRONG = 1e-6  # Deliberately wrong sets must have a p-value below this number.

# Fraction of the plane that disks cover once no more disk fits (random sequential adsorption jams).
JAMMED_COVERAGE = 0.547070
DENSITY = JAMMED_COVERAGE * 4.0 / np.pi  # Number of points per squared radius.

PAIR_EDGES = np.concatenate([np.arange(1.0, 2.0, 0.05), np.arange(2.0, 5.01, 0.25)])
RING_EDGES = np.arange(0.0625, 2.5001, 0.0625)
WIDE_RING_EDGES = np.linspace(0.25, 2.5, 10)
DIRECTIONS = 24

FEATURES = ["density", "pairs", "rings", "anisotropy"]


class Measured:
    """Computes one row of features for each set and estimator. `windows` have positions in radii, with the window at [0, side) x [0, side) and a
    border of at least 5 radii around it."""

    def __init__(self, windows: list[np.ndarray], side: float):
        self.windows = windows
        self.side = side

    @cached_property
    def density(self) -> np.ndarray:
        return np.array([inside(points, self.side).sum() for points in self.windows]) / self.side**2

    @cached_property
    def pairs(self) -> np.ndarray:
        return np.array([pair_correlation(points, self.side, PAIR_EDGES, DENSITY) for points in self.windows])

    @property
    def rings(self) -> np.ndarray:
        return self._spectral[0]

    @property
    def anisotropy(self) -> np.ndarray:
        return self._spectral[1]

    @cached_property
    def directions(self) -> np.ndarray:
        # The fractions add up to 1, so the last one is redundant.
        return np.array([near_pair_directions(p, self.side, 1.2, DIRECTIONS)[:-1] for p in self.windows])

    @cached_property
    def _spectral(self) -> tuple[np.ndarray, np.ndarray]:
        """Returns (rings, anisotropy). The spectra themselves are large, so they are not stored."""
        rings, anisotropy = [], []
        for points in self.windows:
            spectrum = Spectrum(points, self.side, round(RING_EDGES[-1] * self.side))
            rings.append(spectrum.radial(RING_EDGES))
            anisotropy.append(spectrum.anisotropy(WIDE_RING_EDGES))
        return np.array(rings), np.array(anisotropy)

    def rows(self, feature: str) -> np.ndarray:
        values = getattr(self, feature)
        return values.reshape(len(values), -1)
