"""Compares the files of tiles with the digests in the manifest before their data is used."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.parquet as pq
from baking import rows
from baking.columns import SCHEMA
from baking.format import BakeError
from baking.location import is_local

if TYPE_CHECKING:
    from baking.location import Location

    from .bake import Tile

_CHUNK = 1 << 20
# A file that changed less than this many nanoseconds ago is not remembered as verified: it may change again without a new
# timestamp, because timestamps have a resolution of milliseconds.
_SETTLED_NANOSECONDS = 2 * 10**9

# The identity, size and times of each verified file, and its expected digest, keyed by path.
_verified: dict[Path, tuple] = {}


def check(tile: Tile) -> None:
    """Raises BakeError if the digest of a tile's file differs from the manifest. Each process checks a
    local file again only if it has changed, or if it was modified shortly before the last check. Files in object stores are checked every time. `sha256` in the manifest
    is the digest of the file's bytes. Older manifests have only `digest`, which requires reading every row."""
    try:
        if not is_local(tile.file):
            _compare(tile)
            return
        status = tile.file.stat()
        identity = (status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns, tile.sha256 or tile.digest)
        if _verified.get(tile.file) == identity:
            return
        _compare(tile)
    except (OSError, ValueError, pa.ArrowException) as error:
        raise BakeError(f"tile {tile} cannot be read: {error}; {tile.remedy}") from None
    if time.time_ns() - max(status.st_mtime_ns, status.st_ctime_ns) > _SETTLED_NANOSECONDS:
        _verified[tile.file] = identity


def _compare(tile: Tile) -> None:
    digest = _bytes_digest(tile.file) if tile.sha256 else _rows_digest(tile.file)
    if digest != (tile.sha256 or tile.digest):
        digest_name = "SHA-256" if tile.sha256 else "digest of rows"
        raise BakeError(
            f"tile {tile} is damaged or belongs to another bake: {tile.file} has the {digest_name} {digest}, but the manifest has {tile.sha256 or tile.digest}; "
            f"{tile.remedy}, or skip the check with --no-verify"
        )


def parquet_file(path: Location) -> pq.ParquetFile:
    """Opens a Parquet file. Reads files in object stores completely, because nearly all of their columns are needed."""
    return pq.ParquetFile(path if is_local(path) else pa.BufferReader(path.read_bytes()))


def _bytes_digest(path: Location) -> str:
    hashing = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            hashing.update(chunk)
    return hashing.hexdigest()


def _rows_digest(path: Location) -> str:
    """Computes the same result as `rows.digest`, one column at a time."""
    with parquet_file(path) as file:
        if not file.schema_arrow.remove_metadata().equals(SCHEMA):
            raise ValueError("its columns are different")
        return rows.digest_of(rows.column_of(file.read(columns=[name]), name) for name in SCHEMA.names)
