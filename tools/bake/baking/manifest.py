"""Reads manifest.json and checks all of its fields."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from . import fields
from .fields import flag, items, mapping, members, nullable, number, text, integer
from .format import FORMAT, MANIFEST, VERSION, BakeError, tile_of_name

if TYPE_CHECKING:
    from .location import Location

MAX_TILES = 1_000_000
MAX_METERS = 1e12
RADII = (1e-3, 1e6)  # The allowed range of a radius in meters.
REMEDY = "restore the manifest of the bake, or bake again with --fresh"

METERS = number(-MAX_METERS, MAX_METERS)
LENGTH = number(1e-3, MAX_METERS)
RECT = items(METERS, 4, 4)
_distance = number(0.0, MAX_METERS)
_integer_32 = integer(-(2**31), 2**31 - 1)
_rows = integer(0, 2**31 - 1)
_cost = nullable(number(0.0, 1e12))
_sha256 = text("[0-9a-f]{64}", "64 hexadecimal digits, a SHA-256")
_levels = items(members({"path": text(), "distance": _distance}, ["path"]))
_layer = members(
    {
        "index": integer(0, 0xFFFF), "name": text(), "radius": number(*RADII), "colored": flag, "custom_data": flag, "view_distance": _distance,
        "cast_shadow": integer(0, 3), "render_layers": integer(0, 0xFFFFFFFF), "material": text(),
        "models": items(members({"path": text(), "name": text(), "lods": nullable(_levels)}), max_count=0xFFFF),
    },
    ["index", "radius", "models"],
)  # fmt: skip
_tile = members(
    {
        "file": text(), "rows": _rows, "rows_of_layer": items(_rows), "digest": _sha256, "sha256": _sha256,
        "bounds": nullable(items(METERS, 6, 6)), "sheared": _rows, "seconds": _cost, "core_seconds": _cost,
    },
    ["file", "rows", "digest"],
)  # fmt: skip
_tile_name = text(r"(0|-?[1-9][0-9]{0,9}),(0|-?[1-9][0-9]{0,9})", "two whole numbers I,J as the key")
_manifest = members(
    {
        "scene": text(), "scene_digest": text(), "scene_parts": mapping(text(), text(), 1 << 20),
        "rect": RECT, "tile_size": LENGTH, "grid": items(_integer_32, 4, 4), "world_offset": items(METERS, 3, 3),
        "layers": items(_layer, 1, 0x10000), "tiles": mapping(_tile_name, _tile, MAX_TILES), "complete": flag, "digest": nullable(_sha256),
    },
    ["scene", "scene_digest", "rect", "tile_size", "world_offset", "layers", "tiles"],
)  # fmt: skip
_costs = members(
    {
        "tiles": mapping(text(), members({"core_seconds": _cost}), MAX_TILES),
        "costs": nullable(members(dict.fromkeys(("start_seconds", "driver_seconds", "bytes"), number(0.0, 1e12)), ["start_seconds", "driver_seconds", "bytes"])),
    },
    ["tiles"],
)


@contextmanager
def reporting_invalid_values(path: Location, remedy: str) -> Iterator[None]:
    """Converts an InvalidValue from a check into a BakeError with the file's name and instructions."""
    try:
        yield
    except fields.InvalidValue as invalid:
        raise BakeError(f"{path}: {invalid}; {remedy}") from None


def read_json(path: Location) -> dict:
    """Returns the JSON object in a file. Raises FileNotFoundError if there is no file. Raises BakeError for an
    unreadable file, for any other content, and for an object that has the same field twice."""
    try:
        content = json.loads(path.read_bytes().decode(), object_pairs_hook=fields.without_repeats)
    except FileNotFoundError:
        raise
    except RecursionError:
        raise BakeError(f"{path} cannot be read: its values are nested too deeply") from None
    except (OSError, ValueError) as error:  # UnicodeDecodeError is a ValueError.
        raise BakeError(f"{path} cannot be read: {error}") from None
    if not isinstance(content, dict):
        raise BakeError(f"{path} must contain a JSON object")
    return content


def read_manifest(folder: Location) -> dict:
    """Returns the manifest in a folder without checking its version or its other fields. Raises BakeError if it is missing or
    unreadable, or if it does not have the format of a bake."""
    manifest = folder / MANIFEST
    try:
        content = read_json(manifest)
    except FileNotFoundError:
        raise BakeError(f"{folder} is not a bake: it does not contain {MANIFEST}") from None
    if content.get("format") != FORMAT:
        raise BakeError(f"{manifest} is not the manifest of a bake: its format must be {FORMAT}")
    return content


def check_manifest(content: dict, manifest: Location) -> None:
    """Raises BakeError if the manifest has a different version, or for the first field that is missing or invalid."""
    version = content.get("version")
    if type(version) is not int or version != VERSION:
        raise BakeError(f"{manifest}: version must be {VERSION}, got {fields.as_text(version)}; bake again with this version of Thicket")
    with reporting_invalid_values(manifest, REMEDY):
        _manifest(content)
        _check_consistency(content)


def check_costs(content: dict, manifest: Location) -> None:
    """Raises BakeError like check_manifest, but checks only the fields that a forecast reads."""
    with reporting_invalid_values(manifest, REMEDY):
        _costs(content)


def check_rect(rect: list) -> None:
    """Raises InvalidValue for a rectangle whose width or depth is not above 0."""
    if min(rect[2:]) <= 0:
        raise fields.InvalidValue(min(rect[2:]), "x, z, width and depth in meters, the last two above 0").within("rect")


def _check_consistency(content: dict) -> None:
    """Checks conditions that involve several values."""
    check_rect(content["rect"])
    indices = [layer["index"] for layer in content["layers"]]
    for position, layer in enumerate(content["layers"]):
        if indices.index(layer["index"]) != position:
            raise fields.InvalidValue(layer["index"], "a unique number for each layer").within("index").within(f"[{position}]").within("layers")
        for model, entry in enumerate(layer["models"]):
            distances = [level.get("distance", 0.0) for level in entry.get("lods") or []]
            if distances and (distances[0] != 0 or sorted(distances) != distances):
                name = f"layers[{position}].models[{model}].lods"
                raise fields.InvalidValue(next((distance for distance in distances if distance), 0), "a list of levels sorted by distance, starting at 0 m").within(name)
    for name, tile in content["tiles"].items():
        if max(map(abs, tile_of_name(name))) >= 2**31:
            raise fields.InvalidValue(name, "two whole numbers I,J below 2147483648 as the key").within(f"[{json.dumps(name)}]").within("tiles")
        bounds = tile.get("bounds")
        if bounds and any(low > high for low, high in zip(bounds[:3], bounds[3:])):
            raise fields.InvalidValue(max(bounds[:3]), "smallest x, y, z, then largest x, y, z").within("bounds").within(f"[{json.dumps(name)}]").within("tiles")
