"""Bakes a scene into a folder: plans the tiles, distributes them to workers, updates the manifest and writes the report."""

from __future__ import annotations

import hashlib
import random
import statistics
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from distributed import Client, as_completed

from . import cluster, files, forecast, tile
from .format import FORMAT, MANIFEST, VERSION, BakeError, name_of, tile_of_name
from .grid import TileGrid
from .location import location
from .manifest import check_manifest, read_manifest
from .report import Map, Outcome, Progress, write_report
from .tile_engine import EngineGone, Rejected, Source
from .tile_folder import MadeTiles

if TYPE_CHECKING:
    from .location import Location

# The longer side of the map in pixels.
MAP_PIXELS = 1024
# The maximum fraction of the time that is spent on writing the manifest.
MANIFEST_SHARE = 0.05


@dataclass
class BakeRequest:
    """The settings of a bake."""

    source: Source | MadeTiles
    out: Location
    requested: dict[str, str] = field(default_factory=dict)  # rect, tile_size and layers, in the format of scene_description.gd.
    tiles: list[tuple[int, int]] | None = None  # The tiles to bake; None for all tiles that overlap the rectangle.
    workers: int = 1
    scheduler: str | None = None
    shuffle: int | None = None  # The seed of a random order; None for the order of the grid.
    fresh: bool = False
    # Called before the bake changes the folder, unless the bake is certainly small. Prevents the bake if it raises an exception.
    confirm: Callable[[forecast.Estimate], None] | None = None
    always_estimate: bool = False  # Call `confirm` for small bakes too.


def bake(request: BakeRequest, say: Callable[[str], None] = print) -> Outcome:
    """Starts a bake, or continues an earlier one. Returns its outcome, even if tiles failed or the bake stopped early.
    Raises BakeError if it cannot start."""
    try:
        with files.locked(request.out):
            files.sweep(request.out)
            try:
                with cluster.client(request.workers, request.scheduler, say) as client:
                    return _bake(request, client, say)
            finally:
                files.sweep(request.out)  # Killed workers leave unfinished files.
    except (files.FolderInUse, files.CannotWrite) as error:
        raise BakeError(str(error)) from error
    except (OSError, TimeoutError) as error:
        if request.scheduler is None:
            raise
        raise BakeError(f"No Dask scheduler answers at {request.scheduler}: {error}. Check --scheduler (tcp://HOST:PORT), or leave it out.") from error


def _bake(request: BakeRequest, client: Client, say: Callable[[str], None]) -> Outcome:
    plan, manifest, starting = _begin(request, client, say)
    order = _tiles_of(request, plan.grid)
    if request.shuffle is not None:
        random.Random(request.shuffle).shuffle(order)
    outcome = Outcome(manifest, starting=[starting])
    picture = Map(plan.rect, plan.pixel, manifest["layers"])
    start = time.monotonic()
    start_cpu = time.process_time()
    try:
        _make_all(plan, client, request.workers, order, outcome, picture, Progress(len(order), say))
    finally:
        outcome.seconds = time.monotonic() - start
        outcome.driver_seconds = time.process_time() - start_cpu
        _store_costs(outcome)
        _finish(request.out, plan.grid, outcome)
    if not outcome.stopped:
        _close_engines(request, client)
    write_report(request.out, request.workers, outcome, picture)
    return outcome


def _begin(request: BakeRequest, client: Client, say: Callable[[str], None]) -> tuple[tile.Plan, dict, float]:
    """Returns the plan, the manifest (which is already on disk), and the startup time of an engine in seconds."""
    try:
        described = client.submit(tile.describe, request.source, request.requested, pure=False).result()
    except (EngineGone, Rejected) as error:
        raise BakeError(str(error)) from error
    for problem in described["problems"]:
        say(f"The scene warns: {problem}")
    rect, layers, grid = list(map(float, described["rect"])), described["layers"], TileGrid.of(described)
    cut_layers = [layer["name"] or str(layer["index"]) for layer in layers if grid.tile_size % layer["tile_size"] != 0.0]
    if cut_layers:
        say(f"Tiles of {grid.tile_size:g} m cut through tiles of the game, which are therefore generated more than once: {', '.join(cut_layers)}. Choose a --tile-size that is a multiple of all their sizes.")
    plan = tile.Plan(
        source=request.source, requested=request.requested, out=str(request.out), rect=tuple(rect), grid=grid, scene_digest=described["scene_digest"],
        layers={layer["index"]: described["columns"][str(layer["index"])] for layer in layers},
        parts=described["parts"], pixel=max(rect[2], rect[3]) / MAP_PIXELS,
    )  # fmt: skip
    models = {entry["index"]: entry for entry in described["models"]}
    manifest = {
        "format": FORMAT, "version": VERSION, "thicket": described["thicket"],
        "scene": request.source.scene, "scene_digest": plan.scene_digest, "scene_parts": plan.parts, "seed": int(described["seed"]),
        "rect": rect, "tile_size": grid.tile_size, "grid": list(grid.grid), "world_offset": described["world_offset"],
        "layers": [{**layer, "models": models[layer["index"]]["models"], "material": models[layer["index"]]["material"]} for layer in layers],
        "complete": False, "digest": None, "costs": None, "tiles": {},
    }  # fmt: skip
    _check_tiles(_tiles_of(request, grid), grid)
    if not request.fresh:
        _resume(request, manifest, say)
    _confirm(request, client, plan, described, say)
    if request.fresh:
        files.empty(request.out)
    files.sweep_strays(request.out, set(grid.tiles()))
    for path, content in described["files"].items():
        if any(path.startswith(f"models/{layer['index']}_") for layer in layers):
            files.write_whole(request.out / path, content)
    files.write_manifest(request.out, manifest)
    return plan, manifest, described["starting"]


