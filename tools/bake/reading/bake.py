"""Reads a bake: manifest.json and the Parquet files of tiles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from baking.columns import SCHEMA
from baking.format import MANIFEST, BakeError, name_of, tile_of_name
from baking.location import CannotLocate, absolute, inside, location
from baking.manifest import REMEDY, check_manifest, read_manifest

from .verify import check, parquet_file

if TYPE_CHECKING:
    from baking.location import Location


@dataclass(frozen=True)
class Level:
    """An LOD of a model."""

    path: str  # The path as in the manifest: res://..., or relative to the bake's folder; "" if nothing is drawn.
    begin: float  # The distance in meters at which the LOD begins; 0 for the first one.


@dataclass(frozen=True)
class Model:
    """A model of a layer."""

    name: str
    levels: tuple[Level, ...]  # The LODs, at least one, the finest first.


@dataclass(frozen=True)
class Layer:
    index: int  # The layer's index in the scatter's list and in the tiles.
    name: str
    radius: float  # The minimum distance between two instances in meters.
    colored: bool
    custom_data: bool
    models: tuple[Model, ...]
    # Drawing settings, if the manifest has them. Enumerations have the values of GeometryInstance3D.
    view_distance: float = 0.0  # The view distance in meters; 0 for unlimited.
    cast_shadow: int = 1
    render_layers: int = 1
    material: str = ""  # The path of the material that overrides the materials of the meshes; "" for none.


@dataclass(frozen=True)
class Tile:
    x: int
    z: int
    file: Location
    rows: int
    rows_of_layer: tuple[int, ...]
    digest: str  # The digest of the rows.
    sha256: str  # The digest of the file; "" in manifests of older bakes.
    bounds: tuple[float, ...] | None  # The smallest x, y, z and the largest x, y, z; None if there are no rows.
    is_verified: bool  # True if the file must be compared with the digests before it is read.

    def __str__(self) -> str:
        return name_of((self.x, self.z))

    @property
    def remedy(self) -> str:
        """Returns the instruction that follows an error about an unusable file."""
        return f"bake that tile again: run the command of the bake with --tiles {self}"


@dataclass(frozen=True)
class Bake:
    """The content of manifest.json."""

    folder: Location
    scene: str
    scene_digest: str
    rect: tuple[float, float, float, float]  # x, z, width and depth in world meters.
    tile_size: float  # The edge length of a tile in meters.
    world_offset: tuple[float, float, float]
    layers: tuple[Layer, ...]
    tiles: tuple[Tile, ...] = field(repr=False)  # The tiles, sorted by row, then by column.

    def model_file(self, path: str) -> Location:
        """Returns a file of the bake to which a model or material refers. Raises BakeError if there is no such file."""
        file = inside(self.folder, path)
        if file is None or not file.is_file():
            raise BakeError(f"{self.folder} has no {path}, which its manifest names; bake again")
        return file

    @property
    def rows(self) -> int:
        return sum(tile.rows for tile in self.tiles)

    def layer(self, index: int) -> Layer:
        return next(layer for layer in self.layers if layer.index == index)


def _model(entry: dict) -> Model:
    lods = entry.get("lods") or [{"path": entry.get("path", "")}]
    return Model(entry.get("name", ""), tuple(Level(lod["path"], float(lod.get("distance", 0.0))) for lod in lods))


def _layer(entry: dict) -> Layer:
    return Layer(
        index=int(entry["index"]),
        name=entry.get("name") or f"Layer{int(entry['index'])}",
        radius=float(entry["radius"]),
        colored=entry.get("colored", False),
        custom_data=entry.get("custom_data", False),
        models=tuple(_model(model) for model in entry["models"]),
        view_distance=float(entry.get("view_distance", 0.0)),
        cast_shadow=int(entry.get("cast_shadow", 1)),
        render_layers=int(entry.get("render_layers", 1)),
        material=entry.get("material", ""),
    )


def _tile(folder: Location, key: str, entry: dict, is_verified: bool) -> Tile:
    x, z = tile_of_name(key)
    file = inside(folder, entry["file"])
    if file is None:
        raise BakeError(f"{folder / MANIFEST}: the file of tile {key} is outside of the bake: {entry['file']}; {REMEDY}")
    bounds = entry.get("bounds")
    rows_of_layer = tuple(int(rows) for rows in entry.get("rows_of_layer", []))
    return Tile(x, z, file, int(entry["rows"]), rows_of_layer, entry["digest"], entry.get("sha256", ""), tuple(bounds) if bounds else None, is_verified)


def open_bake(folder: Location | str, verify: bool = True) -> Bake:
    """Reads the manifest of a bake in a folder, or at the URL of an object store. An unfinished bake has only the completed tiles. If `verify` is False, tiles are
    later read without checking their digests. Raises BakeError for a missing bake, for a bake of another version,
    and for invalid values."""
    try:
        folder = absolute(location(folder) if isinstance(folder, str) else folder)
    except CannotLocate as error:
        raise BakeError(str(error)) from None
    manifest = read_manifest(folder)
    check_manifest(manifest, folder / MANIFEST)
    tiles = [_tile(folder, key, entry, verify) for key, entry in manifest["tiles"].items()]
    return Bake(
        folder=folder,
        scene=manifest["scene"],
        scene_digest=manifest["scene_digest"],
        rect=tuple(float(number) for number in manifest["rect"]),
        tile_size=float(manifest["tile_size"]),
        world_offset=tuple(float(number) for number in manifest["world_offset"]),
        layers=tuple(_layer(entry) for entry in manifest["layers"]),
        tiles=tuple(sorted(tiles, key=lambda tile: (tile.z, tile.x))),
    )


def _open_tile(tile: Tile) -> pq.ParquetFile:
    if tile.is_verified:
        check(tile)
    try:
        file = parquet_file(tile.file)
    except (OSError, pa.ArrowException) as error:
        raise BakeError(f"tile {tile} cannot be read: {error}; {tile.remedy}") from None
    if file.metadata.num_rows != tile.rows:
        row_count = file.metadata.num_rows
        file.close()
        raise BakeError(f"{tile.file} has {row_count} rows, but the manifest specifies {tile.rows}; {tile.remedy}")
    return file


def read_batches(tile: Tile, columns: list[str], max_rows: int = 1 << 18) -> Iterator[dict[str, np.ndarray]]:
    """Yields columns of a tile in the file's order, at most `max_rows` rows at a time. Raises BakeError if the file is
    missing or damaged, if it lacks a column, or if its number of rows or its digest differs from the manifest. The
    digest is checked only if the bake was opened with `verify`. For a tile that has no rows in the manifest, yields
    nothing and does not open the file."""
    if tile.rows == 0:
        return
    with _open_tile(tile) as file:
        missing = [name for name in columns if name not in file.schema_arrow.names]
        if missing:
            raise BakeError(f"{tile.file} has no column {missing[0]}; bake again with --fresh")
        try:
            for batch in file.iter_batches(batch_size=max_rows, columns=columns):
                yield {name: _numbers(batch.column(name)) for name in columns}
        except (OSError, pa.ArrowException) as error:
            raise BakeError(f"{tile.file} is damaged: {error}; {tile.remedy}") from None


def _numbers(column: pa.Array) -> np.ndarray:
    """Returns a column as an array. Only colors and custom data can be null: null colors become white, and null custom
    data become NaN."""
    return column.fill_null(0xFFFFFFFF if column.type == pa.uint32() else 0 if pa.types.is_integer(column.type) else float("nan")).to_numpy(
        zero_copy_only=False
    )


@dataclass(frozen=True)
class Instances:
    """The rows of a tile in the file's order, which is by layer, then by ID. Each array has one entry per row."""

    ids: np.ndarray  # uint64
    layers: np.ndarray  # uint16
    models: np.ndarray  # uint16
    positions: np.ndarray  # float64, n by 3: x, y, z in world meters.
    rotations: np.ndarray  # float32, n by 4: unit quaternions x, y, z, w.
    scales: np.ndarray  # float32, n by 3
    ranks: np.ndarray  # uint32
    colors: np.ndarray  # uint8, n by 4, the shader's COLOR: red, green, blue, alpha; white in layers without colors.
    custom: np.ndarray  # float32, n by 4, INSTANCE_CUSTOM: variation, wind phase, rank, scale; 0 in layers without custom data.

    def __len__(self) -> int:
        return len(self.ids)


