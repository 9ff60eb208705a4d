"""Tiles that an engine has made into a folder, on a machine without a driver: see demo_project/addons/thicket/baking/bake_to_folder.gd for what
lies there. In place of the engine itself."""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .format import BakeError, name_of
from .tile_engine import Refused

WORLD = "world.json"


@dataclass(frozen=True)
class MadeTiles:
    """A folder with tiles, and the res:// path of the scene that they are of."""

    folder: str
    scene: str

    def start(self) -> TileFolder:
        return TileFolder(Path(self.folder))


def made_tiles(folder: Path) -> MadeTiles:
    """What lies in a folder. Raises BakeError where that is no world's tiles."""
    try:
        world = json.loads((folder / WORLD).read_text(encoding="utf-8"))
        if "columns" not in world:
            raise BakeError(f"{folder} was made by another version of Thicket: make it again with bake_world.gd.")
        return MadeTiles(str(folder), world["scene"])
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise BakeError(f"{folder / WORLD} cannot be read: {error}. Make the folder again with bake_world.gd.") from None


class TileFolder:
    """Answers what a TileEngine does."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.world = json.loads((folder / WORLD).read_text(encoding="utf-8"))

    def describe(self, asked: dict[str, str]) -> dict:
        """As TileEngine.describe, of what was asked for when the folder was made: `asked` is empty."""
        return {key: value for key, value in self.world.items() if key != "models"}

    def models(self, layers: list[int]) -> tuple[list[dict], dict[str, bytes]]:
        """As TileEngine.models."""
        files = {f"models/{path.name}": path.read_bytes() for path in sorted(self.folder.glob("models/*.res"))}
        return [each for each in self.world["models"] if each["index"] in layers], files

    def rows(self, tile: tuple[int, int]) -> Iterator[tuple[dict, memoryview]]:
        """As TileEngine.rows. Raises Refused for a tile that is not there or not whole."""
        path = self.folder / "tiles" / f"tile_{tile[0]}_{tile[1]}.rows"
        try:
            data = memoryview(path.read_bytes())
        except FileNotFoundError:
            raise Refused(f"{path} is not there: bake_world.gd has not made it yet.") from None
        except OSError as error:
            raise Refused(f"{path} cannot be read: {error.strerror}. Make it readable, or make it again with bake_world.gd.") from None
        try:
            yield from self._parts(data, tile)
        except (ValueError, LookupError, struct.error):
            raise Refused(f"{path} is damaged, or of another bake: bake_world.gd makes it again.") from None

    def _parts(self, data: memoryview, tile: tuple[int, int]) -> Iterator[tuple[dict, memoryview]]:
        header, _, data = _message(data)
        mark = {key: self.world[key] for key in ("scene_digest", "rect", "tile_size")}
        mark["layers"] = [layer["index"] for layer in self.world["layers"]]
        if header["tile"] != name_of(tile) or header["of"] != mark or header["sha256"] != hashlib.sha256(data).hexdigest():
            raise ValueError
        while data:
            part, rows, data = _message(data)
            yield part, rows

    def peak_memory(self) -> int:
        return 0  # There is no engine.

    def core_seconds(self) -> float:
        return 0.0

    def close(self) -> None:
        pass


def _message(data: memoryview) -> tuple[dict, memoryview, memoryview]:
    """The first of some messages: its JSON object, its bytes, and what comes after it. Raises ValueError, struct.error or LookupError
    where there is none."""
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(bytes(data[4 : 4 + length]))
    end = 4 + length + header["bytes"]
    if end > len(data):
        raise ValueError
    return header, data[4 + length : end], data[end:]
