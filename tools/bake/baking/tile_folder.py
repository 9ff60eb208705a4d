"""Reads tiles from a folder that an engine has written on a machine without a driver. In a bake, the folder replaces
the engine. demo_project/addons/thicket/baking/bake_to_folder.gd describes the content of the folder."""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .fields import InvalidValue
from .fields import items, mapping, members, number, text, integer
from .format import BakeError, name_of
from .manifest import LENGTH, MAX_TILES, METERS, RADII, RECT, check_rect, read_json, reporting_invalid_values
from .tile_engine import Rejected

WORLD = "world.json"


@dataclass(frozen=True)
class MadeTiles:
    """A folder with tiles and the res:// path of their scene."""

    folder: str
    scene: str

    def start(self) -> TileFolder:
        return TileFolder(Path(self.folder))


_layer = members({"index": integer(0, 0xFFFF), "name": text(), "radius": number(*RADII), "tile_size": LENGTH}, ["index", "name", "radius", "tile_size"])
_models = members({"index": integer(0, 0xFFFF), "models": items(members({})), "material": text()}, ["index", "models", "material"])
_checks = {
    "scene": text(), "scene_digest": text(), "thicket": text(), "seed": text("-?[0-9]{1,20}", "an integer in a string"), "problems": items(text(max_length=1 << 20)),
    "parts": mapping(text(), text(), 1 << 20), "rect": RECT, "tile_size": LENGTH, "world_offset": items(METERS, 3, 3),
    "layers": items(_layer, 1, 0x10000), "models": items(_models), "grid": items(integer(-(2**31), 2**31 - 1), 4, 4),
    "edges": items(items(METERS, 2, MAX_TILES + 1), 2, 2), "columns": mapping(text(), mapping(text(), text(), 100), 0x10000),
}  # fmt: skip
# Earlier versions did not write the density.
_world = members({**_checks, "density": number(0.0, 1e12)}, _checks)


def made_tiles(folder: Path) -> MadeTiles:
    """Returns the tiles in a folder. Raises BakeError if the folder has no valid world.json."""
    return MadeTiles(str(folder), _read_world(folder)["scene"])


def _read_world(folder: Path) -> dict:
    advice = "create the folder again with bake_world.gd"
    try:
        world = read_json(folder / WORLD)
    except (OSError, BakeError) as error:
        raise BakeError(f"{error}; {advice}") from None
    if "columns" not in world:
        raise BakeError(f"{folder} was created by another version of Thicket: {advice}")
    with reporting_invalid_values(folder / WORLD, advice):
        _world(world)
        _check_consistency(world)
    return world


def _check_consistency(world: dict) -> None:
    """Checks conditions that involve several values."""
    check_rect(world["rect"])
    counts = world["grid"][2:]
    if min(counts) < 1 or counts[0] * counts[1] > MAX_TILES:
        raise InvalidValue(counts, f"first column, first row, columns and rows of 1 to {MAX_TILES} tiles").within("grid")
    if [len(edges) - 1 for edges in world["edges"]] != counts:
        raise InvalidValue(world["edges"], "the edges of all columns and rows of the grid").within("edges")
    indices = [layer["index"] for layer in world["layers"]]
    if len(set(indices)) < len(indices):
        raise InvalidValue(indices, "layers with different indices").within("layers")
    if {str(index) for index in indices} - world["columns"].keys():
        raise InvalidValue(world["columns"], "an object with the columns of each layer").within("columns")
    if set(indices) - {entry["index"] for entry in world["models"]}:
        raise InvalidValue(world["models"], "an array with an entry for each layer").within("models")


class TileFolder:
    """Reads tiles from a folder, with the same interface as TileEngine."""

    def __init__(self, folder: Path):
        self.folder = folder
        try:
            self.world = _read_world(folder)
        except BakeError as error:  # The file was valid when the bake started.
            raise Rejected(str(error)) from None

    def describe(self, requested: dict[str, str]) -> dict:
        """Returns the description of the scene like TileEngine.describe, with the options for which the tiles were generated.
        Ignores `requested`."""
        return {key: value for key, value in self.world.items() if key != "models"}

    def models(self, layers: list[int]) -> tuple[list[dict], dict[str, bytes]]:
        """Returns the models like TileEngine.models. The result contains the files of all layers, regardless of `layers`."""
        files = {f"models/{path.name}": path.read_bytes() for path in sorted(self.folder.glob("models/*.res"))}
        return [entry for entry in self.world["models"] if entry["index"] in layers], files

    def rows(self, tile: tuple[int, int]) -> Iterator[tuple[dict, memoryview]]:
        """Yields the rows of a tile like TileEngine.rows. Raises Rejected if the tile's file is missing, unreadable or damaged,
        or belongs to another bake."""
        path = self.folder / "tiles" / f"tile_{tile[0]}_{tile[1]}.rows"
        try:
            data = memoryview(path.read_bytes())
        except FileNotFoundError:
            raise Rejected(f"{path} is missing: bake_world.gd has not generated it yet.") from None
        except OSError as error:
            raise Rejected(f"{path} cannot be read: {error.strerror}. Make it readable, or generate it again with bake_world.gd.") from None
        try:
            yield from self._parts(data, tile)
        except (ValueError, LookupError, struct.error):
            raise Rejected(f"{path} is damaged or belongs to another bake: generate it again with bake_world.gd.") from None

    def _parts(self, data: memoryview, tile: tuple[int, int]) -> Iterator[tuple[dict, memoryview]]:
        header, _, data = _message(data)
        mark = {key: self.world[key] for key in ("scene_digest", "rect", "tile_size")}
        mark["layers"] = [layer["index"] for layer in self.world["layers"]]
        if header["tile"] != name_of(tile) or header["of"] != mark or header["sha256"] != hashlib.sha256(data).hexdigest():
            raise ValueError
        while data:
            header, rows, data = _message(data)
            yield header, rows

    def peak_memory(self) -> int:
        return 0  # A folder has no engine.

    def core_seconds(self) -> float:
        return 0.0

    def close(self) -> None:
        pass


def _message(data: memoryview) -> tuple[dict, memoryview, memoryview]:
    """Returns the first message in the data: its JSON object, its bytes, and the data after it. Raises ValueError,
    struct.error or LookupError if there is no complete message."""
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(bytes(data[4 : 4 + length]))
    end = 4 + length + header["bytes"]
    if end > len(data):
        raise ValueError
    return header, data[4 + length : end], data[end:]
