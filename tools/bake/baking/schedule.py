"""Predicts the duration of a bake with more workers, from the costs of a finished bake.

    python -m baking.schedule out/ [--workers 1,2,10,100,1000] [--cores 2] [--tiles 1000000]

The manifest contains the CPU time of each tile in a worker and its engine, the startup time of an engine, and the
driver's CPU time per tile. The prediction assumes one core per worker, so that a tile takes as long as its CPU time. On
a machine with idle cores, a worker is faster, because its engine runs while the worker packs rows. With many workers,
no cores are idle.

Workers take the tiles in the order of the bake. The driver serves one worker at a time. It has a separate core, unless
`--cores` sets the number of cores that all processes share. The prediction ignores that workers on one machine share
memory and a disk, and ignores the speed of a shared file system. It prints the write rate that the file system must
sustain.
"""

from __future__ import annotations

import argparse
import heapq
import random
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .command_line import place_argument
from .format import MANIFEST, BakeError
from .manifest import check_costs, read_manifest
from .words import amount, duration


@dataclass(frozen=True)
class Costs:
    """The measured costs of a bake."""

    tiles: Sequence[float]  # The CPU seconds of a worker and its engine for each tile.
    start: float  # The seconds before a worker's first tile.
    driver: float  # The driver's CPU seconds per tile.
    bytes: float  # The average size of a tile's file in bytes.

    @property
    def work(self) -> float:
        return sum(self.tiles)


@dataclass(frozen=True)
class Forecast:
    """The prediction for a number of workers."""

    workers: int
    seconds: float
    bound: str  # The bottleneck: the part of the work that takes the most time.
    speed: float  # The speedup relative to one worker.
    bytes_a_second: float


def read_costs(folder: Path) -> Costs:
    """Returns the costs in a bake's manifest. Raises BakeError if it has none."""
    manifest = read_manifest(folder)
    check_costs(manifest, folder / MANIFEST)
    seconds = [tile["core_seconds"] for tile in manifest["tiles"].values() if tile.get("core_seconds") is not None]
    costs = manifest.get("costs")
    if not seconds or not costs:
        raise BakeError(f"{folder / MANIFEST} has no costs of tiles. Bake 10 tiles or more in one run.")
    return Costs(seconds, costs["start_seconds"], costs["driver_seconds"], costs["bytes"])


def larger(costs: Costs, tiles: int, seed: int = 1) -> Costs:
    """Returns the costs of a world with `tiles` tiles. The cost of each is drawn at random from the measured tiles."""
    rng = random.Random(seed)
    return Costs(rng.choices(list(costs.tiles), k=tiles), costs.start, costs.driver, costs.bytes)


def simulate(costs: Costs, workers: int, cores: int | None = None) -> float:
    """Returns the seconds until the last tile is done. Each worker requests a tile from the driver, waits for its turn
    and generates the tile. If `cores` is given, the workers and the driver share that many cores. Otherwise each worker
    and the driver has a separate core."""
    workers_by_time = [(costs.start, worker) for worker in range(workers)]  # The time at which each worker requests its next tile.
    driver = 0.0  # The time until which the driver is busy.
    last_end = 0.0
    for seconds in costs.tiles:
        request_time, worker = heapq.heappop(workers_by_time)
        driver = max(driver, request_time) + costs.driver
        end = driver + seconds
        last_end = max(last_end, end)
        heapq.heappush(workers_by_time, (end, worker))
    return last_end if cores is None else max(last_end, costs.start + _shared(costs, cores))


def _shared(costs: Costs, cores: int) -> float:
    """Returns the seconds that this many cores take for the work of all workers, engines and the driver."""
    return (costs.work + costs.driver * len(costs.tiles)) / cores


def forecast(costs: Costs, workers: int, single_worker_seconds: float, cores: int | None = None) -> Forecast:
    """Returns the prediction for `workers` workers. `single_worker_seconds` is the time with one worker in seconds."""
    seconds = simulate(costs, workers, cores)
    bounds = {
        "tiles": costs.work / workers,
        "the driver": costs.driver * len(costs.tiles),
        "the longest tile": max(costs.tiles),
        "engines that start": costs.start,
        "the cores": _shared(costs, cores) if cores is not None else 0.0,
    }
    return Forecast(workers, seconds, max(bounds, key=bounds.__getitem__), single_worker_seconds / seconds, costs.bytes * len(costs.tiles) / seconds)


def table(costs: Costs, workers: Sequence[int], cores: int | None = None) -> str:
    """Returns a Markdown table with a prediction for each number of workers."""
    single_worker_seconds = simulate(costs, 1, cores)
    lines = [
        f"{len(costs.tiles):,} tiles of {costs.work / len(costs.tiles):.3g} core-seconds on average, {max(costs.tiles):.3g} at most; "
        f"{costs.start:.3g} s for an engine to start, {1000 * costs.driver:.3g} ms of the driver and {amount(costs.bytes)}B for each tile. "
        + (f"All share {cores} {'core' if cores == 1 else 'cores'}." if cores is not None else "Each worker and the driver has its own core."),
        "",
        "| Workers | Time | Speedup | Bottleneck | Written per second |",
        "| ---: | ---: | ---: | --- | ---: |",
    ]
    for count in workers:
        prediction = forecast(costs, count, single_worker_seconds, cores)
        lines.append(f"| {count:,} | {duration(prediction.seconds)} | {prediction.speed:.1f} | {prediction.bound} | {amount(prediction.bytes_a_second)}B |")
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="baking.schedule", description="Predicts the duration of a bake with more workers.")
    parser.add_argument("out", type=place_argument, help="the folder of a bake")
    parser.add_argument("--workers", default="1,2,10,100,1000", help="numbers of workers (%(default)s)")
    parser.add_argument("--cores", type=int, help="the number of cores that all share, on one machine; by default one for each worker and one for the driver")
    parser.add_argument("--tiles", type=int, help="predict for a world of this many similar tiles; by default for the bake itself")
    options = parser.parse_args(arguments)
    counts = options.workers.split(",")
    if not all(count.strip().isdecimal() for count in counts):
        parser.error(f"--workers must be integers separated by commas, such as 1,10,100, got '{options.workers}'")
    workers = [int(count) for count in counts]
    if min([*workers, *(count for count in (options.cores, options.tiles) if count is not None)]) < 1:
        parser.error(f"--workers, --cores and --tiles must all be 1 or more, got {options.workers}, {options.cores} and {options.tiles}")
    try:
        costs = read_costs(options.out)
    except BakeError as error:
        print(f"schedule: {error}", file=sys.stderr)
        return 2
    print(table(larger(costs, options.tiles) if options.tiles else costs, workers, options.cores))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
