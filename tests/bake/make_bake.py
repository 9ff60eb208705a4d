"""Writes a small bake for the tests of the bake readers, in the format of the baker, and its content as arrays. Runs
with the Python environment of tools/bake.

    make_bake.py FOLDER

The world is far from the origin. It contains a tile without rows, all kinds of models, and instances slightly outside
their tile. The layer indices have a gap, as if a layer between two others had not been baked. FOLDER/expected.npz
contains the concatenated columns of all tiles and the tile of each row."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools/bake"))
from baking import rows  # noqa: E402 (only on the path above)
from baking.columns import SCHEMA  # noqa: E402

TILE_SIZE = 50.0
OFFSET = (3_000_000.0, 16.0, -1_000_000.0)
FIRST = (60_000, -20_002)  # The column and row of the first tile.
COLUMNS, ROWS = 4, 3
EMPTY = (60_002, -20_001)
RECT = [3_000_010.0, -1_000_100.0, 180.0, 130.0]
LAYERS = [
    {
        "index": 0, "name": "Oak", "radius": 6.0, "levels": 3, "colored": True, "custom_data": True, "tile_size": 64.0,
        "models": [
            {"path": "res://oak.tres", "name": "oak", "lods": [{"path": "res://oak.tres", "distance": 0.0}, {"path": "res://far.tres", "distance": 40.0}]},
            {"path": "res://rock.tscn", "name": "rock", "lods": [{"path": "models/0_1.res", "distance": 0.0}]},
        ],
    },
    {
        "index": 2, "name": "Grass", "radius": 1.0, "levels": 1, "colored": False, "custom_data": False, "tile_size": 16.0, "view_distance": 70.0,
        "models": [{"path": "models/2_0.res", "name": "tuft"}, {"path": "", "name": ""}],
    },
]  # fmt: skip
PER_TILE = {0: 40, 2: 200}


def rows_of(x: int, z: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Returns the columns of a tile: instances at random positions in the tile's part of the rectangle, except for one
    instance that is 3 cm outside."""
    low = np.maximum([x * TILE_SIZE, z * TILE_SIZE], RECT[:2])
    high = np.minimum([(x + 1) * TILE_SIZE, (z + 1) * TILE_SIZE], [RECT[0] + RECT[2], RECT[1] + RECT[3]])
    counts = {layer: 0 if (x, z) == EMPTY else count for layer, count in PER_TILE.items()}
    layer = np.repeat(list(counts), list(counts.values())).astype(np.uint16)
    count = len(layer)
    place = rng.uniform(low, high, (count, 2))
    if count:
        place[0, 0] = high[0] + 0.03
    turn = rng.normal(size=(count, 4))
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    scale = np.repeat(rng.uniform(0.5, 2.0, (count, 1)), 3, axis=1)
    if count > 1:
        scale[1] = -1.5  # A negative scale mirrors the instance, as a designer may do manually.
    oak = layer == 0
    return {
        "id": np.arange(count, dtype=np.uint64) + np.uint64((x - FIRST[0]) * 1000 + (z - FIRST[1]) * 10**6),
        "layer": layer,
        "model": np.where(oak, rng.integers(0, 2, count), rng.random(count) > 0.99).astype(np.uint16),
        "x": place[:, 0], "y": rng.uniform(900.0, 950.0, count), "z": place[:, 1],
        **{name: turn[:, axis].astype(np.float32) for axis, name in enumerate(("qx", "qy", "qz", "qw"))},
        **{name: scale[:, axis].astype(np.float32) for axis, name in enumerate(("scale_x", "scale_y", "scale_z"))},
        "rank": rng.integers(0, 2**32, count, dtype=np.uint32),
        "color": rng.integers(0, 2**32, count, dtype=np.uint32),
        "variation": rng.random(count, np.float32), "wind_phase": rng.random(count, np.float32),
    }  # fmt: skip


def write_tile(folder: Path, x: int, z: int, columns: dict[str, np.ndarray]) -> dict:
    """Writes a tile. Returns its entry for the manifest."""
    oak = columns["layer"] == 0
    nullable = ("color", "variation", "wind_phase")
    table = pa.table({name: pa.array(values, mask=~oak if name in nullable else None) for name, values in columns.items()})
    table = pa.Table.from_arrays(table.columns, schema=SCHEMA)
    digest = rows.digest(rows.to_columns(table))
    table = table.replace_schema_metadata({"thicket.tile": f"{x},{z}", "thicket.scene_digest": "5ce7e", "thicket.digest": digest})
    file = f"tiles/tile_{x}_{z}.parquet"
    pq.write_table(table, folder / file, compression="zstd", row_group_size=64)
    places = np.stack([columns[axis] for axis in "xyz"], axis=1)
    return {
        "file": file,
        "rows": len(oak),
        "rows_of_layer": [int((columns["layer"] == layer["index"]).sum()) for layer in LAYERS],
        "digest": digest,
        "sha256": hashlib.sha256((folder / file).read_bytes()).hexdigest(),
        "bounds": [*places.min(axis=0), *places.max(axis=0)] if len(oak) else None,
    }


def main() -> None:
    folder = Path(sys.argv[1])
    (folder / "tiles").mkdir(parents=True)
    rng = np.random.default_rng(6)
    tiles, everything = {}, []
    for z in range(FIRST[1], FIRST[1] + ROWS):
        for x in range(FIRST[0], FIRST[0] + COLUMNS):
            columns = rows_of(x, z, rng)
            tiles[f"{x},{z}"] = write_tile(folder, x, z, columns)
            everything.append({**columns, "tile_x": np.full(len(columns["id"]), x), "tile_z": np.full(len(columns["id"]), z)})
    manifest = {
        "format": "thicket-bake", "version": 1, "scene": "res://world.tscn", "scene_digest": "5ce7e", "seed": 7, "rect": RECT,
        "tile_size": TILE_SIZE, "grid": [*FIRST, COLUMNS, ROWS], "world_offset": OFFSET, "layers": LAYERS, "tiles": tiles, "complete": True,
    }  # fmt: skip
    (folder / "manifest.json").write_text(json.dumps(manifest))
    np.savez(folder / "expected.npz", **{name: np.concatenate([part[name] for part in everything]) for name in everything[0]})


if __name__ == "__main__":
    main()
