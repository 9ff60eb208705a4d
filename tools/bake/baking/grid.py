"""The tiles of a bake, as the engine defines them, and the instances that belong to each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Bounds = tuple[float, float, float, float]  # Low x, low z, high x, high z in world meters; the high ends are excluded.


@dataclass(frozen=True)
class TileGrid:
    """The grid of a bake's tiles, as bake_grid.gd describes it."""

    tile_size: float  # The side of a tile in meters.
    grid: tuple[int, int, int, int]  # First column, first row, columns and rows.
    edges: tuple[tuple[float, ...], tuple[float, ...]]  # Meters. The edges of the columns, then of the rows, including both ends of the rectangle.

    @classmethod
    def of(cls, described: dict) -> TileGrid:
        """The grid in an engine's description."""
        edges_x, edges_z = (tuple(map(float, edges)) for edges in described["edges"])
        return cls(float(described["tile_size"]), tuple(map(int, described["grid"])), (edges_x, edges_z))

    def tiles(self) -> list[tuple[int, int]]:
        """All tiles, row by row."""
        first_x, first_z, columns, rows = self.grid
        return [(first_x + column, first_z + row) for row in range(rows) for column in range(columns)]

    def __contains__(self, tile: tuple[int, int]) -> bool:
        return 0 <= tile[0] - self.grid[0] < self.grid[2] and 0 <= tile[1] - self.grid[1] < self.grid[3]

    def area_of(self, tile: tuple[int, int]) -> Bounds:
        """The area of a tile, clipped by the bake's rectangle."""
        column, row = tile[0] - self.grid[0], tile[1] - self.grid[1]
        return (self.edges[0][column], self.edges[1][row], self.edges[0][column + 1], self.edges[1][row + 1])


def inside(area: Bounds, bounds: Bounds, x: np.ndarray, z: np.ndarray) -> np.ndarray | None:
    """A mask of the positions in one of the game's tiles, whose edges are `bounds`, that belong to an area; None if all belong to it. An
    instance can lie outside of its tile, because of rounding or an offset along the normal. It then counts at the nearest position inside
    the tile. So if areas cover the plane without overlap, each instance belongs to exactly one of them."""
    within = True
    for low, high, first, end, along in ((area[0], area[2], bounds[0], bounds[2], x), (area[1], area[3], bounds[1], bounds[3], z)):
        if low <= first and end <= high:
            continue
        place = np.clip(along, first, np.nextafter(end, -np.inf))
        within = within & (place >= low) & (place < high)
    return None if within is True else within
