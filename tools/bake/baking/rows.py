"""Rows of instances, as the engine sends them and as the files hold them."""

from __future__ import annotations

import hashlib

import numpy as np
import pyarrow as pa

from .columns import SCHEMA

# Of the numbers that each instance has, in the engine's order; what stands between `rank` and `model` are the floats of color and
# custom data.
_SENT = [("id", "<u8"), *((name, "<f8") for name in ("x", "y", "z"))]
_SENT += [(name, "<f4") for name in ("qx", "qy", "qz", "qw", "scale_x", "scale_y", "scale_z")]
_SENT += [("rank", "<u4")]
_HEADER_BYTES = 16

Columns = dict[str, np.ndarray]


class BadRows(ValueError):
    """What came is no table of rows."""


def parse(data: bytes | bytearray, layer: dict) -> tuple[Columns, int]:
    """The columns in what ScatterTile.get_rows gives for a layer, and how many instances have a shear. Of a layer, `index`, `colored`
    and `custom_data` count. Raises BadRows where the size does not fit."""
    if len(data) < _HEADER_BYTES:
        raise BadRows(f"{len(data)} bytes are too few for rows")
    rows, floats, sheared, _ = (int(number) for number in np.frombuffer(data, "<u4", 4))
    wanted = 4 * (bool(layer["colored"]) + bool(layer["custom_data"]))
    if rows and floats != wanted:
        raise BadRows(f"{floats} floats of color and custom data where the layer has {wanted}")
    at = _HEADER_BYTES

    def take(kind: str) -> np.ndarray:
        nonlocal at
        size = np.dtype(kind).itemsize * rows
        if at + size > len(data):
            raise BadRows(f"{len(data)} bytes are too few for {rows} rows")
        column = np.frombuffer(data, kind, rows, at)
        at += size
        return column

    columns = {name: take(kind) for name, kind in _SENT}
    further = [take("<f4") for _ in range(floats)]
    columns["model"] = take("<u2")
    if at != len(data):
        raise BadRows(f"{len(data) - at} bytes more than {rows} rows have")
    columns["layer"] = np.full(rows, layer["index"], np.uint16)
    _add_further(columns, further, layer)
    return columns, sheared


def _add_further(columns: Columns, further: list[np.ndarray], layer: dict) -> None:
    rows = len(columns["id"])
    color = np.zeros(rows, np.uint32)
    if layer["colored"] and rows:
        for place, channel in enumerate(further[:4]):
            color |= np.rint(np.clip(channel, 0.0, 1.0) * np.float32(255.0)).astype(np.uint32) << np.uint32(8 * place)
    columns["color"] = color
    custom = further[-4:] if layer["custom_data"] and rows else [np.zeros(rows, np.float32)] * 2
    columns["variation"], columns["wind_phase"] = custom[0], custom[1]
    columns["has_color"] = np.full(rows, bool(layer["colored"]))
    columns["has_custom"] = np.full(rows, bool(layer["custom_data"]))


def joined(parts: list[Columns]) -> Columns:
    """All rows of some parts, sorted by layer, then id."""
    names = [*SCHEMA.names, "has_color", "has_custom"]
    if not parts:
        empty = parse(bytes(_HEADER_BYTES), {"index": 0, "colored": False, "custom_data": False})[0]
        return {name: empty[name] for name in names}
    whole = {name: np.concatenate([part[name] for part in parts]) for name in names}
    order = np.lexsort((whole["id"], whole["layer"]))
    return {name: column.take(order) for name, column in whole.items()}


# A column may be empty where the mask of its kind says so.
_MASKS = {"color": "has_color", "variation": "has_custom", "wind_phase": "has_custom"}


def to_table(columns: Columns) -> pa.Table:
    """The rows as a table of SCHEMA."""
    arrays = []
    for field in SCHEMA:
        mask = ~columns[_MASKS[field.name]] if field.name in _MASKS else None
        arrays.append(pa.array(columns[field.name], field.type, mask=mask))
    return pa.Table.from_arrays(arrays, schema=SCHEMA)


def to_columns(table: pa.Table) -> Columns:
    """The rows of a table of SCHEMA, which raises BadRows for another one."""
    if not table.schema.remove_metadata().equals(SCHEMA):
        raise BadRows("its columns are others")
    columns: Columns = {}
    for name in SCHEMA.names:
        column = table[name].combine_chunks()
        column = column.chunk(0) if isinstance(column, pa.ChunkedArray) and column.num_chunks else column
        if isinstance(column, pa.ChunkedArray):
            column = pa.array([], column.type)
        if name in _MASKS:
            columns[_MASKS[name]] = column.is_valid().to_numpy(zero_copy_only=False)
            column = column.fill_null(0)
        columns[name] = column.to_numpy(zero_copy_only=False)
    return columns


def digest(columns: Columns) -> str:
    """SHA-256 over every bit of sorted rows, as hexadecimal digits: column by column in the order of SCHEMA, each as its name, a zero
    and its little-endian numbers (0 for none), the ones that may be empty with a byte a row, 1 for a number, before them."""
    hashing = hashlib.sha256()
    for name in SCHEMA.names:
        hashing.update(name.encode() + b"\0")
        if name in _MASKS:
            hashing.update(np.ascontiguousarray(columns[_MASKS[name]], np.uint8))
        column = columns[name]
        hashing.update(np.ascontiguousarray(column, column.dtype.newbyteorder("<")))
    return hashing.hexdigest()


def bounds(columns: Columns) -> list[float] | None:
    """Smallest x, y, z and largest x, y, z; None for no rows."""
    if not len(columns["id"]):
        return None
    axes = [columns[axis] for axis in "xyz"]
    return [*(float(axis.min()) for axis in axes), *(float(axis.max()) for axis in axes)]
