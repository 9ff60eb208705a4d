"""Estimates statistics of a point set from a window. Every function takes positions (n, 2) in radii, with the window at [0, side) x [0, side). Some
functions need a border of points around the window."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree


def inside(positions: np.ndarray, side: float) -> np.ndarray:
    """Returns a boolean mask of the points in the half-open window."""
    return np.all((positions >= 0.0) & (positions < side), axis=1)


def close_pairs(positions: np.ndarray, side: float, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns (distance, angle, weight) of all pairs at a distance of at most `reach`. The weight of a pair is the number of its points in the
    window, so each point in the window counts all of its neighbors once. The window needs a border of `reach`."""
    pairs = cKDTree(positions).query_pairs(reach, output_type="ndarray")
    offset = positions[pairs[:, 1]] - positions[pairs[:, 0]]
    inner_points = inside(positions, side).astype(np.int64)
    weight = inner_points[pairs[:, 0]] + inner_points[pairs[:, 1]]
    return np.hypot(offset[:, 0], offset[:, 1]), np.arctan2(offset[:, 1], offset[:, 0]), weight


def pair_correlation(positions: np.ndarray, side: float, edges: np.ndarray, density: float) -> np.ndarray:
    """Returns the pair correlation g(r) in the bins between `edges`, relative to a fixed density (points per squared radius), so that sets with
    different densities have different results. The window needs a border of edges[-1]."""
    distance, _, weight = close_pairs(positions, side, edges[-1])
    counts, _ = np.histogram(distance, bins=edges, weights=weight)
    rings = np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
    return counts / (side * side * density * density * rings)


def cross_correlation(a: np.ndarray, b: np.ndarray, side: float, edges: np.ndarray) -> np.ndarray:
    """Returns the pair correlation g(r) between the points of `a` in the window and all points of `b`, relative to the density of `b` in the
    window. It is 1 everywhere for independent sets. `b` needs a border of edges[-1]."""
    centers = cKDTree(a[inside(a, side)])
    counts = np.diff(centers.count_neighbors(cKDTree(b), edges).astype(float))
    rings = np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
    density_a, density_b = inside(a, side).sum(), inside(b, side).sum()
    return counts / (density_a * density_b / (side * side) * rings)


def near_pair_directions(positions: np.ndarray, side: float, reach: float, bins: int) -> np.ndarray:
    """Returns the fraction of the pairs nearer than `reach` in each direction, over half a turn. For an isotropic set, each fraction is 1 / bins.
    The window needs a border of `reach`."""
    _, angle, weight = close_pairs(positions, side, reach)
    counts, _ = np.histogram(np.mod(angle, np.pi), bins=bins, range=(0.0, np.pi), weights=weight)
    return counts / counts.sum()


class Spectrum:
    """The power spectrum of a window at the wave vectors 2 pi (i, j) / side with |i|, |j| <= modes. Each axis is
    tapered by a Hann window. Power is relative to that of independent points."""

    def __init__(self, positions: np.ndarray, side: float, modes: int):
        points = positions[inside(positions, side)]
        taper = np.prod(np.sin(np.pi * points / side) ** 2, axis=1)
        x = self._waves(points[:, 0] / side, 0, modes) * taper.astype(np.float32)
        y = self._waves(points[:, 1] / side, -modes, modes)
        power = np.abs(x @ y.T).astype(np.float64) ** 2 / np.sum(taper**2)
        i, j = np.meshgrid(np.arange(0, modes + 1), np.arange(-modes, modes + 1), indexing="ij")
        # The taper spreads the mean density over the modes next to zero. At i = 0, modes j and -j are equal, so one of
        # them is redundant.
        is_used = (np.maximum(np.abs(i), np.abs(j)) > 2) & ((i > 0) | (j > 0))
        self.power = power[is_used]
        self.frequency = np.hypot(i, j)[is_used] / side
        self.angle = np.arctan2(j, i)[is_used]

    @staticmethod
    def _waves(turns: np.ndarray, first: int, last: int) -> np.ndarray:
        """Returns exp(-2 pi i mode turns) for the modes first..last, one row each. The function multiplies a few exact values instead of
        evaluating every mode, which is much faster."""
        step = 16

        def exact(modes):
            return np.exp(-2j * np.pi * np.mod(np.outer(modes, turns), 1.0)).astype(np.complex64)

        coarse = exact(np.arange(first, last + 1, step))[:, np.newaxis, :]
        return (coarse * exact(np.arange(step))[np.newaxis]).reshape(-1, len(turns))[: last - first + 1]

    def radial(self, edges: np.ndarray) -> np.ndarray:
        """Returns the mean power in the rings of frequency (waves per radius) between `edges`."""
        ring = np.digitize(self.frequency, edges) - 1
        is_in_range = (ring >= 0) & (ring < len(edges) - 1)
        count = np.bincount(ring[is_in_range], minlength=len(edges) - 1)
        return np.bincount(ring[is_in_range], self.power[is_in_range], minlength=len(edges) - 1) / count

    def anisotropy(self, edges: np.ndarray) -> np.ndarray:
        """Returns, for each ring, the mean power times cos 2a, sin 2a, cos 4a and sin 4a, then the mean squared power. The mean squared power is
        Ulichney's anisotropy up to a constant factor. These values show whether a set has preferred directions."""
        ring = np.digitize(self.frequency, edges) - 1
        is_in_range = (ring >= 0) & (ring < len(edges) - 1)
        count = np.bincount(ring[is_in_range], minlength=len(edges) - 1)
        shapes = [np.cos(2 * self.angle), np.sin(2 * self.angle), np.cos(4 * self.angle), np.sin(4 * self.angle)]
        weights = [self.power * shape for shape in shapes] + [self.power**2]
        sums = [np.bincount(ring[is_in_range], weight[is_in_range], minlength=len(edges) - 1) / count for weight in weights]
        return np.concatenate(sums)
