"""What a worker does: makes one tile, or finds that it is there. Runs in processes that Dask starts, each with an engine of its own
that stays alive from tile to tile."""

from __future__ import annotations

import atexit
import resource
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import files, rows
from .format import name_of
from .grid import TileGrid, inside
from .tile_engine import EngineGone, Refused, Source, TileEngine
from .tile_folder import MadeTiles, TileFolder

# Engines that may end in the middle of a tile before it is given up.
_ATTEMPTS = 3


@dataclass(frozen=True)
class Plan:
    """All that decides what a tile's file holds, and what its maker has to know."""

    source: Source | MadeTiles
    asked: dict[str, str]  # What the scene was described for
    out: str
    rect: tuple[float, float, float, float]  # x, z, width, depth, meters of the world
    grid: TileGrid
    layers: dict[int, dict[str, str]]  # By index: the columns of their rows, see rows.py
    scene_digest: str
    parts: dict[str, str]  # The digests of the scene's parts
    pixel: float  # Meters of a pixel of the map

    def marks(self, tile: tuple[int, int]) -> dict[str, str]:
        """What a tile's file says of itself: a file with other marks is another tile's, or another bake's."""
        return {
            "thicket.tile": name_of(tile),
            "thicket.scene_digest": self.scene_digest,
            "thicket.area": ",".join(map(repr, self.grid.area_of(tile))),
            "thicket.layers": ",".join(map(str, self.layers)),
        }


class SceneChanged(RuntimeError):
    """The scene is not the one that the bake was begun with."""


def changed_parts(before: dict[str, str], now: dict[str, str]) -> str:
    """The names of the parts of a scene that differ, for a sentence."""
    return ", ".join(part for part in {**before, **now} if before.get(part) != now.get(part)) or "no part that has a name"


# The engine of each thread of this process, and the source that it was started with.
_own = threading.local()
_engines: list[TileEngine | TileFolder] = []


def _engine_of(plan: Plan) -> TileEngine:
    """A running engine whose scene is the plan's. Raises EngineGone, Refused or SceneChanged."""
    if getattr(_own, "key", None) != (plan.source, plan.scene_digest):
        _drop_engine()
        begun = time.perf_counter()
        _own.engine = _started(plan.source)
        described = _own.engine.describe(plan.asked)
        _own.starting = getattr(_own, "starting", 0.0) + time.perf_counter() - begun
        if described["scene_digest"] != plan.scene_digest:
            raise SceneChanged(
                f"The scene {plan.source.scene} has changed while it was baked: {changed_parts(plan.parts, described['parts'])}. "
                "Change it back to go on, or bake from the start with --fresh."
            )
        _begin_to_count((plan.source, plan.scene_digest))
    return _own.engine


def _begin_to_count(key: tuple[Source | MadeTiles, str]) -> None:
    """Notes what the engine of this thread, which is ready, makes tiles of. What was spent until here is no tile's."""
    _own.key = key
    _own.spent = _core_seconds()


def _core_seconds() -> float:
    """Processor time of this process and of this thread's engine so far. A process with several such threads counts all of them."""
    engine = getattr(_own, "engine", None)
    return time.process_time() + (engine.core_seconds() if engine is not None else 0.0)


def _core_seconds_of_tile() -> float:
    """Processor time since the last tile was there, what it took to be handed this one included."""
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
    if engine is not None:
        _engines.remove(engine)
        engine.close()


def close_engines() -> None:
    """Ends all engines of this process."""
    while _engines:
        _engines.pop().close()
    _own.__dict__.clear()


atexit.register(close_engines)


def describe(source: Source | MadeTiles, asked: dict[str, str]) -> dict:
    """What TileEngine.describe says of the scene, what TileEngine.models gives for its layers as `models` and `files`, and the seconds until an engine had
    started as `starting`. By a new engine, which reads the scene as it is now."""
    _drop_engine()
    begun = time.perf_counter()
    _own.engine = _started(source)
    described = _own.engine.describe(asked)
    described["starting"] = time.perf_counter() - begun
    described["models"], described["files"] = _own.engine.models([layer["index"] for layer in described["layers"]])
    _begin_to_count((source, described["scene_digest"]))
    return described


def make(plan: Plan, tile: tuple[int, int], entry: dict) -> dict:
    """Makes a tile's file, unless it is there, whole, and has the digests of its entry in the manifest so far, which may be empty. Returns the tile's entry in the manifest and, beside it, `made` (False for one
    that was there), `pixels` (see _pixels), `seconds`, `core_seconds` (of this process and the engine), `starting` (seconds besides, for an
    engine that had to be started) and `memory`. What goes wrong comes as `failed` (this tile cannot be made; others can), `stop` (no other
    could be either), each a sentence."""
    start = time.perf_counter()
    _own.starting = 0.0
    path = files.tile_path(Path(plan.out), tile)
    marks = plan.marks(tile)
    known = files.read_tile(path, marks, entry)
    try:
        if known is None:
            files.remove(path)  # No reader shall take it for a tile.
            columns, sheared = _made(plan, tile)
            marks |= {"thicket.digest": rows.digest(columns), "thicket.sheared": str(sheared)}
            sha256 = files.write_tile(path, columns, marks)
        else:
            columns, marks, sha256 = known
    except (SceneChanged, files.CannotWrite) as error:
        return {"tile": tile, "stop": str(error)}
    except (Refused, EngineGone) as error:
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


def _made(plan: Plan, tile: tuple[int, int]) -> tuple[rows.Columns, int]:
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            return _asked(plan, tile, _engine_of(plan))
        except (EngineGone, rows.BadRows) as error:
            _drop_engine()  # Whatever it was in the middle of.
            if attempt == _ATTEMPTS:
                raise EngineGone(f"{_ATTEMPTS} engines in a row could not make it. {error} Bake again: it makes only what is missing.") from error
    raise AssertionError


def _asked(plan: Plan, tile: tuple[int, int], engine: TileEngine | TileFolder) -> tuple[rows.Columns, int]:
    """The sorted rows of a tile, and how many of them have a shear."""
    area = plan.grid.area_of(tile)
    parts, sheared = [], 0
    for made, data in engine.rows(tile):
        part, leaning = rows.parse(data, made["layer"], plan.layers[made["layer"]])
        within = inside(area, made["bounds"], part["x"], part["z"])
        parts.append(part if within is None else {name: column[within] for name, column in part.items()})
        sheared += leaning
    return rows.joined(parts), sheared


def _entry(plan: Plan, path: Path, columns: rows.Columns, marks: dict[str, str]) -> dict:
    counts = np.bincount(columns["layer"], minlength=1)
    return {
        "file": path.relative_to(plan.out).as_posix(),
        "rows": len(columns["id"]),
        "rows_of_layer": [int(counts[layer]) if layer < len(counts) else 0 for layer in plan.layers],
        "digest": marks["thicket.digest"],
        "bounds": rows.bounds(columns),
        "sheared": int(marks["thicket.sheared"]),
    }


def _pixels(plan: Plan, columns: rows.Columns) -> list[tuple[np.ndarray, np.ndarray]]:
    """For each layer the pixels of the map that instances stand in, as row << 16 | column, and how many stand there."""
    found = []
    for layer in plan.layers:
        own = columns["layer"] == layer
        column = np.clip((columns["x"][own] - plan.rect[0]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        row = np.clip((columns["z"][own] - plan.rect[1]) // plan.pixel, 0, 0xFFFF).astype(np.uint32)
        found.append(np.unique(row << np.uint32(16) | column, return_counts=True))
    return found
