"""Runs in Dask's worker processes. Generates a tile, or reuses the tile's existing file. Each worker thread has a
separate engine, which it keeps for all tiles."""

from __future__ import annotations

import atexit
import resource
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import files, rows
from .format import name_of
from .grid import TileGrid, inside
from .location import location
from .tile_engine import EngineGone, Rejected, Source, TileEngine
from .tile_folder import MadeTiles, TileFolder

if TYPE_CHECKING:
    from .location import Location

# The number of attempts before a tile fails. An attempt fails if the engine is lost or its rows are damaged; the next
# attempt uses a new engine.
_ATTEMPTS = 3


@dataclass(frozen=True)
class Plan:
    """The data that a worker needs to generate a tile. It determines the content of the tile's file."""

    source: Source | MadeTiles
    requested: dict[str, str]  # The options with which the scene was described.
    out: str
    rect: tuple[float, float, float, float]  # The baked rectangle: x, z, width and depth in world meters.
    grid: TileGrid
    layers: dict[int, dict[str, str]]  # The columns of each layer's rows (see rows.py), by the layer's index.
    scene_digest: str
    parts: dict[str, str]  # The digests of the scene's parts.
    pixel: float  # The width of a map pixel in meters.

    def marks(self, tile: tuple[int, int]) -> dict[str, str]:
        """Returns the metadata of a tile's file. A file with other values belongs to another tile or bake."""
        return {
            "thicket.tile": name_of(tile),
            "thicket.scene_digest": self.scene_digest,
            "thicket.area": ",".join(map(repr, self.grid.area_of(tile))),
            "thicket.layers": ",".join(map(str, self.layers)),
        }


class SceneChanged(RuntimeError):
    """Raised if the scene differs from the one with which the bake was started."""


def changed_parts(before: dict[str, str], now: dict[str, str]) -> str:
    """Returns the names of the scene's parts in which two versions differ, for a message."""
    return ", ".join(part for part in {**before, **now} if before.get(part) != now.get(part)) or "no named part"


# Each thread of this process has a separate engine, and the key of the scene with which that engine was started.
_own = threading.local()
_engines: list[TileEngine | TileFolder] = []


def _engine_of(plan: Plan) -> TileEngine:
    """Returns this thread's engine with the plan's scene, starting one if necessary. Raises EngineGone, Rejected or
    SceneChanged."""
    if getattr(_own, "key", None) != (plan.source, plan.scene_digest) or _own.engine not in _engines:
        _drop_engine()
        begun = time.perf_counter()
        _own.engine = _started(plan.source)
        described = _own.engine.describe(plan.requested)
        _own.starting = getattr(_own, "starting", 0.0) + time.perf_counter() - begun
        if described["scene_digest"] != plan.scene_digest:
            raise SceneChanged(
                f"The scene {plan.source.scene} changed during the bake: {changed_parts(plan.parts, described['parts'])}. "
                "Revert the change to continue, or start over with --fresh."
            )
        _begin_to_count((plan.source, plan.scene_digest))
    return _own.engine


def _begin_to_count(key: tuple[Source | MadeTiles, str]) -> None:
    """Stores the key of this thread's engine, which is now ready. CPU time that was used before is not counted for any
    tile."""
    _own.key = key
    _own.spent = _core_seconds()


def _core_seconds() -> float:
    """Returns the CPU time of this process and of this thread's engine so far. If the process has several worker
    threads, the result includes all of them."""
    engine = getattr(_own, "engine", None)
    return time.process_time() + (engine.core_seconds() if engine is not None else 0.0)


def _core_seconds_of_tile() -> float:
    """Returns the CPU time since the previous tile was done, including the time to receive this one."""
    now = _core_seconds()
    spent, _own.spent = now - getattr(_own, "spent", now), now
    return spent


def _started(source: Source | MadeTiles) -> TileEngine | TileFolder:
    engine = source.start()
    _engines.append(engine)
    return engine


def _drop_engine() -> None:
    engine = getattr(_own, "engine", None)
    _own.engine = _own.key = None
    if engine in _engines:  # Another thread closes the engines of all threads when a bake ends.
        _engines.remove(engine)
        engine.close()


def close_engines() -> None:
    """Stops all engines of this process."""
    while _engines:
        _engines.pop().close()
    _own.__dict__.clear()


atexit.register(close_engines)


def describe(source: Source | MadeTiles, requested: dict[str, str]) -> dict:
    """Returns the result of TileEngine.describe, with the result of TileEngine.models added as `models` and `files`,
    and the engine's startup time in seconds as `starting`. Starts a new engine, so that it reads the current state of
    the scene."""
    _drop_engine()
    begun = time.perf_counter()
    _own.engine = _started(source)
    described = _own.engine.describe(requested)
    described["starting"] = time.perf_counter() - begun
    described["models"], described["files"] = _own.engine.models([layer["index"] for layer in described["layers"]])
    _begin_to_count((source, described["scene_digest"]))
    return described


