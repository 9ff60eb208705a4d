"""Describes the tiles of a bake, as the engine defines them, and determines which instances belong to a tile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Bounds = tuple[float, float, float, float]  # Min x, min z, max x, max z in world meters. The maxima are excluded.


@dataclass(frozen=True)
class TileGrid:
    """The grid of a bake's tiles, as bake_grid.gd describes it."""

    tile_size: float  # The edge length of a tile in meters.
    grid: tuple[int, int, int, int]  # First column, first row, number of columns, number of rows.
    # The positions, in meters, of the edges of the columns, and then of the edges of the rows. The edges of the rectangle are
    # included.
    edges: tuple[tuple[float, ...], tuple[float, ...]]

    @classmethod
    def of(cls, described: dict) -> TileGrid:
        """Returns the grid that an engine has described."""
        edges_x, edges_z = (tuple(map(float, edges)) for edges in described["edges"])
        return cls(float(described["tile_size"]), tuple(map(int, described["grid"])), (edges_x, edges_z))

    def tiles(self) -> list[tuple[int, int]]:
        """Returns all tiles, row by row."""
        first_x, first_z, columns, rows = self.grid
        return [(first_x + column, first_z + row) for row in range(rows) for column in range(columns)]

    def __contains__(self, tile: tuple[int, int]) -> bool:
        return 0 <= tile[0] - self.grid[0] < self.grid[2] and 0 <= tile[1] - self.grid[1] < self.grid[3]

    def area_of(self, tile: tuple[int, int]) -> Bounds:
        """Returns the area of a tile, clipped by the bake's rectangle."""
        column, row = tile[0] - self.grid[0], tile[1] - self.grid[1]
        return (self.edges[0][column], self.edges[1][row], self.edges[0][column + 1], self.edges[1][row + 1])


def inside(area: Bounds, bounds: Bounds, x: np.ndarray, z: np.ndarray) -> np.ndarray | None:
    """Returns a mask of the positions that belong to `area`, or None if all of them do. The positions are those of the
    instances in one of the game's tiles, whose edges are `bounds`. Rounding, or an offset along the normal, can move an
    instance out of its tile. Such an instance belongs to the area that contains the nearest position inside the tile.
    If areas cover the plane without overlap, each instance therefore belongs to exactly one area."""
    mask = True
    for low, high, first, end, coordinates in ((area[0], area[2], bounds[0], bounds[2], x), (area[1], area[3], bounds[1], bounds[3], z)):
        if low <= first and end <= high:
            continue
        clamped = np.clip(coordinates, first, np.nextafter(end, -np.inf))
        mask = mask & (clamped >= low) & (clamped < high)
    return None if mask is True else mask