def read_tile(tile: Tile) -> Instances:
    """Returns all instances of a tile. Raises BakeError in the same cases as read_batches."""
    batches = list(read_batches(tile, SCHEMA.names))
    columns = {name: np.concatenate([batch[name] for batch in batches]) if batches else np.zeros(0) for name in SCHEMA.names}
    scale = columns["scale_x"]
    has_custom = ~np.isnan(columns["wind_phase"])
    custom = np.stack([columns["variation"], columns["wind_phase"], columns["rank"] / 2.0**32, np.abs(scale)], axis=1)
    return Instances(
        ids=columns["id"].astype(np.uint64),
        layers=columns["layer"].astype(np.uint16),
        models=columns["model"].astype(np.uint16),
        positions=np.stack([columns[axis] for axis in "xyz"], axis=1).astype(np.float64),
        rotations=np.stack([columns["q" + axis] for axis in "xyzw"], axis=1).astype(np.float32),
        scales=np.stack([columns["scale_" + axis] for axis in "xyz"], axis=1).astype(np.float32),
        ranks=columns["rank"].astype(np.uint32),
        colors=columns["color"].astype("<u4").view(np.uint8).reshape(-1, 4),
        custom=np.where(has_custom[:, None], custom, 0.0).astype(np.float32),
    )


def center_of(bake: Bake, tile: Tile) -> np.ndarray:
    """Returns the origin of a tile's local coordinates, in world meters and double precision. It is the center of the
    tile's square, at the middle of its height range, which is rounded to a whole meter."""
    height = 0.0 if tile.bounds is None else float(np.round((tile.bounds[1] + tile.bounds[4]) / 2))
    return np.array([(tile.x + 0.5) * bake.tile_size, height, (tile.z + 0.5) * bake.tile_size])


def groups_of(bake: Bake, tile: Tile, instances: Instances) -> Iterator[tuple[Layer, int, np.ndarray]]:
    """Yields for each layer and model in a tile the layer, the model's index, and the indices of its instances, sorted
    by rank. Skips models without instances. Raises BakeError for a layer or a model that is not in the manifest."""
    layers = {layer.index: layer for layer in bake.layers}
    keys = instances.layers.astype(np.uint32) << 16 | instances.models
    order = np.lexsort((instances.ids, instances.ranks, keys))
    sorted_keys = keys[order]
    starts = np.flatnonzero(np.r_[len(order) > 0, sorted_keys[1:] != sorted_keys[:-1]]) if len(order) else []
    for position, start in enumerate(starts):
        end = starts[position + 1] if position + 1 < len(starts) else len(order)
        index, model = int(sorted_keys[start] >> 16), int(sorted_keys[start] & 0xFFFF)
        if index not in layers or model >= len(layers[index].models):
            raise BakeError(f"{tile.file} has instances of layer {index}, model {model}, which is not in the manifest; {tile.remedy}")
        yield layers[index], model, order[start:end]
