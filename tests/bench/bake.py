"""Measures the speedup of a bake with two workers, and the accuracy of its forecast (baking.schedule).

    bash tests/bench/bake.sh [ROUNDS = 3] [FOLDER]

The benchmark bakes 64 tiles of the demo (12 million instances) into FOLDER (default: a temporary one) with three setups: one
worker on one core, two workers on two cores, and one worker on two cores. The setups take turns, and their order
alternates between rounds. A worker and its engine run concurrently, so one worker with two cores uses more than one of
them. For a fair speedup, compare the second setup with the first: in both, each worker has one core. Times exclude the
start of Dask and the engines. Workers share the cores with the driver. All bakes must have the same digest.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from baking import schedule
from baking.command_line import REPO
from baking.driver import BakeRequest, bake
from baking.tile_engine import Source

SCENE = Source((str(REPO / "tools/godot"),), str(REPO / "demo_project"), "res://demo.tscn")
ASKED = {"rect": "-6144,-6144,12288,12288", "tile_size": "1536", "layers": "Oak,Spruce,Shrub,Stones"}
# The number of workers and cores of each setup.
CONTENDERS = ((1, 1), (2, 2), (1, 2))


def once(out: Path, workers: int, cores: int) -> None:
    """Bakes in this process on `cores` cores and prints the costs."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:cores])
    outcome = bake(BakeRequest(SCENE, out, ASKED, workers=workers, fresh=True), lambda _: None)
    if outcome.failed or outcome.stopped:
        raise SystemExit(outcome.stopped or str(outcome.failed))
    print(json.dumps({
        "seconds": outcome.seconds, "workers": outcome.core_seconds, "driver": outcome.driver_seconds,
        "rows": outcome.made_rows, "digest": outcome.manifest["digest"],
    }))  # fmt: skip


def measured(out: Path, workers: int, cores: int) -> dict:
    command = [sys.executable, __file__, "--once", str(out), str(workers), str(cores)]
    result = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if result.returncode != 0:
        raise SystemExit(result.returncode)
    took = json.loads(result.stdout)
    costs = schedule.read_costs(out)
    # The prediction for two workers on two cores, computed from the costs of this bake. Like the measured time, it excludes the
    # start of engines.
    took["foretold"] = schedule.simulate(schedule.Costs(costs.tiles, 0.0, costs.driver, costs.bytes), 2, cores=2)
    return took


def row(what: str, values: list[float], unit: str, digits: int = 1) -> str:
    low, middle, high = (f"{value:.{digits}f}" for value in (min(values), statistics.median(values), max(values)))
    return f"| {what} | {middle} {unit} | {low} to {high} | {len(values)} |"


def name(workers: int, cores: int) -> str:
    return f"{workers} {'worker' if workers == 1 else 'workers'} on {cores} {'core' if cores == 1 else 'cores'}"


def main(rounds: int, folder: Path) -> None:
    if len(os.sched_getaffinity(0)) < 2:
        raise SystemExit("bake: this benchmark needs two cores")
    took: dict[tuple[int, int], list[dict]] = {contender: [] for contender in CONTENDERS}
    for round_index in range(rounds):
        for contender in CONTENDERS if round_index % 2 == 0 else CONTENDERS[::-1]:
            took[contender].append(measured(folder / "bake_{}_{}".format(*contender), *contender))
    digests = {run["digest"] for each in took.values() for run in each}
    if len(digests) != 1:
        raise SystemExit(f"bake: digests differ: {digests}")
    print(f"{took[1, 1][0]['rows']:,} instances; digest {digests.pop()}\n")
    print("| measurement | median | lowest to highest round | rounds |\n|---|---|---|---|")
    for contender, each in took.items():
        print(row(f"bake: {name(*contender)}", [run["seconds"] for run in each], "s"))
        print(row(f"bake: {name(*contender)}: workers and engines", [run["workers"] for run in each], "core-seconds"))
        print(row(f"bake: {name(*contender)}: the driver", [run["driver"] for run in each], "core-seconds", 2))
    two = [run["seconds"] for run in took[2, 2]]
    for contender in ((1, 1), (1, 2)):
        gains = [run["seconds"] / other for run, other in zip(took[contender], two, strict=True)]
        print(row(f"bake: 2 workers on 2 cores over {name(*contender)}", gains, "times", 2))
    for contender in CONTENDERS:
        errors = [run["foretold"] / other for run, other in zip(took[contender], two, strict=True)]
        print(row(f"bake: 2 workers on 2 cores, predicted from {name(*contender)}, over the measured time", errors, "of it", 2))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--once"]:
        once(Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]))
    elif len(sys.argv) > 2:
        main(int(sys.argv[1]), Path(sys.argv[2]))
    else:
        with tempfile.TemporaryDirectory() as scratch:
            main(int(sys.argv[1]) if len(sys.argv) > 1 else 3, Path(scratch))
