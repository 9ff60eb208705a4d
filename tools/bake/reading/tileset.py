"""Describes exported tiles as a 3D Tiles 1.1 tileset, so that viewers load only the tiles near the camera."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from baking.whole_file import write_whole

TILESET = "tileset.json"
# A viewer loads the content of a node when the node's error is more than about 16 pixels. With this fraction of the node's
# edge length as its error, it loads tiles at a distance of up to about 8 times their edge length.
ERROR = 1 / 8


@dataclass(frozen=True)
class ExportedTile:
    """A tile that was exported."""

    x: int
    z: int
    file: str
    low: np.ndarray  # The corners of the bounding box in meters: x, y (up), z, relative to the origin of the files.
    high: np.ndarray


def write_tileset(folder: Path, tiles: list[ExportedTile], tile_size: float) -> None:
    """Writes the tileset. If that fails, raises CannotWrite and keeps the old file."""
    root = _tree(tiles, tile_size)
    content = {"asset": {"version": "1.1", "generator": "Thicket"}, "geometricError": 2.0 * root["geometricError"] + tile_size, "root": {**root, "refine": "ADD"}}
    write_whole(folder / TILESET, json.dumps(content, separators=(",", ":")).encode())


def _tree(tiles: list[ExportedTile], tile_size: float) -> dict:
    """Returns the root of a quadtree whose leaves are the tiles."""
    first_x, first_z = min(tile.x for tile in tiles), min(tile.z for tile in tiles)
    nodes = {
        (tile.x - first_x, tile.z - first_z): (_node(tile.low, tile.high, 0.0, {"content": {"uri": tile.file}}), tile.low, tile.high) for tile in tiles
    }
    size = tile_size
    while len(nodes) > 1 or size == tile_size:
        size *= 2.0
        groups: dict[tuple[int, int], list[tuple]] = {}
        for (x, z), node in nodes.items():
            groups.setdefault((x >> 1, z >> 1), []).append(node)
        nodes = {}
        for cell, group in groups.items():
            low, high = np.min([node[1] for node in group], axis=0), np.max([node[2] for node in group], axis=0)
            nodes[cell] = _node(low, high, ERROR * size, {"children": [node[0] for node in group]}), low, high
    return next(iter(nodes.values()))[0]


def _node(low: np.ndarray, high: np.ndarray, error: float, content: dict) -> dict:
    """Returns a node with a bounding box. Tilesets have z up, so y and z are swapped, as viewers do with glTF files."""
    (x, y, z), (half_x, half_y, half_z) = ((low + high) / 2).tolist(), ((high - low) / 2).tolist()
    return {"boundingVolume": {"box": [x, -z, y, half_x, 0, 0, 0, half_z, 0, 0, 0, half_y]}, "geometricError": error, **content}
