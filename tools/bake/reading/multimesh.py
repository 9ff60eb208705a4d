"""Converts instances to the format of Godot's MultiMesh, divided into cells for LODs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .bake import Bake, Instances, Layer, Tile, center_of, groups_of

TRANSFORM_FLOATS = 12
EXTRA_FLOATS = 4  # The number of floats of a color or of custom data.
SMALLEST_CELL = 16.0  # The minimum edge length of a cell in meters.
FAR_TILES = 4  # The distance, in tiles, at which a whole tile may appear in one step.


@dataclass(frozen=True)
class DrawGroup:
    """Instances of one model that are drawn together, in a tile or in one of its cells."""

    layer: Layer
    model: int
    count: int
    buffer: np.ndarray  # float32, the content of MultiMesh.buffer, relative to the tile's center.
    least: np.ndarray  # The bounds of the positions, in meters from the tile's center.
    greatest: np.ndarray
    largest_scale: float

    @property
    def reach(self) -> float:
        """Returns an upper bound of the distance in meters from the center of the bounds to an instance."""
        return float(np.linalg.norm(self.greatest - self.least) / 2)


def buffer_of(positions: np.ndarray, rotations: np.ndarray, scales: np.ndarray, *extra: np.ndarray) -> np.ndarray:
    """Returns the content of MultiMesh.buffer: n by 12 floats, and 4 more for each array in `extra` (colors, then custom
    data). The 12 floats are the rows of the basis, each followed by a coordinate of the position. `positions` are n by
    3 in double precision, relative to a nearby origin."""
    x, y, z, w = (rotations / np.linalg.norm(rotations, axis=1, keepdims=True)).astype(np.float64).T
    basis = np.empty((len(positions), 3, 3))
    basis[:, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=1)
    basis[:, 1] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=1)
    basis[:, 2] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=1)
    buffer = np.empty((len(positions), TRANSFORM_FLOATS + EXTRA_FLOATS * len(extra)), np.float32)
    rows = buffer[:, :TRANSFORM_FLOATS].reshape(-1, 3, 4)
    rows[:, :, :3] = basis * scales[:, None, :]
    rows[:, :, 3] = positions
    for index, values in enumerate(extra):
        start = TRANSFORM_FLOATS + EXTRA_FLOATS * index
        buffer[:, start : start + EXTRA_FLOATS] = values
    return buffer


def parts_of(bake: Bake, layer: Layer, model: int, cell: float) -> int:
    """Returns the number of cells along each side of a tile for a model. The number is 1 if nothing changes with distance, or
    if the model has one LOD that disappears so far away that a whole tile may disappear in one step. Otherwise, the edge length
    of a cell is about `cell` meters. Cells are smaller if the first change happens at a short distance, so that not all of a
    dense meadow is drawn with the finest LOD."""
    levels = layer.models[model].levels
    nearest = levels[1].begin if len(levels) > 1 else layer.view_distance
    if nearest <= 0 or (len(levels) == 1 and nearest >= FAR_TILES * bake.tile_size):
        return 1
    return max(1, round(bake.tile_size / min(cell, max(SMALLEST_CELL, 2 * nearest))))


def draw_groups_of(bake: Bake, tile: Tile, instances: Instances, cell: float) -> Iterator[DrawGroup]:
    """Yields the parts of a tile to draw: for each layer and model, one part for the tile or one for each cell with
    instances."""
    local = instances.positions - center_of(bake, tile)
    for layer, model, rows in groups_of(bake, tile, instances):
        cell_count = parts_of(bake, layer, model, cell)
        cells = np.floor((local[rows][:, [0, 2]] / bake.tile_size + 0.5) * cell_count).clip(0, cell_count - 1).astype(np.int64)
        keys = cells[:, 0] + cell_count * cells[:, 1]
        for key in np.unique(keys):
            selected_rows = rows[keys == key]
            extra = [instances.colors[selected_rows] / np.float32(255)] if layer.colored else []
            extra += [instances.custom[selected_rows]] if layer.custom_data else []
            positions, scales = local[selected_rows], instances.scales[selected_rows]
            buffer = buffer_of(positions, instances.rotations[selected_rows], scales, *extra)
            yield DrawGroup(layer, model, len(selected_rows), buffer, positions.min(axis=0), positions.max(axis=0), float(np.abs(scales).max()))
