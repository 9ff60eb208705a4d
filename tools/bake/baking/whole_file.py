"""Writes files completely or not at all."""

from __future__ import annotations

import contextlib
import io
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from .location import is_local

if TYPE_CHECKING:
    from .location import Location

# The suffix of incomplete files.
PART = ".part"


class CannotWrite(RuntimeError):
    """Raised if a file could not be written, for example because of a full disk or a read-only folder. The message contains the
    reason."""


@contextlib.contextmanager
def whole_file(path: Location) -> Iterator[BinaryIO]:
    """Yields a new file next to `path` for writing. At the end of the block, flushes it to disk and replaces `path`.
    Raises CannotWrite if writing fails. In that case, and after an exception in the block, the old file is unchanged. In an
    object store, which has no incomplete objects, yields a buffer instead."""
    if not is_local(path):
        buffer = io.BytesIO()
        yield buffer
        _store(path, buffer)
        return
    partial = path.with_name(f".{path.name}.{secrets.token_hex(4)}{PART}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = partial.open("wb")
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        with file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        partial.rename(path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            partial.unlink()
        # The block may also read other files. An error in one of these names that file.
        if isinstance(error, OSError) and error.filename in (None, str(partial)):
            raise _cannot_write(path, error) from error
        raise
    _sync_folder(path.parent)


def _store(path: Location, content: io.BytesIO) -> None:
    try:
        path.write_bytes(content.getvalue())
    except Exception as error:  # The packages for object stores raise exceptions of many types.
        raise CannotWrite(f"Cannot write {path}: {error}. Check the address, the permissions and the connection.") from error


def write_whole(path: Location, content: bytes | memoryview) -> None:
    """Writes a complete file. If that fails, raises CannotWrite and keeps the old file."""
    with whole_file(path) as file:
        file.write(content)


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(OSError):  # Some file systems cannot flush a folder to disk. The file is still written.
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _cannot_write(path: Path, error: OSError) -> CannotWrite:
    return CannotWrite(f"Cannot write {path}: {error.strerror or error}. Free space there, or choose a writable folder.")
