"""Estimates the size and the duration of a bake before it writes anything. Bakes a sample of the tiles without storing
them."""

from __future__ import annotations

import math
import os
import random
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from distributed import Client, wait

from . import files, schedule, tile
from .location import is_local
from .words import amount, duration

if TYPE_CHECKING:
    from .location import Location

# The size of a row in a file, in bytes. Rows compress to about 38 bytes.
ROW_BYTES = 45.0
# A bake that can exceed neither this size nor this fraction of the free space is not sampled.
SMALL_BYTES, SMALL_PART = 1e9, 0.1
# Larger or longer bakes start only if the user confirms them.
LARGE_BYTES, LONG_SECONDS = 1e10, 3600.0
# The fraction of the free space that a bake may fill without confirmation.
FILLED = 0.9
# One of this many tiles is sampled, up to the maximum number of samples. A bake with fewer tiles is not sampled, because the
# samples would take a large part of its time.
TILES_A_SAMPLE, MOST_SAMPLES, FEWEST_TILES = 20, 24, 8
# The time after which unfinished samples are ignored, in seconds.
SAMPLE_SECONDS = 60.0
# The driver's CPU time per tile, in seconds, as measured in ../README.md.
DRIVER_SECONDS = 0.008


@dataclass(frozen=True)
class Sample:
    """A tile that was baked but not stored."""

    area: float  # In square meters.
    rows: int
    bytes: int
    core_seconds: float


@dataclass(frozen=True)
class Estimate:
    """The expected size of a bake."""

    tiles: int
    samples: int  # The number of sampled tiles. If it is 0, `rows` and `bytes` are upper limits.
    rows: float
    bytes: float
    error: float  # Twice the standard error of `rows` and `bytes`, relative to their values.
    seconds: float | None  # None if no tile was sampled.
    free: float  # The space that the output folder's disk has, in bytes.

    def __str__(self) -> str:
        if not self.tiles:
            return "no tiles are missing"
        qualifier = "about" if self.samples else "at most"
        low, high = max(1.0 - self.error, 0.0) * self.bytes, (1.0 + self.error) * self.bytes
        size_range = f" ({amount(low)}B to {amount(high)}B)" if self.error > 0.05 else ""
        time_text = f", {duration(self.seconds)}" if self.seconds is not None else ""
        source = f"estimated from {self.samples} of them" if self.samples else "from the density of the layers"
        free_text = f"; {amount(self.free)}B are free" if self.free < math.inf else ""
        return f"{self.tiles:,} tiles: {qualifier} {amount(self.rows)} instances, {amount(self.bytes)}B{size_range}{time_text} ({source}){free_text}"

    @property
    def concern(self) -> str:
        """Returns the reason why the bake needs a confirmation, or "" if it needs none."""
        if self.bytes > FILLED * self.free:
            return f"it may not fit into the {amount(self.free)}B of free space"
        if self.bytes > LARGE_BYTES:
            return f"it is larger than {amount(LARGE_BYTES)}B"
        if (self.seconds or 0.0) > LONG_SECONDS:
            return f"it takes longer than {duration(LONG_SECONDS)}"
        return ""


def missing_tiles(out: Location, tiles: Sequence[tuple[int, int]], fresh: bool) -> list[tuple[int, int]]:
    """Returns the tiles that have no file yet, or all of them if existing files will be removed."""
    existing_files = set() if fresh else files.names_of_tiles(out)
    return [tile_index for tile_index in tiles if files.tile_path(out, tile_index).name not in existing_files]


