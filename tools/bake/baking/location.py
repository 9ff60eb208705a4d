"""Locates bakes: in folders on this machine, and in object stores."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from upath import UPath

    # A folder or a file. Both types have the methods of pathlib.Path.
    Location = Path | UPath

# The packages that access the object stores, by the scheme of their URLs.
STORES = {"s3": "s3fs", "gs": "gcsfs", "az": "adlfs", "memory": "fsspec"}


class CannotLocate(ValueError):
    """Raised for a URL that is not supported. The message contains the reason."""


def location(text: str) -> Location:
    """Returns the location for a path or a URL. Raises CannotLocate for a URL with an unknown scheme, which would otherwise
    become a folder with the name of the scheme."""
    if not re.match(r"[A-Za-z][A-Za-z0-9+.-]*://", text):
        return Path(text)
    url = urlsplit(text)
    if url.scheme == "file" and url.netloc in ("", "localhost"):
        return Path(unquote(url.path))
    if url.scheme not in STORES:
        raise CannotLocate(f"'{text}' must be a folder or a URL that begins with {', '.join(f'{scheme}://' for scheme in ('file', *STORES) if scheme != 'memory')}")
    if url.scheme != "memory" and not url.netloc:
        raise CannotLocate(f"'{text}' must contain the name of a bucket, such as {url.scheme}://bucket/world")
    missing = [package for package, module in (("universal_pathlib", "upath"), (STORES[url.scheme],) * 2) if importlib.util.find_spec(module) is None]
    if missing:
        raise CannotLocate(f"'{text}' needs the Python packages {' and '.join(missing)}: see tools/bake/README.md#object-stores")
    from upath import UPath

    return UPath(text)


def is_local(path: Location) -> bool:
    """Returns true for a folder or file on this machine."""
    return isinstance(path, Path)


def absolute(path: Location) -> Location:
    """Returns an absolute location without symbolic links."""
    return path.resolve() if is_local(path) else path


def inside(folder: Location, name: str) -> Location | None:
    """Returns a file in a folder, or None if the name leads out of the folder."""
    if is_local(folder):
        file = (folder / name).resolve()
        return file if file.is_relative_to(folder) else None
    pure_path = PurePosixPath(name)
    return None if pure_path.is_absolute() or ".." in pure_path.parts or "://" in name else folder / name
