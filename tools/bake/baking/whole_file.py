"""Writes files completely or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

# The suffix of files that are not complete yet.
PART = ".part"


class CannotWrite(RuntimeError):
    """A sentence that explains why a file could not be written, such as a full disk or a read-only folder."""


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Yields a new file beside `path` for writing. At the end of the block, the file is flushed to disk and replaces `path`. Raises
    CannotWrite if the disk refuses. Then, and after an exception in the block, the old file is unchanged."""
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
        # An error of a different file, which the block reads, has that file's name.
        if isinstance(error, OSError) and error.filename in (None, str(partial)):
            raise _cannot_write(path, error) from error
        raise
    _sync_folder(path.parent)


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Writes a complete file. If that fails, raises CannotWrite and keeps the old file."""
    with whole_file(path) as file:
        file.write(content)


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(OSError):  # Some file systems refuse it for folders; the file is written nonetheless.
        opened = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(opened)
        finally:
            os.close(opened)


def _cannot_write(path: Path, error: OSError) -> CannotWrite:
    return CannotWrite(f"Cannot write {path}: {error.strerror or error}. Free space there, or choose a writable folder.")
