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


def changed_parts(planned: dict[str, str], current: dict[str, str]) -> str:
    """Returns the names of the scene's parts in which two versions differ, for a message."""
    return ", ".join(name for name in {**planned, **current} if planned.get(name) != current.get(name)) or "no named part"


# Each thread of this process has a separate engine, and the key of the scene with which that engine was started.
_thread_state = threading.local()
_engines: list[TileEngine | TileFolder] = []


def _engine_of(plan: Plan) -> TileEngine:
    """Returns this thread's engine with the plan's scene, starting one if necessary. Raises EngineGone, Rejected or
    SceneChanged."""
    if getattr(_thread_state, "key", None) != (plan.source, plan.scene_digest) or _thread_state.engine not in _engines:
        _drop_engine()
        start = time.perf_counter()
        _thread_state.engine = _start(plan.source)
        described = _thread_state.engine.describe(plan.requested)
        _thread_state.starting = getattr(_thread_state, "starting", 0.0) + time.perf_counter() - start
        if described["scene_digest"] != plan.scene_digest:
            raise SceneChanged(
                f"The scene {plan.source.scene} changed during the bake: {changed_parts(plan.parts, described['parts'])}. "
                "Revert the change to continue, or start over with --fresh."
            )
        _start_counting((plan.source, plan.scene_digest))
    return _thread_state.engine


def _start_counting(key: tuple[Source | MadeTiles, str]) -> None:
    """Stores the key of this thread's engine, which is now ready. CPU time that was used before is not counted for any
    tile."""
    _thread_state.key = key
    _thread_state.spent = _core_seconds()


def _core_seconds() -> float:
    """Returns the CPU time of this process and of this thread's engine so far. If the process has several worker
    threads, the result includes all of them."""
    engine = getattr(_thread_state, "engine", None)
    return time.process_time() + (engine.core_seconds() if engine is not None else 0.0)


def _core_seconds_of_tile() -> float:
    """Returns the CPU time since the previous tile was done, including the time to receive this one."""
    total = _core_seconds()
    spent, _thread_state.spent = total - getattr(_thread_state, "spent", total), total
    return spent


def _start(source: Source | MadeTiles) -> TileEngine | TileFolder:
    engine = source.start()
    _engines.append(engine)
    return engine


def _drop_engine() -> None:
    engine = getattr(_thread_state, "engine", None)
    _thread_state.engine = _thread_state.key = None
    if engine in _engines:  # Another thread closes the engines of all threads when a bake ends.
        _engines.remove(engine)
        engine.close()


def close_engines() -> None:
    """Stops all engines of this process."""
    while _engines:
        _engines.pop().close()
    _thread_state.__dict__.clear()


atexit.register(close_engines)


def describe(source: Source | MadeTiles, requested: dict[str, str]) -> dict:
    """Returns the result of TileEngine.describe, with the result of TileEngine.models added as `models` and `files`,
    and the engine's startup time in seconds as `starting`. Starts a new engine, so that it reads the current state of
    the scene."""
    _drop_engine()
    start = time.perf_counter()
    _thread_state.engine = _start(source)
    described = _thread_state.engine.describe(requested)
    described["starting"] = time.perf_counter() - start
    described["models"], described["files"] = _thread_state.engine.models([layer["index"] for layer in described["layers"]])
    _start_counting((source, described["scene_digest"]))
    return described


def make(plan: Plan, tile: tuple[int, int], entry: dict) -> dict:
    """Generates a tile's file, unless a valid file exists that has the digests of `entry`. `entry` is the tile's current entry
    in the manifest, which may be empty. The result contains the new `entry`, `made` (False if the file existed), `pixels` (see
    _pixels), `seconds`, `core_seconds` (of this process and the engine), `starting` (the additional seconds to start an engine,
    if necessary), `bytes` and `memory`. After an error, it contains a message instead: `failed` if only this tile cannot be
    generated, `stop` if no other tile can be generated either."""
    start = time.perf_counter()
    _thread_state.starting = 0.0
    path = files.tile_path(location(plan.out), tile)
    marks = plan.marks(tile)
    existing = files.read_tile(path, marks, entry)
    try:
        if existing is None:
            files.remove(path)  # A reader must not use an invalid file.
            columns, sheared = _generate(plan, tile)
            marks |= {"thicket.digest": rows.digest(columns), "thicket.sheared": str(sheared)}
            sha256 = files.write_tile(path, columns, marks)
        else:
            columns, marks, sha256 = existing
    except (SceneChanged, files.CannotWrite) as error:
        return {"tile": tile, "stop": str(error)}
    except (Rejected, EngineGone) as error:
        return {"tile": tile, "failed": str(error)}
    engine = getattr(_thread_state, "engine", None)
    return {
        "tile": tile,
        "made": existing is None,
        "entry": {**_entry(plan, path, columns, marks), "sha256": sha256},
        "pixels": _pixels(plan, columns),
        "seconds": time.perf_counter() - start - _thread_state.starting,
        "core_seconds": _core_seconds_of_tile(),
        "starting": _thread_state.starting,
        "bytes": path.stat().st_size,
        "memory": (1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, engine.peak_memory() if engine is not None else 0),
    }


def measure(plan: Plan, tile: tuple[int, int]) -> tuple[int, int, float] | None:
    """Generates a tile without storing it. Returns its number of rows, the size of its file in bytes and its CPU time in
    seconds, or None if it cannot be generated."""
    try:
        columns, _ = _generate(plan, tile)
    except (SceneChanged, Rejected, EngineGone):
        return None  # The bake reports the reason.
    size = files.packed_tile(columns, plan.marks(tile)).size
    return len(columns["id"]), size, _core_seconds_of_tile()


def _generate(plan: Plan, tile: tuple[int, int]) -> tuple[rows.Columns, int]:
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            return _rows_of(plan, tile, _engine_of(plan))
        except (EngineGone, rows.BadRows) as error:
            _drop_engine()  # The engine may have stopped in the middle of a message.
            if attempt == _ATTEMPTS:
                raise EngineGone(f"{_ATTEMPTS} engines in a row could not generate it. {error} Run the same command: it generates only the missing tiles.") from error
    raise AssertionError


def _rows_of(plan: Plan, tile: tuple[int, int], engine: TileEngine | TileFolder) -> tuple[rows.Columns, int]:
    """Returns the sorted rows of a tile and the number of instances with a shear."""
    area = plan.grid.area_of(tile)
    tables, sheared = [], 0
    for header, data in engine.rows(tile):
        columns, sheared_rows = rows.parse(data, header["layer"], plan.layers[header["layer"]])
        mask = inside(area, header["bounds"], columns["x"], columns["z"])
        tables.append(columns if mask is None else {name: column[mask] for name, column in columns.items()})
        sheared += sheared_rows
    return rows.joined(tables), sheared


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
    result = []
    for layer in plan.layers:
        in_layer = columns["layer"] == layer
        column = np.clip((columns["x"][in_layer] - plan.rect[0]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        row = np.clip((columns["z"][in_layer] - plan.rect[1]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        result.append(np.unique(row << np.uint32(16) | column, return_counts=True))
    return result
