"""Point sets as arrays: the sampler's sets, from the Python package, and reference sets, from the program
`analysis/references` (tests/analysis/references.cpp)."""

from __future__ import annotations

import subprocess
from pathlib import Path
from types import ModuleType

import numpy as np

# Base squares are 2^14 units wide and the radius is sqrt(2) * 2^14 units: extension/core/sampling/point_set.hpp.
LATTICE_BITS = 14
CELL = 1 << LATTICE_BITS
RADIUS = CELL * np.sqrt(2.0)


def lattice_points(poissontiles: ModuleType, rect, seed: int, *, tile: float | None = None, **options) -> np.ndarray:
    """Returns lattice coordinates (int64, n x 2) of the sampler's set with radius 1 in rect = (min_x, min_y, max_x, max_y). The rectangle is
    requested as a whole, or in tiles of width `tile`. The options are those of poissontiles.sample."""
    rects = [rect]
    if tile:
        min_x, min_y, max_x, max_y = rect
        corners = [(x, y) for y in np.arange(min_y, max_y, tile) for x in np.arange(min_x, max_x, tile)]
        rects = [(x, y, min(x + tile, max_x), min(y + tile, max_y)) for x, y in corners]
    positions = np.concatenate([poissontiles.sample(each, 1.0, seed, **options).positions for each in rects])
    # The inverse of lattice_position in extension/core/sampling/point_set.cpp.
    return np.floor(positions / (1.0 / np.sqrt(2.0) / CELL) + 0.5).astype(np.int64)


class References:
    """Lists of sets, one for each seed from `first_seed` on, as coordinates (float64, n x 2) with radius 1."""

    def __init__(self, program: Path):
        self.program = program

    def _sets(self, *arguments) -> list[np.ndarray]:
        result = subprocess.run([str(self.program), *map(str, arguments)], capture_output=True, timeout=600, check=False)
        assert result.returncode == 0, f"{self.program.name} {arguments}: {result.stderr.decode(errors='replace')}"
        sets, place = [], 0
        while place < len(result.stdout):
            count = int(np.frombuffer(result.stdout, "<u8", 1, place)[0])
            sets.append(np.frombuffer(result.stdout, "<f8", 2 * count, place + 8).reshape(count, 2))
            place += 8 + 16 * count
        return sets

    def darts(self, side, first_seed, seeds=1) -> list[np.ndarray]:
        """Returns sets of naive dart throwing on a torus with this side, run until each set is maximal."""
        return self._sets("darts", side, first_seed, seeds)

    def progressive(self, side, levels, first_seed, seeds=1) -> list[np.ndarray]:
        """Returns sets of naive dart throwing on a torus with this side: first with radius 2^(levels - 1), then with half of this radius, and so
        on down to 1."""
        return self._sets("progressive", side, levels, first_seed, seeds)

    def colored(self, side, tile, first_seed, seeds=1) -> list[np.ndarray]:
        """Returns deliberately wrong sets: tiles on a torus that are filled in four phases."""
        return self._sets("colored", side, tile, first_seed, seeds)

    def bridson(self, side, first_seed, seeds=1) -> list[np.ndarray]:
        """Returns deliberately wrong sets: Bridson's method on a square."""
        return self._sets("bridson", side, first_seed, seeds)


def in_radii(lattice: np.ndarray, corner) -> np.ndarray:
    """Returns lattice coordinates in radii, relative to a corner in radii. The corner is subtracted as integers, so that sets far from the origin
    keep their precision."""
    return (lattice - np.round(np.asarray(corner) * RADIUS).astype(np.int64)) / RADIUS
