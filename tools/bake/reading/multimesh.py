"""Instances as the engine's MultiMeshes have them, and what each of them is drawn for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .bake import Bake, Instances, Layer, Tile, center_of, groups_of

TRANSFORM_FLOATS = 12
MORE_FLOATS = 4  # Of a color, and of custom data.
SMALLEST_CELL = 16.0  # Meters.
FAR_TILES = 4  # As many tiles away it does not matter if a whole tile comes into sight at once.


@dataclass(frozen=True)
class Drawn:
    """Instances of one model that are drawn together: those of a tile, or of a cell of it."""

    layer: Layer
    model: int
    count: int
    buffer: np.ndarray  # float32: what MultiMesh.buffer takes; around the tile's center.
    least: np.ndarray  # The box around their positions, in meters from the tile's center.
    greatest: np.ndarray
    largest_scale: float

    @property
    def reach(self) -> float:
        """Meters from the middle of the box to the farthest instance, at most."""
        return float(np.linalg.norm(self.greatest - self.least) / 2)


def buffer_of(positions: np.ndarray, rotations: np.ndarray, scales: np.ndarray, *more: np.ndarray) -> np.ndarray:
    """As MultiMesh.buffer wants it, n by 12 floats and 4 for each of `more`: the rows of the basis, each with a number of the position after it, then colors,
    then custom data. Positions are n by 3 in double precision and already count from where they are near 0."""
    x, y, z, w = (rotations / np.linalg.norm(rotations, axis=1, keepdims=True)).astype(np.float64).T
    basis = np.empty((len(positions), 3, 3))
    basis[:, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=1)
    basis[:, 1] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=1)
    basis[:, 2] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=1)
    buffer = np.empty((len(positions), TRANSFORM_FLOATS + MORE_FLOATS * len(more)), np.float32)
    rows = buffer[:, :TRANSFORM_FLOATS].reshape(-1, 3, 4)
    rows[:, :, :3] = basis * scales[:, None, :]
    rows[:, :, 3] = positions
    for number, values in enumerate(more):
        start = TRANSFORM_FLOATS + MORE_FLOATS * number
        buffer[:, start : start + MORE_FLOATS] = values
    return buffer


def parts_of(bake: Bake, layer: Layer, model: int, cell: float) -> int:
    """Into how many cells a side of a tile is parted for a model: one where nothing changes with distance, or only so far away that a whole tile may change
    at once. A cell is `cell` meters at most, and smaller where the first change comes near, or all of a dense meadow would be drawn as finely as its first meters."""
    levels = layer.models[model].levels
    nearest = levels[1].begin if len(levels) > 1 else layer.view_distance
    if nearest <= 0 or (len(levels) == 1 and nearest >= FAR_TILES * bake.tile_size):
        return 1
    return max(1, round(bake.tile_size / min(cell, max(SMALLEST_CELL, 2 * nearest))))


def drawn_of(bake: Bake, tile: Tile, instances: Instances, cell: float) -> Iterator[Drawn]:
    """What is drawn of a tile: for each layer and model one part, or one for each cell in which something stands."""
    local = instances.positions - center_of(bake, tile)
    for layer, model, rows in groups_of(bake, tile, instances):
        parts = parts_of(bake, layer, model, cell)
        along = np.floor((local[rows][:, [0, 2]] / bake.tile_size + 0.5) * parts).clip(0, parts - 1).astype(np.int64)
        keys = along[:, 0] + parts * along[:, 1]
        for key in np.unique(keys):
            chosen = rows[keys == key]
            more = [instances.colors[chosen] / np.float32(255)] if layer.colored else []
            more += [instances.custom[chosen]] if layer.custom_data else []
            here, scales = local[chosen], instances.scales[chosen]
            buffer = buffer_of(here, instances.rotations[chosen], scales, *more)
            yield Drawn(layer, model, len(chosen), buffer, here.min(axis=0), here.max(axis=0), float(np.abs(scales).max()))
