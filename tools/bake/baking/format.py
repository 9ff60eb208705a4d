"""The names in a bake's files, shared by the code that writes bakes and the code that reads them: the manifest and the tiles' keys."""

from __future__ import annotations

FORMAT = "thicket-bake"
VERSION = 1
MANIFEST = "manifest.json"


class BakeError(RuntimeError):
    """A sentence that explains why a bake cannot start, continue or be used."""


def name_of(tile: tuple[int, int]) -> str:
    """A tile's key in the manifest."""
    return f"{tile[0]},{tile[1]}"


def tile_of_name(name: str) -> tuple[int, int]:
    """The tile for a key in the manifest. Raises ValueError unless the key is two whole numbers with a comma between them."""
    i, j = name.split(",")
    return int(i), int(j)
