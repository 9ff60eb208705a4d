"""What a bake is on the disk, as its maker and its readers both know it: the manifest, the names of tiles, the columns of their files."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow as pa

FORMAT = "thicket-bake"
VERSION = 1
MANIFEST = "manifest.json"

# The columns of a tile's file, in order. Those that may be empty are so in layers without colors, without custom data.
SCHEMA = pa.schema(
    [
        pa.field("id", pa.uint64(), nullable=False),
        pa.field("layer", pa.uint16(), nullable=False),
        pa.field("model", pa.uint16(), nullable=False),
        *(pa.field(name, pa.float64(), nullable=False) for name in ("x", "y", "z")),
        *(pa.field(name, pa.float32(), nullable=False) for name in ("qx", "qy", "qz", "qw", "scale_x", "scale_y", "scale_z")),
        pa.field("rank", pa.uint32(), nullable=False),
        pa.field("color", pa.uint32()),
        pa.field("variation", pa.float32()),
        pa.field("wind_phase", pa.float32()),
    ]
)


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
        raise BakeError(f"{folder} is no bake: there is no {MANIFEST}") from None
    except (OSError, ValueError) as error:
        raise BakeError(f"{manifest} cannot be read: {error}") from None
    if not isinstance(said, dict) or said.get("format") != FORMAT:
        raise BakeError(f"{manifest} is not the manifest of a bake")
    return said
