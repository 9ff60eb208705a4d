"""Files that are put into their places whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

# What files are called until they are whole.
PART = ".part"


class CannotWrite(RuntimeError):
    """A file could not be written: a full disk, a folder that is read-only. A sentence."""


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A new file beside `path`, to write to. At the end of the block the disk gets all of it, then it takes the place of `path`. Raises CannotWrite where
    the disk refuses. After that, and after an exception in the block, what was there is as it was."""
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
        # One about another file, which the block reads, has that file's name.
        if isinstance(error, OSError) and error.filename in (None, str(partial)):
            raise _cannot_write(path, error) from error
        raise
    _sync_folder(path.parent)


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Puts a file into its place with all of its content, or, raising CannotWrite, leaves what was there."""
    with whole_file(path) as file:
        file.write(content)


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(OSError):  # Some disks refuse it for folders; the file is in its place all the same.
        opened = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(opened)
        finally:
            os.close(opened)


def _cannot_write(path: Path, error: OSError) -> CannotWrite:
    return CannotWrite(f"Cannot write {path}: {error.strerror or error}. Free space there, or choose a folder that may be written.")
