"""Defines the names that occur in a bake's files, such as the manifest and the keys of tiles. Both the code that writes
bakes and the code that reads them use these names."""

from __future__ import annotations

FORMAT = "thicket-bake"
VERSION = 1
MANIFEST = "manifest.json"


class BakeError(RuntimeError):
    """Raised if a bake cannot start, continue or be used. The message contains the reason."""


def name_of(tile: tuple[int, int]) -> str:
    """Returns a tile's key in the manifest."""
    return f"{tile[0]},{tile[1]}"


def tile_of_name(name: str) -> tuple[int, int]:
    """Returns the tile for a key in the manifest. Raises ValueError unless the key is two integers separated by a
    comma."""
    i, j = name.split(",")
    return int(i), int(j)