def _resume(request: BakeRequest, manifest: dict, say: Callable[[str], None]) -> None:
    """Reuses the tiles of an earlier bake in the folder, complete or not. Raises BakeError if that bake is of another world
    or version. A manifest that cannot be read is ignored."""
    try:
        old_manifest = read_manifest(request.out)
    except BakeError as error:
        if (request.out / MANIFEST).exists():
            say(f"{error}. It is replaced; every tile in the folder is checked.")
        return  # Existing tiles can still be reused, because each file identifies its bake.
    advice = f"Bake into another folder, or start again in {request.out} with --fresh."
    if old_manifest.get("version") != VERSION:
        raise BakeError(f"{request.out} contains a bake of version {old_manifest.get('version')}, but this is version {VERSION}. {advice}")
    check_manifest(old_manifest, request.out / MANIFEST)
    if old_manifest["scene"] != manifest["scene"]:
        raise BakeError(f"{request.out} contains a bake of another scene, {old_manifest['scene']}, not {manifest['scene']}. {advice}")
    for key, name in {"rect": "the rectangle", "tile_size": "the tile size"}.items():
        if old_manifest[key] != manifest[key]:
            raise BakeError(f"{request.out} contains a bake in which {name} is {old_manifest[key]}, not {manifest[key]}. {advice}")
    if [layer["index"] for layer in old_manifest["layers"]] != [layer["index"] for layer in manifest["layers"]]:
        raise BakeError(f"{request.out} contains a bake of different layers: {', '.join(str(layer['index']) for layer in old_manifest['layers'])}. {advice}")
    if old_manifest["scene_digest"] != manifest["scene_digest"]:
        parts = tile.changed_parts(old_manifest.get("scene_parts", {}), manifest["scene_parts"])
        raise BakeError(f"The scene {manifest['scene']} has changed since this bake was started: {parts}. {advice}")
    # Damaged files are detected when their tiles are needed.
    existing_files = {f"tiles/{name}" for name in files.names_of_tiles(request.out)}
    manifest["tiles"] = {name: entry for name, entry in old_manifest["tiles"].items() if entry["file"] in existing_files}
    manifest["costs"] = old_manifest.get("costs")


def _tiles_of(request: BakeRequest, grid: TileGrid) -> list[tuple[int, int]]:
    return request.tiles if request.tiles is not None else grid.tiles()


def _confirm(request: BakeRequest, client: Client, plan: tile.Plan, described: dict, say: Callable[[str], None]) -> None:
    """Passes an estimate of the missing tiles to the request's `confirm`."""
    if request.confirm is None:
        return
    missing = forecast.missing_tiles(request.out, _tiles_of(request, plan.grid), request.fresh)
    workers = request.workers if request.scheduler is None else None
    free_bytes = forecast.free_space(request.out, request.fresh)
    estimate = forecast.estimate(plan, client, missing, described.get("density"), described["starting"], free_bytes, workers, say, request.always_estimate)
    if estimate is None:
        if request.always_estimate:
            raise BakeError("The size cannot be estimated, because none of the sampled tiles could be generated. Bake one of them with --tiles to see the reason.")
        return
    try:
        request.confirm(estimate)
    except BaseException:
        _close_engines(request, client)
        raise


def _close_engines(request: BakeRequest, client: Client) -> None:
    """Stops the engines of an existing scheduler's workers, which keep running after the bake."""
    if request.scheduler is not None:
        client.run(tile.close_engines)


def _check_tiles(tiles: Iterable[tuple[int, int]], grid: TileGrid) -> None:
    for tile in tiles:
        if tile not in grid:
            first_x, first_z, columns, rows = grid.grid
            raise BakeError(f"Tile {name_of(tile)} is not in the rectangle: tiles go from {first_x},{first_z} to {first_x + columns - 1},{first_z + rows - 1}. Change --tiles or --rect.")


