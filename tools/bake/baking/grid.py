"""Which tiles a bake has, and of which tiles of the game each of them consists."""

from __future__ import annotations

import math

import numpy as np


def tile_at(size: float, along: float) -> int:
    """The tile that a coordinate lies in, as the engine counts them: tile n goes from n * size to (n + 1) * size, its end excluded."""
    tile = math.floor(along / size)
    if along < tile * size:  # The division rounds; the edges decide.
        return tile - 1
    return tile + 1 if along >= (tile + 1) * size else tile


def tiles_along(size: float, low: float, high: float) -> range:
    """The tiles that a half-open interval touches."""
    if not low < high:
        return range(0)
    first = tile_at(size, low)
    last = tile_at(size, high)
    return range(first, last + (last * size < high))


def grid_of(rect: list[float], size: float) -> list[int]:
    """First x, first z, columns and rows of the tiles that a rectangle (x, z, width, depth) touches."""
    columns = tiles_along(size, rect[0], rect[0] + rect[2])
    rows = tiles_along(size, rect[1], rect[1] + rect[3])
    return [columns.start, rows.start, len(columns), len(rows)]


def tiles_of(grid: list[int]) -> list[tuple[int, int]]:
    """All tiles of a grid, row by row."""
    return [(grid[0] + column, grid[1] + row) for row in range(grid[3]) for column in range(grid[2])]


def area_of(rect: list[float], size: float, tile: tuple[int, int]) -> tuple[float, float, float, float]:
    """What a tile covers, cut by the bake's rectangle: low x, low z, high x, high z in meters, the high ends excluded."""
    return (
        max(tile[0] * size, rect[0]),
        max(tile[1] * size, rect[1]),
        min((tile[0] + 1) * size, rect[0] + rect[2]),
        min((tile[1] + 1) * size, rect[1] + rect[3]),
    )


def game_tiles(area: tuple[float, float, float, float], size: float) -> list[tuple[int, int]]:
    """The tiles of a layer, of a size in meters, that an area touches."""
    along_z = tiles_along(size, area[1], area[3])
    return [(x, y) for y in along_z for x in tiles_along(size, area[0], area[2])]


def inside(area: tuple[float, float, float, float], size: float, tile: tuple[int, int], x: np.ndarray, z: np.ndarray) -> np.ndarray | None:
    """Which of the positions of a game's tile belong to an area: an instance belongs to where it stands, or, if it stands beyond the
    edge of its own tile (by rounding, or by an offset along the normal), to the nearest place within it. None for all of them. So each
    instance belongs to one of any areas that share the plane among them."""
    within = True
    for low, high, number, along in ((area[0], area[2], tile[0], x), (area[1], area[3], tile[1], z)):
        first, end = number * size, (number + 1) * size
        if low <= first and end <= high:
            continue
        place = np.clip(along, first, np.nextafter(end, -np.inf))
        within = within & (place >= low) & (place < high)
    return None if within is True else within


# Rows that a tile should not have by far, for the sake of a worker's memory: about 300 bytes each.
COMFORTABLE_ROWS = 1.5e6
# Points of a set in the square of its radius, about.
POINTS_PER_RADIUS_SQUARED = 0.7


def default_size(rect: list[float], layers: list[dict]) -> float:
    """Meters of a tile that holds whole tiles of all layers (of each its `tile_size` and `radius`), where that is possible below a
    kilometer: from 256 m on, larger where there would be more than 4,096 of them, up to 2,048 m, and to COMFORTABLE_ROWS if
    instances stood everywhere."""
    sizes = [layer["tile_size"] for layer in layers]
    base = max(sizes)
    if all(size == int(size) for size in sizes):
        common = float(math.lcm(*(int(size) for size in sizes)))
        base = common if common <= 1024.0 else base
    density = sum(POINTS_PER_RADIUS_SQUARED / layer["radius"] ** 2 for layer in layers)
    size = base * math.ceil(256.0 / base)
    while size <= 1024.0 and rect[2] * rect[3] / size**2 > 4096.0 and density * (2.0 * size) ** 2 <= COMFORTABLE_ROWS:
        size *= 2.0
    return size