def make(plan: Plan, tile: tuple[int, int], entry: dict) -> dict:
    """Generates a tile's file, unless a valid file exists that has the digests of `entry`. `entry` is the tile's current entry
    in the manifest, which may be empty. The result contains the new `entry`, `made` (False if the file existed), `pixels` (see
    _pixels), `seconds`, `core_seconds` (of this process and the engine), `starting` (the additional seconds to start an engine,
    if necessary), `bytes` and `memory`. After an error, it contains a message instead: `failed` if only this tile cannot be
    generated, `stop` if no other tile can be generated either."""
    start = time.perf_counter()
    _own.starting = 0.0
    path = files.tile_path(location(plan.out), tile)
    marks = plan.marks(tile)
    known = files.read_tile(path, marks, entry)
    try:
        if known is None:
            files.remove(path)  # A reader must not use an invalid file.
            columns, sheared = _made(plan, tile)
            marks |= {"thicket.digest": rows.digest(columns), "thicket.sheared": str(sheared)}
            sha256 = files.write_tile(path, columns, marks)
        else:
            columns, marks, sha256 = known
    except (SceneChanged, files.CannotWrite) as error:
        return {"tile": tile, "stop": str(error)}
    except (Rejected, EngineGone) as error:
        return {"tile": tile, "failed": str(error)}
    engine = getattr(_own, "engine", None)
    return {
        "tile": tile,
        "made": known is None,
        "entry": {**_entry(plan, path, columns, marks), "sha256": sha256},
        "pixels": _pixels(plan, columns),
        "seconds": time.perf_counter() - start - _own.starting,
        "core_seconds": _core_seconds_of_tile(),
        "starting": _own.starting,
        "bytes": path.stat().st_size,
        "memory": (1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, engine.peak_memory() if engine is not None else 0),
    }


def measure(plan: Plan, tile: tuple[int, int]) -> tuple[int, int, float] | None:
    """Generates a tile without storing it. Returns its number of rows, the size of its file in bytes and its CPU time in
    seconds, or None if it cannot be generated."""
    try:
        columns, _ = _made(plan, tile)
    except (SceneChanged, Rejected, EngineGone):
        return None  # The bake reports the reason.
    size = files.packed_tile(columns, plan.marks(tile)).size
    return len(columns["id"]), size, _core_seconds_of_tile()


def _made(plan: Plan, tile: tuple[int, int]) -> tuple[rows.Columns, int]:
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            return _requested_rows(plan, tile, _engine_of(plan))
        except (EngineGone, rows.BadRows) as error:
            _drop_engine()  # The engine may have stopped in the middle of a message.
            if attempt == _ATTEMPTS:
                raise EngineGone(f"{_ATTEMPTS} engines in a row could not generate it. {error} Run the same command: it generates only the missing tiles.") from error
    raise AssertionError


def _requested_rows(plan: Plan, tile: tuple[int, int], engine: TileEngine | TileFolder) -> tuple[rows.Columns, int]:
    """Returns the sorted rows of a tile and the number of instances with a shear."""
    area = plan.grid.area_of(tile)
    parts, sheared = [], 0
    for made, data in engine.rows(tile):
        part, leaning = rows.parse(data, made["layer"], plan.layers[made["layer"]])
        within = inside(area, made["bounds"], part["x"], part["z"])
        parts.append(part if within is None else {name: column[within] for name, column in part.items()})
        sheared += leaning
    return rows.joined(parts), sheared


def _entry(plan: Plan, path: Location, columns: rows.Columns, marks: dict[str, str]) -> dict:
    counts = np.bincount(columns["layer"], minlength=1)
    return {
        "file": f"tiles/{path.name}",
        "rows": len(columns["id"]),
        "rows_of_layer": [int(counts[layer]) if layer < len(counts) else 0 for layer in plan.layers],
        "digest": marks["thicket.digest"],
        "bounds": rows.bounds(columns),
        "sheared": int(marks["thicket.sheared"]),
    }


def _pixels(plan: Plan, columns: rows.Columns) -> list[tuple[np.ndarray, np.ndarray]]:
    """Returns for each layer the map pixels that contain instances, as row << 16 | column, and the number of instances
    in each."""
    found = []
    for layer in plan.layers:
        own = columns["layer"] == layer
        column = np.clip((columns["x"][own] - plan.rect[0]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        row = np.clip((columns["z"][own] - plan.rect[1]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        found.append(np.unique(row << np.uint32(16) | column, return_counts=True))
    return found
