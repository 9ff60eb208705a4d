"""Point sets as arrays: runs the program `analysis/points` (tests/analysis/points.cpp) and reads what it writes."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np

# Base squares are 2^14 units wide and the radius is sqrt(2) * 2^14 units: extension/core/sampling/point_set.hpp.
LATTICE_BITS = 14
CELL = 1 << LATTICE_BITS
RADIUS = CELL * np.sqrt(2.0)

RECORD = np.dtype([("x", "<i8"), ("y", "<i8"), ("id", "<u8"), ("rank", "<u4"), ("level", "<u4")])
PLANE_POINT = np.dtype([("x", "<f8"), ("y", "<f8")])


class PointsTool:
    """Hands out lists of sets, one for each seed from `first_seed` on."""

    def __init__(self, program: Path):
        self.program = program

    def _sets(self, record: np.dtype, *arguments) -> list[np.ndarray]:
        done = subprocess.run([str(self.program), *map(str, arguments)], capture_output=True, timeout=600, check=False)
        assert done.returncode == 0, f"{self.program.name} {arguments}: {done.stderr.decode(errors='replace')}"
        sets, place = [], 0
        while place < len(done.stdout):
            count = int(np.frombuffer(done.stdout, "<u8", 1, place)[0])
            sets.append(np.frombuffer(done.stdout, record, count, place + 8))
            place += 8 + count * record.itemsize
        return sets

    def sampler(self, rect, first_seed, seeds=1, *, radius=1.0, levels=1, layer=0, tile=0.0) -> list[np.ndarray]:
        """Sets of the tile sampler in rect = (min_x, min_y, max_x, max_y) meters, asked for at once or by tiles."""
        return self._sets(RECORD, "sampler", radius, levels, layer, *rect, tile, first_seed, seeds)

    def domain(
        self, method, size, first_seed, seeds=1, *, precision="double", torus=True, darts_each=100
    ) -> list[np.ndarray]:
        """Whole domains of size = (width, height), radius 1, by the method of that name in DomainMethod."""
        return self._sets(PLANE_POINT, "domain", method, precision, *size, int(torus), darts_each, first_seed, seeds)

    def darts(self, side, first_seed, seeds=1) -> list[np.ndarray]:
        """Naive dart throwing run to its end on a torus of this side, radius 1."""
        return self._sets(PLANE_POINT, "darts", side, first_seed, seeds)

    def progressive(self, side, levels, first_seed, seeds=1) -> list[np.ndarray]:
        """Naive dart throwing with radius 2^(levels - 1), then half of that, down to 1, on a torus of this side."""
        return self._sets(PLANE_POINT, "progressive", side, levels, first_seed, seeds)

    def colored(self, side, tile, first_seed, seeds=1) -> list[np.ndarray]:
        """Tiles filled in four phases on a torus, radius 1: a wrong set."""
        return self._sets(PLANE_POINT, "colored", side, tile, first_seed, seeds)

    def bridson(self, side, first_seed, seeds=1) -> list[np.ndarray]:
        """Bridson's method on a square, radius 1: a wrong set."""
        return self._sets(PLANE_POINT, "bridson", side, first_seed, seeds)


def in_radii(points: np.ndarray, corner=(0.0, 0.0)) -> np.ndarray:
    """Positions (n, 2) in units of the radius, from a corner given in the same units. Lattice coordinates are
    subtracted as integers first, so that sets far from the origin lose nothing."""
    if points.dtype == RECORD:
        start = np.round(np.asarray(corner) * RADIUS).astype(np.int64)
        return np.stack([points["x"] - start[0], points["y"] - start[1]], axis=1) / RADIUS
    return np.stack([points["x"] - corner[0], points["y"] - corner[1]], axis=1)
