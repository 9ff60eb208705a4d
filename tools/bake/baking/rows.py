"""Converts rows of instances between the formats of the engine and the files."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np
import pyarrow as pa

from .columns import SCHEMA

_HEADER_BYTES = 16

Columns = dict[str, np.ndarray]


class BadRows(ValueError):
    """Raised for data that is not a table of rows."""


def parse(data: bytes | bytearray, layer: int, dtypes: dict[str, str]) -> tuple[Columns, int]:
    """Returns a tuple: the columns of ScatterTile.get_rows, extended by the missing columns of SCHEMA, and the number of
    instances with a shear. `layer` is the layer's index, and `dtypes` the result of its ScatterLayer.get_row_columns.
    Raises BadRows if the size does not match."""
    if len(data) < _HEADER_BYTES:
        raise BadRows(f"{len(data)} bytes are too few for rows")
    rows, _, sheared, _ = (int(number) for number in np.frombuffer(data, "<u4", 4))
    expected = _HEADER_BYTES + rows * sum(np.dtype(dtype).itemsize for dtype in dtypes.values())
    if len(data) != expected:
        raise BadRows(f"{rows} rows must have {expected} bytes, got {len(data)}")
    columns: Columns = {}
    offset = _HEADER_BYTES
    for name, dtype in dtypes.items():
        columns[name] = np.frombuffer(data, dtype, rows, offset)
        offset += columns[name].nbytes
    columns["layer"] = np.full(rows, layer, np.uint16)
    _add_default_columns(columns, rows)
    return columns, sheared


def _add_default_columns(columns: Columns, rows: int) -> None:
    color = np.zeros(rows, np.uint32)
    has_color, has_custom = "color_r" in columns, "variation" in columns
    if has_color:
        for index, channel in enumerate("rgba"):
            value = np.clip(columns[f"color_{channel}"], 0.0, 1.0)
            color |= np.rint(value * np.float32(255.0)).astype(np.uint32) << np.uint32(8 * index)
    columns["color"] = color
    for name in ("variation", "wind_phase"):
        columns.setdefault(name, np.zeros(rows, np.float32))
    columns["has_color"], columns["has_custom"] = np.full(rows, has_color), np.full(rows, has_custom)


def joined(parts: list[Columns]) -> Columns:
    """Returns all rows of the parts, sorted by layer, then by ID."""
    if not parts:
        empty = to_columns(SCHEMA.empty_table())
        return {name: empty[name] for name in [*SCHEMA.names, "has_color", "has_custom"]}
    all_rows = {name: np.concatenate([part[name] for part in parts]) for name in [*SCHEMA.names, "has_color", "has_custom"]}
    order = np.lexsort((all_rows["id"], all_rows["layer"]))
    return {name: column.take(order) for name, column in all_rows.items()}


# The name of the mask of each nullable column. The mask is true where the column has a value.
_MASKS = {"color": "has_color", "variation": "has_custom", "wind_phase": "has_custom"}


def to_table(columns: Columns) -> pa.Table:
    """Returns the rows as a table with SCHEMA."""
    arrays = []
    for field in SCHEMA:
        mask = ~columns[_MASKS[field.name]] if field.name in _MASKS else None
        arrays.append(pa.array(columns[field.name], field.type, mask=mask))
    return pa.Table.from_arrays(arrays, schema=SCHEMA)


def to_columns(table: pa.Table) -> Columns:
    """Returns the rows of a table. Raises BadRows unless it has SCHEMA."""
    if not table.schema.remove_metadata().equals(SCHEMA):
        raise BadRows("its columns are different")
    columns: Columns = {}
    for name in SCHEMA.names:
        columns[name], mask = column_of(table, name)
        if mask is not None:
            columns[_MASKS[name]] = mask
    return columns


def column_of(table: pa.Table, name: str) -> tuple[np.ndarray, np.ndarray | None]:
    """Returns a column of a table, with 0 for null, and a mask that is true for non-null values. The mask is None for
    columns that are not nullable."""
    column = table[name].combine_chunks()
    column = column.chunk(0) if isinstance(column, pa.ChunkedArray) and column.num_chunks else column
    if isinstance(column, pa.ChunkedArray):
        column = pa.array([], column.type)
    mask = None
    if name in _MASKS:
        mask = column.is_valid().to_numpy(zero_copy_only=False)
        column = column.fill_null(0)
    return column.to_numpy(zero_copy_only=False), mask


def digest(columns: Columns) -> str:
    """Returns the SHA-256 of sorted rows, in hexadecimal digits. For each column in the order of SCHEMA, the hash
    contains its name, a zero byte and its little-endian numbers, with 0 for null. Before the numbers of a nullable
    column, there is one byte per row: 1 if the row has a value."""
    return digest_of((columns[name], columns.get(_MASKS.get(name, ""))) for name in SCHEMA.names)


def digest_of(columns: Iterable[tuple[np.ndarray, np.ndarray | None]]) -> str:
    """Returns the same result as `digest`, for results of column_of in the order of SCHEMA."""
    hashing = hashlib.sha256()
    for name, (column, mask) in zip(SCHEMA.names, columns, strict=True):
        hashing.update(name.encode() + b"\0")
        if mask is not None:
            hashing.update(np.ascontiguousarray(mask, np.uint8))
        hashing.update(np.ascontiguousarray(column, column.dtype.newbyteorder("<")))
    return hashing.hexdigest()


def bounds(columns: Columns) -> list[float] | None:
    """Returns the smallest x, y, z and the largest x, y, z; None if there are no rows."""
    if not len(columns["id"]):
        return None
    axes = [columns[axis] for axis in "xyz"]
    return [*(float(axis.min()) for axis in axes), *(float(axis.max()) for axis in axes)]
