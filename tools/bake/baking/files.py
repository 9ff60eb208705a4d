"""Reads and writes the files of a bake. Each file is written completely or not at all, and is checked before it is
used."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.parquet as pq

from . import rows
from .columns import SCHEMA
from .format import MANIFEST, tile_of_name
from .location import is_local
from .whole_file import PART, CannotWrite, write_whole

if TYPE_CHECKING:
    from .location import Location

LOCK = ".lock"

# The columns that are stored with a dictionary, because they have many repeated values. For any other column, a
# dictionary would take longer and make the file larger.
_DICTIONARIES = ["layer", "model"]
_ENCODINGS = {field.name: "BYTE_STREAM_SPLIT" for field in SCHEMA if pa.types.is_floating(field.type)}
_ENCODINGS |= {"id": "DELTA_BINARY_PACKED"}


class FolderInUse(RuntimeError):
    """Raised if another bake is using the folder."""


def tile_path(out: Location, tile: tuple[int, int]) -> Location:
    """Returns the path of a tile's file."""
    return out / "tiles" / f"tile_{tile[0]}_{tile[1]}.parquet"


def names_of_tiles(out: Location) -> set[str]:
    """Returns the names of all files of tiles in a folder."""
    return {path.name for path in (out / "tiles").glob("tile_*.parquet")}


def size_of_tiles(out: Location) -> int:
    """Returns the size of all files of tiles in a folder, in bytes."""
    return sum((out / "tiles" / name).stat().st_size for name in names_of_tiles(out))


def write_tile(path: Location, columns: rows.Columns, marks: dict[str, str]) -> str:
    """Writes sorted rows, with `marks` as the file's metadata. Returns the SHA-256 of the file."""
    content = packed_tile(columns, marks)
    write_whole(path, content)
    return hashlib.sha256(content).hexdigest()


def packed_tile(columns: rows.Columns, marks: dict[str, str]) -> pa.Buffer:
    """Returns the content of a tile's file."""
    table = rows.to_table(columns).replace_schema_metadata(marks)
    sink = pa.BufferOutputStream()
    pq.write_table(
        table, sink, compression="zstd", use_dictionary=_DICTIONARIES, column_encoding=_ENCODINGS, write_page_checksum=True
    )
    return sink.getvalue()


def read_tile(path: Location, marks: dict[str, str], entry: dict) -> tuple[rows.Columns, dict[str, str], str] | None:
    """Returns the rows, metadata and SHA-256 of a valid file, or None for any other file. The metadata must include
    `marks`, and the rows must have the digest in the metadata. `entry` is the tile's entry in a manifest, which may be
    empty. If it has a `digest` or `sha256`, the file must match."""
    try:
        content = path.read_bytes()
        sha256 = hashlib.sha256(content).hexdigest()
        if entry.get("sha256", sha256) != sha256:
            return None
        with pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True) as file:
            table = file.read()
        metadata = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
        if any(metadata.get(name) != value for name, value in marks.items()):
            return None
        columns = rows.to_columns(table)
    except (OSError, ValueError, pa.ArrowException):  # UnicodeDecodeError and BadRows are ValueErrors.
        return None
    digest = rows.digest(columns)
    return (columns, metadata, sha256) if digest == metadata.get("thicket.digest") == entry.get("digest", digest) else None


def write_manifest(out: Location, manifest: dict) -> None:
    """Writes the manifest, with one line for each tile."""
    tiles = manifest["tiles"]
    head = json.dumps({**manifest, "tiles": None}, indent=1)
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(tiles[name])}" for name in sorted(tiles, key=tile_of_name))
    write_whole(out / MANIFEST, head.replace('"tiles": null', '"tiles": {\n' + lines + "\n }").encode())


@contextlib.contextmanager
def locked(out: Location) -> Iterator[None]:
    """Locks a folder for one bake until the end of the block. Creates the folder if necessary. Raises FolderInUse if another
    bake has locked it, and CannotWrite if it is not writable. The lock is also released when the process ends, even if it
    crashes. Object stores have no locks."""
    if not is_local(out):
        _check_access(out)
        yield
        return
    try:
        out.mkdir(parents=True, exist_ok=True)
        lock = (out / LOCK).open("a+")
    except OSError as error:
        raise CannotWrite(f"Cannot write into {out}: {error.strerror}. Choose a writable folder.") from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FolderInUse(f"Another bake is using {out}. Wait until it has ended, or bake into another folder.") from None
        yield


def _check_access(out: Location) -> None:
    """Raises CannotWrite if an object store does not answer or denies access, or if there is no such bucket."""
    try:
        probe = out / LOCK
        probe.write_bytes(b"")
        probe.unlink()
    except Exception as error:  # The packages for object stores raise exceptions of many types.
        raise CannotWrite(f"Cannot access {out}: {error}. Check the address, the permissions and the connection.") from error


def remove(path: Location) -> None:
    """Removes a file if it exists. Raises CannotWrite if it cannot be removed."""
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise CannotWrite(f"Cannot remove {path}: {error.strerror or error}. Make its folder writable, or choose another one.") from error


def sweep(out: Location) -> None:
    """Removes unfinished files of a bake that was killed. In object stores, there are none."""
    if not is_local(out):
        return
    for folder in (out, out / "tiles", out / "models"):
        for partial in folder.glob(f".*{PART}"):
            remove(partial)


def sweep_strays(out: Location, tiles: set[tuple[int, int]]) -> None:
    """Removes the files of all tiles that are not in `tiles`. Such files remain from a bake whose manifest is missing."""
    names = {tile_path(out, tile).name for tile in tiles}
    for path in (out / "tiles").glob("tile_*.parquet"):
        if path.name not in names:
            remove(path)


def empty(out: Location) -> None:
    """Removes the manifest, the tiles and the models of a bake. Keeps all other files in its folder."""
    for path in [out / MANIFEST, *(out / "tiles").glob("tile_*.parquet"), *(out / "models").glob("*.res")]:
        remove(path)
