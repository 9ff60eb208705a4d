"""Foretells how long a bake takes with more workers than there are, from what one cost that was made.

    python -m baking.schedule out/ [--workers 1,2,10,100,1000] [--cores 2] [--tiles 1000000]

A bake's manifest says how much processor time each tile took of a worker and its engine, how long an engine takes to start, and what the
driver did itself for each tile. Here every worker has a core, on which a tile takes as long as its processor time: a worker whose machine
had idle cores was faster than that, for its engine goes on while it packs rows, and would not be so beside others. Workers take tiles in
the order in which they were handed out, and the driver serves one of them at a time, on a core of its own unless `--cores` says how many
all of them share. What is not in it: that more workers on one machine share its memory and its disk, and how fast a shared file system
takes the files; the least rate that it has to have is told.
"""

from __future__ import annotations

import argparse
import heapq
import random
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .format import MANIFEST, BakeError
from .manifest import check_costs, read_manifest
from .words import amount, duration


@dataclass(frozen=True)
class Costs:
    """What a bake was measured to take."""

    tiles: Sequence[float]  # Core-seconds of a worker with its engine, of each tile.
    start: float  # Seconds of a worker before its first tile.
    driver: float  # Seconds of the driver for each tile.
    bytes: float  # Of a tile's file, on average.

    @property
    def work(self) -> float:
        return sum(self.tiles)


@dataclass(frozen=True)
class Forecast:
    """How a bake goes with so many workers."""

    workers: int
    seconds: float
    bound: str  # What the time is spent on, mostly.
    speed: float  # Times as fast as one worker.
    bytes_a_second: float


def read_costs(folder: Path) -> Costs:
    """What the manifest of a bake says. Raises BakeError where it says nothing."""
    manifest = read_manifest(folder)
    check_costs(manifest, folder / MANIFEST)
    seconds = [tile["core_seconds"] for tile in manifest["tiles"].values() if tile.get("core_seconds") is not None]
    costs = manifest.get("costs")
    if not seconds or not costs:
        raise BakeError(f"{folder / MANIFEST} does not say what its tiles cost. Bake 10 tiles or more in one run.")
    return Costs(seconds, costs["start_seconds"], costs["driver_seconds"], costs["bytes"])


def larger(costs: Costs, tiles: int, seed: int = 1) -> Costs:
    """A world of so many tiles, each as expensive as one that was measured, drawn at random."""
    chance = random.Random(seed)
    return Costs(chance.choices(list(costs.tiles), k=tiles), costs.start, costs.driver, costs.bytes)


def simulate(costs: Costs, workers: int, cores: int | None = None) -> float:
    """Seconds until the last tile is there. A worker asks the driver for a tile, waits until it is its turn, and makes it. With a number
    of cores workers and driver share these, else each has its own."""
    free = [(costs.start, worker) for worker in range(workers)]  # When each asks for its next tile.
    driver = 0.0  # Until when the driver is busy.
    last = 0.0
    for seconds in costs.tiles:
        asked, worker = heapq.heappop(free)
        driver = max(driver, asked) + costs.driver
        done = driver + seconds
        last = max(last, done)
        heapq.heappush(free, (done, worker))
    return last if cores is None else max(last, costs.start + _shared(costs, cores))


def _shared(costs: Costs, cores: int) -> float:
    """Seconds that so many cores take for all work, the driver's included."""
    return (costs.work + costs.driver * len(costs.tiles)) / cores


def forecast(costs: Costs, workers: int, alone: float, cores: int | None = None) -> Forecast:
    """With `alone` seconds for one worker."""
    seconds = simulate(costs, workers, cores)
    parts = {
        "tiles": costs.work / workers,
        "the driver": costs.driver * len(costs.tiles),
        "the longest tile": max(costs.tiles),
        "engines that start": costs.start,
        "the cores": _shared(costs, cores) if cores is not None else 0.0,
    }
    return Forecast(workers, seconds, max(parts, key=parts.__getitem__), alone / seconds, costs.bytes * len(costs.tiles) / seconds)


def table(costs: Costs, workers: Sequence[int], cores: int | None = None) -> str:
    """A forecast for each number of workers, in Markdown."""
    alone = simulate(costs, 1, cores)
    lines = [
        f"{len(costs.tiles):,} tiles of {costs.work / len(costs.tiles):.3g} core-seconds on average, {max(costs.tiles):.3g} at most; "
        f"{costs.start:.3g} s for an engine to start, {1000 * costs.driver:.3g} ms of the driver and {amount(costs.bytes)}B for each tile. "
        + (f"All share {cores} {'core' if cores == 1 else 'cores'}." if cores is not None else "Every worker and the driver have a core each."),
        "",
        "| Workers | Time | Times as fast as one | What the time goes to | Written, a second |",
        "| ---: | ---: | ---: | --- | ---: |",
    ]
    for count in workers:
        one = forecast(costs, count, alone, cores)
        lines.append(f"| {count:,} | {duration(one.seconds)} | {one.speed:.1f} | {one.bound} | {amount(one.bytes_a_second)}B |")
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="baking.schedule", description="Foretells how long a bake takes with more workers.")
    parser.add_argument("out", type=Path, help="the folder of a bake")
    parser.add_argument("--workers", default="1,2,10,100,1000", help="how many (%(default)s)")
    parser.add_argument("--cores", type=int, help="how many they share, on one machine; else every worker has one, and so has the driver")
    parser.add_argument("--tiles", type=int, help="for a world of so many tiles that cost the same; else for the bake itself")
    chosen = parser.parse_args(arguments)
    counts = chosen.workers.split(",")
    if not all(count.strip().isdecimal() for count in counts):
        parser.error(f"--workers is '{chosen.workers}', and has to be whole numbers with commas between, such as 1,10,100")
    workers = [int(count) for count in counts]
    if min([*workers, *(count for count in (chosen.cores, chosen.tiles) if count is not None)]) < 1:
        parser.error(f"--workers {chosen.workers}, --cores {chosen.cores} and --tiles {chosen.tiles}: all have to be 1 or more")
    try:
        costs = read_costs(chosen.out)
    except BakeError as error:
        print(f"schedule: {error}", file=sys.stderr)
        return 2
    print(table(larger(costs, chosen.tiles) if chosen.tiles else costs, workers, chosen.cores))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
