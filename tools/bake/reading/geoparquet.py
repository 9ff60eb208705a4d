"""Writes each tile of a bake as GeoParquet 1.1, for geographic information systems and data frames. See READERS.md."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from baking.format import BakeError
from baking.whole_file import write_whole

from .bake import Bake, Instances, Tile, groups_of, open_bake, read_tile
from .options import add_folder, tiles_to_export, vector
from .say import say

GEOMETRY, BBOX = "geometry", "bbox"
# A row group should cover a small area, so that readers can skip most of a file, but contain enough rows to compress well.
ROW_GROUP_ROWS = 1 << 15
_POINT = pa.struct([pa.field(axis, pa.float64(), nullable=False) for axis in "xyz"])
_BOX = pa.struct([pa.field(name, pa.float64(), nullable=False) for name in ("xmin", "ymin", "xmax", "ymax")])
_WKB_POINT = np.dtype([("order", "u1"), ("type", "<u4"), ("place", "<f8", 3)])
_WKB_LITTLE_ENDIAN, _WKB_POINT_Z = 1, 1001


def map_axes(vectors: np.ndarray) -> np.ndarray:
    """Converts x, y (up), z (south) to x (east), y (north), z (up)."""
    return np.stack([vectors[:, 0], -vectors[:, 2], vectors[:, 1]], axis=1)


def projected(crs: str) -> dict:
    """Returns the PROJJSON of a coordinate reference system. Raises BakeError unless it is projected, in meters."""
    try:
        import pyproj
    except ImportError:
        raise BakeError("--crs needs the Python package pyproj; bake_export.sh installs it") from None
    try:
        system = pyproj.CRS.from_user_input(crs)
    except pyproj.exceptions.CRSError:
        raise BakeError(f"--crs must be a known coordinate reference system such as EPSG:32632, got {crs}") from None
    if not system.is_projected or any(axis.unit_name != "metre" for axis in system.axis_info):
        raise BakeError(f"--crs must be a projected coordinate reference system in meters, such as EPSG:32632, got {crs}: {system.name}")
    return system.to_json_dict()


def tile_table(bake: Bake, tile: Tile, crs: dict | None, origin: np.ndarray, is_wkb: bool) -> pa.Table:
    """Returns the instances of a tile, sorted by space, with the metadata of GeoParquet."""
    instances = read_tile(tile)
    positions = map_axes(instances.positions) + origin
    order = _spatial_order(positions)
    names = _names(bake, tile, instances)
    positions, rotations, scales = positions[order], map_axes(instances.rotations[order]), instances.scales[order]
    layers = instances.layers[order]
    colored, custom = (np.isin(layers, [layer.index for layer in bake.layers if getattr(layer, attribute)]) for attribute in ("colored", "custom_data"))
    columns = {
        "id": instances.ids[order],
        **{name: pa.DictionaryArray.from_arrays(codes[order], pa.array(values, pa.string())) for name, (codes, values) in names.items()},
        **{f"q{axis}": rotations[:, column] for column, axis in enumerate("xyz")},
        "qw": instances.rotations[order, 3],
        # Nearly all instances have the same scale along all axes. A null takes almost no space.
        "scale": scales[:, 0],
        **{f"scale_{axis}": pa.array(scales[:, row], mask=scales[:, row] == scales[:, 0]) for axis, row in (("y", 2), ("z", 1))},
        "rank": instances.ranks[order],
        "color": pa.array(np.ascontiguousarray(instances.colors[order]).view("<u4").ravel(), mask=~colored),
        "variation": pa.array(instances.custom[order, 0], mask=~custom),
        "wind_phase": pa.array(instances.custom[order, 1], mask=~custom),
        **_geometry(positions, is_wkb),
    }
    box = [*positions.min(axis=0).tolist(), *positions.max(axis=0).tolist()]
    column_metadata = {"encoding": "WKB" if is_wkb else "point", "geometry_types": ["Point Z"], "crs": crs, "bbox": box}
    if is_wkb:
        column_metadata["covering"] = {BBOX: {corner: [BBOX, corner] for corner in ("xmin", "ymin", "xmax", "ymax")}}
    geo = {"version": "1.1.0", "primary_column": GEOMETRY, "columns": {GEOMETRY: column_metadata}}
    layers = {str(layer.index): {"name": layer.name, "radius": layer.radius} for layer in bake.layers}
    metadata = {"geo": json.dumps(geo), "thicket.tile": str(tile), "thicket.scene_digest": bake.scene_digest, "thicket.layers": json.dumps(layers)}
    return pa.table(columns).replace_schema_metadata(metadata)


def _names(bake: Bake, tile: Tile, instances: Instances) -> dict[str, tuple[np.ndarray, list[str]]]:
    """Returns the columns `layer` and `model`: an index for each instance, and the names for the indices."""
    layer_codes, model_codes = np.zeros(len(instances), np.int32), np.zeros(len(instances), np.int32)
    models: list[str] = []
    for layer, model, rows in groups_of(bake, tile, instances):
        layer_codes[rows] = bake.layers.index(layer)
        model_codes[rows] = len(models)
        models.append(layer.models[model].name or Path(layer.models[model].levels[0].path).stem or f"{layer.name}_{model}")
    return {"layer": (layer_codes, [layer.name for layer in bake.layers]), "model": (model_codes, models)}


def _geometry(positions: np.ndarray, is_wkb: bool) -> dict[str, pa.Array]:
    """Returns the geometry column. Readers skip row groups by the statistics of its fields or, with WKB, of a column with
    bounding boxes."""
    x, y, z = np.ascontiguousarray(positions.T)
    if not is_wkb:
        return {GEOMETRY: pa.StructArray.from_arrays([pa.array(axis) for axis in (x, y, z)], fields=list(_POINT))}
    points = np.empty(len(positions), _WKB_POINT)
    points["order"], points["type"], points["place"] = _WKB_LITTLE_ENDIAN, _WKB_POINT_Z, positions
    offsets = pa.array(np.arange(len(positions) + 1, dtype=np.int32) * _WKB_POINT.itemsize)
    binary = pa.Array.from_buffers(pa.binary(), len(positions), [None, offsets.buffers()[1], pa.py_buffer(points.tobytes())])
    return {GEOMETRY: binary, BBOX: pa.StructArray.from_arrays([pa.array(bound) for bound in (x, y, x, y)], fields=list(_BOX))}


def _spatial_order(positions: np.ndarray) -> np.ndarray:
    """Returns the order of positions along a Z-order curve, which keeps neighbors together."""
    low, high = positions[:, :2].min(axis=0), positions[:, :2].max(axis=0)
    cells = ((positions[:, :2] - low) / np.maximum(high - low, 1e-9).max() * 0xFFFF).astype(np.uint64)
    code = np.zeros(len(positions), np.uint64)
    for bit in range(16):
        for axis in (0, 1):
            code |= (cells[:, axis] >> np.uint64(bit) & np.uint64(1)) << np.uint64(2 * bit + axis)
    return np.argsort(code, kind="stable")


def _content(table: pa.Table) -> pa.Buffer:
    split_columns = [path for path in ("qx", "qy", "qz", "qw", "scale", "variation", "wind_phase")]
    split_columns += [f"{GEOMETRY}.{axis}" for axis in "xyz"] if pa.types.is_struct(table.schema.field(GEOMETRY).type) else []
    sink = pa.BufferOutputStream()
    pq.write_table(
        table, sink, compression="zstd", row_group_size=ROW_GROUP_ROWS, use_dictionary=["layer", "model"],
        column_encoding=dict.fromkeys(split_columns, "BYTE_STREAM_SPLIT"), write_page_checksum=True,
    )  # fmt: skip
    return sink.getvalue()


def add_options(parser: argparse.ArgumentParser) -> None:
    add_folder(parser, "tile_I_J.parquet")
    parser.add_argument("--crs", default="", metavar="EPSG:N", help="the projected coordinate reference system of the files, in meters; by default none")
    parser.add_argument(
        "--origin", type=vector, default=np.zeros(3), metavar="E,N,H",
        help="the easting, northing and height of the world's origin, in meters; it is added to all positions",
    )  # fmt: skip
    parser.add_argument("--wkb", action="store_true", help="encode positions as WKB, for programs without native encodings (GeoParquet 1.0)")


def export(options: argparse.Namespace) -> None:
    """Writes a file for each tile that has rows. Raises BakeError for an invalid option before it writes anything."""
    crs = projected(options.crs) if options.crs else None
    bake = open_bake(options.bake, options.verify)
    tiles = tiles_to_export(bake, options.tiles.split())
    if options.folder.resolve() == bake.folder / "tiles":  # Both write files with the same names.
        raise BakeError(f"{options.folder} is the bake itself: choose another folder")
    options.folder.mkdir(parents=True, exist_ok=True)
    for tile in tiles:
        write_whole(options.folder / f"tile_{tile.x}_{tile.z}.parquet", _content(tile_table(bake, tile, crs, options.origin, options.wkb)))
    say(f"wrote {sum(tile.rows for tile in tiles)} instances in {len(tiles)} tiles to {options.folder}")
