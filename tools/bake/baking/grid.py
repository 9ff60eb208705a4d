"""The tiles of a bake, as the engine has counted them, and which instances belong to each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Bounds = tuple[float, float, float, float]  # Low x, low z, high x, high z in meters of the world, the high ends excluded.


@dataclass(frozen=True)
class TileGrid:
    """What bake_grid.gd says of a bake's tiles."""

    tile_size: float  # Meters of a side.
    grid: tuple[int, int, int, int]  # First column, first row, columns and rows.
    edges: tuple[tuple[float, ...], tuple[float, ...]]  # Meters: between columns, and between rows; those of the rectangle at both ends.

    @classmethod
    def of(cls, described: dict) -> TileGrid:
        """The grid in what an engine has described."""
        edges_x, edges_z = (tuple(map(float, edges)) for edges in described["edges"])
        return cls(float(described["tile_size"]), tuple(map(int, described["grid"])), (edges_x, edges_z))

    def tiles(self) -> list[tuple[int, int]]:
        """All tiles, row by row."""
        first_x, first_z, columns, rows = self.grid
        return [(first_x + column, first_z + row) for row in range(rows) for column in range(columns)]

    def __contains__(self, tile: tuple[int, int]) -> bool:
        return 0 <= tile[0] - self.grid[0] < self.grid[2] and 0 <= tile[1] - self.grid[1] < self.grid[3]

    def area_of(self, tile: tuple[int, int]) -> Bounds:
        """What a tile covers, cut by the bake's rectangle."""
        column, row = tile[0] - self.grid[0], tile[1] - self.grid[1]
        return (self.edges[0][column], self.edges[1][row], self.edges[0][column + 1], self.edges[1][row + 1])


def inside(area: Bounds, bounds: Bounds, x: np.ndarray, z: np.ndarray) -> np.ndarray | None:
    """Which of the positions of a game's tile, of which `bounds` are the edges, belong to an area: an instance belongs to where it stands, or, if it
    stands beyond the edge of its own tile (by rounding, or by an offset along the normal), to the nearest place within it. None for all of them. So
    each instance belongs to one of any areas that share the plane among them."""
    within = True
    for low, high, first, end, along in ((area[0], area[2], bounds[0], bounds[2], x), (area[1], area[3], bounds[1], bounds[3], z)):
        if low <= first and end <= high:
            continue
        place = np.clip(along, first, np.nextafter(end, -np.inf))
        within = within & (place >= low) & (place < high)
    return None if within is True else within
