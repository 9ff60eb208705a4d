"""Instances as the engine's MultiMeshes have them, and what each of them is drawn for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from bake_files import Bake, Instances, Layer, Tile, center_of, groups_of

TRANSFORM_FLOATS = 12
MORE_FLOATS = 4  # Of a color, and of custom data.
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


def drawn_of(bake: Bake, tile: Tile, instances: Instances, cell: float) -> Iterator[Drawn]:
    """What is drawn of a tile. What looks otherwise with distance, or is not seen from afar, is parted into cells of about `cell` meters, so that this
    happens near where it should."""
    local = instances.positions - center_of(bake, tile)
    parts = max(1, round(bake.tile_size / cell))
    for layer, model, rows in groups_of(bake, tile, instances):
        along = np.floor((local[rows][:, [0, 2]] / bake.tile_size + 0.5) * parts).clip(0, parts - 1).astype(np.int64)
        is_parted = len(layer.models[model].levels) > 1 or 0 < layer.view_distance < FAR_TILES * bake.tile_size
        keys = (along[:, 0] + parts * along[:, 1]) * is_parted
        for key in np.unique(keys):
            chosen = rows[keys == key]
            more = [instances.colors[chosen] / np.float32(255)] if layer.colored else []
            more += [instances.custom[chosen]] if layer.custom_data else []
            here, scales = local[chosen], instances.scales[chosen]
            buffer = buffer_of(here, instances.rotations[chosen], scales, *more)
            yield Drawn(layer, model, len(chosen), buffer, here.min(axis=0), here.max(axis=0), float(np.abs(scales).max()))
