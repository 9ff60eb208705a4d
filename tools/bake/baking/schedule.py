"""Foretells how long a bake takes with more workers than there are, from what one cost that was made.

    python -m baking.schedule out/ [--workers 1,2,10,100,1000] [--tiles 1000000]

A bake's manifest says how long each tile took, how long an engine takes to start, and what the driver did itself for each tile. Here
workers take tiles in the order in which they were handed out, and the driver serves one of them at a time. What is not in it: that more
workers on one machine share its memory and its disk, and how fast a shared file system takes the files; the least rate that it has to
have is told.
"""

from __future__ import annotations

import argparse
import heapq
import random
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .format import MANIFEST, BakeError, read_manifest
from .words import amount, duration


@dataclass(frozen=True)
class Costs:
    """What a bake was measured to take."""

    tiles: Sequence[float]  # Seconds of a worker, of each tile.
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
    seconds = [tile["seconds"] for tile in manifest["tiles"].values() if tile.get("seconds") is not None]
    costs = manifest.get("costs")
    if not seconds or not costs:
        raise BakeError(f"{folder / MANIFEST} does not say what its tiles cost: a run has to make 10 of them at least.")
    return Costs(seconds, costs["start_seconds"], costs["driver_seconds"], costs["bytes"])


def larger(costs: Costs, tiles: int, seed: int = 1) -> Costs:
    """A world of so many tiles, each as expensive as one that was measured, drawn at random."""
    chance = random.Random(seed)
    return Costs(chance.choices(list(costs.tiles), k=tiles), costs.start, costs.driver, costs.bytes)


def simulate(costs: Costs, workers: int) -> float:
    """Seconds until the last tile is there. A worker asks the driver for a tile, waits until it is its turn, and makes it."""
    free = [(costs.start, worker) for worker in range(workers)]  # When each asks for its next tile.
    driver = 0.0  # Until when the driver is busy.
    last = 0.0
    for seconds in costs.tiles:
        asked, worker = heapq.heappop(free)
        driver = max(driver, asked) + costs.driver
        done = driver + seconds
        last = max(last, done)
        heapq.heappush(free, (done, worker))
    return last


def forecast(costs: Costs, workers: int, alone: float) -> Forecast:
    """With `alone` seconds for one worker."""
    seconds = simulate(costs, workers)
    parts = {
        "tiles": costs.work / workers,
        "the driver": costs.driver * len(costs.tiles),
        "the longest tile": max(costs.tiles),
        "engines that start": costs.start,
    }
    return Forecast(workers, seconds, max(parts, key=parts.__getitem__), alone / seconds, costs.bytes * len(costs.tiles) / seconds)


def table(costs: Costs, workers: Sequence[int]) -> str:
    """A forecast for each number of workers, in Markdown."""
    alone = simulate(costs, 1)
    lines = [
        f"{len(costs.tiles):,} tiles of {costs.work / len(costs.tiles):.3g} s on average, {max(costs.tiles):.3g} s at most; {costs.start:.3g} s for an engine "
        f"to start, {1000 * costs.driver:.3g} ms of the driver and {amount(costs.bytes)}B for each tile.",
        "",
        "| Workers | Time | Times as fast as one | What the time goes to | Written, a second |",
        "| ---: | ---: | ---: | --- | ---: |",
    ]
    for count in workers:
        one = forecast(costs, count, alone)
        lines.append(f"| {count:,} | {duration(one.seconds)} | {one.speed:.1f} | {one.bound} | {amount(one.bytes_a_second)}B |")
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="baking.schedule", description="Foretells how long a bake takes with more workers.")
    parser.add_argument("out", type=Path, help="the folder of a bake")
    parser.add_argument("--workers", default="1,2,10,100,1000", help="how many (%(default)s)")
    parser.add_argument("--tiles", type=int, help="for a world of so many tiles that cost the same; else for the bake itself")
    chosen = parser.parse_args(arguments)
    workers = [int(count) for count in chosen.workers.split(",")]
    if min(workers) < 1 or (chosen.tiles is not None and chosen.tiles < 1):
        parser.error("--workers and --tiles have to be 1 at least")
    try:
        costs = read_costs(chosen.out)
    except BakeError as error:
        print(f"schedule: {error}", file=sys.stderr)
        return 2
    print(table(larger(costs, chosen.tiles) if chosen.tiles else costs, workers))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
