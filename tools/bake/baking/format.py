"""What a bake is on the disk, as its maker and its readers both know it: the manifest and the names of tiles."""

from __future__ import annotations

import json
from pathlib import Path

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


def read_manifest(folder: Path) -> dict:
    """The manifest in a folder, of whatever version. Raises BakeError where there is none, or none that can be read."""
    manifest = folder / MANIFEST
    try:
        said = json.loads(manifest.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise BakeError(f"{folder} is no bake: there is no {MANIFEST} in it") from None
    except (OSError, ValueError) as error:
        raise BakeError(f"{manifest} cannot be read: {error}") from None
    if not isinstance(said, dict) or said.get("format") != FORMAT:
        raise BakeError(f"{manifest} is not the manifest of a bake: its format must be {FORMAT}")
    return said
