"""What a bake is called on the disk, as its maker and its readers both know it: the manifest and the names of tiles."""

from __future__ import annotations

FORMAT = "thicket-bake"
VERSION = 1
MANIFEST = "manifest.json"


class BakeError(RuntimeError):
    """Why there is no bake, no more of it, or nothing to be made of it: a sentence."""


def name_of(tile: tuple[int, int]) -> str:
    """A tile's key in the manifest."""
    return f"{tile[0]},{tile[1]}"


def tile_of_name(name: str) -> tuple[int, int]:
    """The tile of a key in the manifest. Raises ValueError for anything else than two whole numbers with a comma between."""
    i, j = name.split(",")
    return int(i), int(j)