def estimate(
    plan: tile.Plan, client: Client, tiles: Sequence[tuple[int, int]], density: float | None, starting: float, free: float,
    workers: int | None, say: Callable[[str], None], always: bool = False,
) -> Estimate | None:  # fmt: skip
    """Returns the expected size of these tiles. Returns None if it is unknown or, without `always`, if it is certainly
    small.

    `density` is the largest possible number of instances per square meter, or None if it is unknown. `starting` is the
    startup time of an engine in seconds. `workers` is the number of workers on this machine, or None for the workers of a
    cluster."""
    if not tiles:
        return Estimate(0, 0, 0.0, 0.0, 0.0, 0.0, free) if always else None
    areas = {tile_index: _area(plan, tile_index) for tile_index in tiles}
    limit = math.inf if density is None else density * sum(areas.values())
    if not always and limit * ROW_BYTES <= min(SMALL_BYTES, SMALL_PART * free):
        return None
    samples = _sampled(plan, client, tiles, areas, say) if always or len(tiles) >= FEWEST_TILES else []
    if samples:
        cores = len(os.sched_getaffinity(0)) if workers is not None else None
        return from_samples(samples, len(tiles), sum(areas.values()), starting, free, workers or sum(client.nthreads().values()), cores)
    return Estimate(len(tiles), 0, limit, limit * ROW_BYTES, 0.0, None, free) if limit < math.inf else None


def from_samples(samples: Sequence[Sample], tiles: int, area: float, starting: float, free: float, workers: int, cores: int | None) -> Estimate:
    """Extrapolates from samples to `tiles` tiles with this area in square meters."""
    rows, sampled_bytes, sampled_area = (sum(getattr(sample, name) for sample in samples) for name in ("rows", "bytes", "area"))
    costs = schedule.Costs([sample.core_seconds for sample in samples], starting, DRIVER_SECONDS, sampled_bytes / len(samples))
    seconds = schedule.simulate(schedule.larger(costs, tiles), max(workers, 1), cores)
    return Estimate(tiles, len(samples), rows / sampled_area * area, sampled_bytes / sampled_area * area, _error(samples, tiles), seconds, free)


def _error(samples: Sequence[Sample], tiles: int) -> float:
    """Returns twice the standard error of the extrapolated size, relative to that size. The size per square meter is a
    ratio of two sums, so the error follows from each sample's deviation from that ratio."""
    count = len(samples)
    total, area = sum(sample.bytes for sample in samples), sum(sample.area for sample in samples)
    if count < 2 or total == 0:
        return 1.0 if count < min(tiles, 2) else 0.0
    squares = sum((sample.bytes - total / area * sample.area) ** 2 for sample in samples)
    return 2.0 * math.sqrt(max(1.0 - count / tiles, 0.0) * squares * count / (count - 1)) / total


def _area(plan: tile.Plan, tile_index: tuple[int, int]) -> float:
    low_x, low_z, high_x, high_z = plan.grid.area_of(tile_index)
    return (high_x - low_x) * (high_z - low_z)


def tiles_to_sample(tiles: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Returns the tiles to sample: a random tile from each of several equally long parts of the list. The same list always
    has the same sample."""
    count = min(MOST_SAMPLES, max(2, len(tiles) // TILES_A_SAMPLE), len(tiles))
    rng = random.Random(1)
    return [tiles[rng.randrange(slice_index * len(tiles) // count, (slice_index + 1) * len(tiles) // count)] for slice_index in range(count)]


def _sampled(plan: tile.Plan, client: Client, tiles: Sequence[tuple[int, int]], areas: dict[tuple[int, int], float], say: Callable[[str], None]) -> list[Sample]:
    """Bakes samples of the tiles. Omits tiles that fail or take too long."""
    sample = tiles_to_sample(tiles)
    say(f"Baking {len(sample)} of {len(tiles):,} tiles to estimate the size of the bake. They are not stored.")
    futures = {client.submit(tile.measure, plan, tile_index, pure=False, retries=0): tile_index for tile_index in sample}
    try:
        with client.as_current():
            wait(list(futures), timeout=SAMPLE_SECONDS)
    except TimeoutError:
        client.cancel([future for future in futures if not future.done()])
    results = {tile_index: future.result() for future, tile_index in futures.items() if future.status == "finished"}
    return [Sample(areas[tile_index], *values) for tile_index, values in results.items() if values is not None]


def free_space(out: Location, fresh: bool) -> float:
    """Returns the free bytes of the disk that contains the folder. Object stores have no limit. If `fresh` is set, includes the tiles that will be
    removed."""
    if not is_local(out):
        return math.inf
    return shutil.disk_usage(out).free + (files.size_of_tiles(out) if fresh else 0)