def _make_all(
    plan: tile.Plan, client: Client, workers: int, order: list[tuple[int, int]], outcome: Outcome, picture: Map, progress: Progress
) -> None:
    """Distributes the tiles and collects the results. About three tiles per worker are in progress at any time; workers
    that join later are included. Cancels all tiles once a worker reports that no tile can be generated."""
    remaining_tiles = iter(order)
    futures = as_completed([], loop=client.loop, with_results=True, raise_errors=False)
    tile_of_key: dict[str, tuple[int, int]] = {}

    def limit() -> int:
        return 4 + 3 * max(workers, sum(client.nthreads().values()))

    def hand_out(count: int) -> None:
        while len(tile_of_key) < count:
            tile_index = next(remaining_tiles, None)
            if tile_index is None:
                return
            future = client.submit(tile.make, plan, tile_index, outcome.manifest["tiles"].get(name_of(tile_index), {}), pure=False, retries=0)
            tile_of_key[future.key] = tile_index
            futures.add(future)

    in_progress = limit()
    hand_out(in_progress)
    next_manifest = time.monotonic() + 2.0
    for future, result in futures:
        tile_index = tile_of_key.pop(future.key)
        _record_result(tile_index, result if future.status == "finished" else {"failed": _worker_problem(result)}, outcome, picture)
        future.release()
        if outcome.stopped:
            client.cancel([pending for pending in futures.futures])
            return
        progress.print_if_due(outcome)
        if time.monotonic() >= next_manifest:
            start = time.monotonic()
            files.write_manifest(location(plan.out), outcome.manifest)
            next_manifest = time.monotonic() + max(2.0, (time.monotonic() - start) / MANIFEST_SHARE)
            in_progress = limit()  # More workers may have joined.
        hand_out(in_progress)
    progress.end(outcome)


def _worker_problem(result: object) -> str:
    error = result[1] if isinstance(result, tuple) and len(result) > 1 else result
    return f"Its workers were killed or failed: {error}. Check their memory, then run the same command: it generates only the missing tiles."


def _record_result(tile_index: tuple[int, int], result: dict, outcome: Outcome, picture: Map) -> None:
    name = name_of(tile_index)
    if "stop" in result or "failed" in result:
        outcome.manifest["tiles"].pop(name, None)
        outcome.stopped = result.get("stop", "")
        if "failed" in result:
            outcome.failed[tile_index] = result["failed"]
        return
    old_entry = outcome.manifest["tiles"].get(name, {})
    costs = {cost: round(result[cost], 4) if result["made"] else old_entry.get(cost) for cost in ("seconds", "core_seconds")}
    outcome.manifest["tiles"][name] = {**result["entry"], **costs}
    outcome.kept += not result["made"]
    outcome.made += result["made"]
    outcome.made_rows += result["entry"]["rows"] * result["made"]
    outcome.busy_seconds += result["seconds"]
    outcome.core_seconds += result["core_seconds"]
    outcome.starting += [result["starting"]] if result["starting"] else []
    outcome.bytes += result["bytes"]
    outcome.worker_memory = max(outcome.worker_memory, result["memory"][0])
    outcome.engine_memory = max(outcome.engine_memory, result["memory"][1])
    picture.add(result["pixels"])


def _store_costs(outcome: Outcome) -> None:
    """Stores the costs that do not belong to single tiles in the manifest, if the run has generated enough tiles (see
    schedule.py)."""
    if outcome.made >= 10:
        outcome.manifest["costs"] = {
            "start_seconds": round(statistics.median(outcome.starting), 3),
            "driver_seconds": round(outcome.driver_seconds_a_tile, 6),
            "bytes": round(outcome.bytes / (outcome.made + outcome.kept)),
        }


def world_digest(tiles: dict[str, dict]) -> str:
    """Returns the digest of a complete bake: the SHA-256 of the lines "i,j digest" of all tiles, sorted by i, then
    j."""
    lines = [f"{name} {tiles[name]['digest']}\n" for name in sorted(tiles, key=tile_of_name)]
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _finish(out: Location, grid: TileGrid, outcome: Outcome) -> None:
    """Completes the manifest. If the manifest cannot be written, only records the reason, because the next run finds
    the tiles on disk."""
    manifest = outcome.manifest
    manifest["complete"] = set(manifest["tiles"]) == {name_of(tile_index) for tile_index in grid.tiles()}
    manifest["digest"] = world_digest(manifest["tiles"]) if manifest["complete"] else None
    try:
        files.write_manifest(out, manifest)
    except files.CannotWrite as error:
        outcome.stopped = outcome.stopped or str(error)
