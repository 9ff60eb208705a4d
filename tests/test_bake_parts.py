"""What a bake consists of, by itself: which tiles there are, and what is said of a scheduler."""

from __future__ import annotations

import json
import sys
import threading

import numpy as np
from conftest import REPO, new_project

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import cluster  # noqa: E402 (only on the path above)
from baking.grid import TileGrid, inside  # noqa: E402


def test_areas_share_instances_among_them(godot, tmp_path):
    """Every place of a tile of the game is in exactly one of the tiles of a bake, edges and what lies beyond them included."""
    rect = [-1e5 - 17.0, 2e6, 96.5, 81.25]
    sizes = ((32.0, 32.0), (27.0, 20.0), (10.3, 0.7), (64.0, 33.3))
    cases = [json.dumps([rect, size, game_size]) for size, game_size in sizes]
    done = godot(["--path", new_project(tmp_path), "--script", REPO / "tests/bakes/dump_grid.gd", "--", *cases], timeout=60)
    described = [json.loads(line.removeprefix("grid ")) for line in done.stdout.splitlines() if line.startswith("grid ")]
    assert len(described) == len(sizes), done.stdout + done.stderr
    for each in described:
        check_areas(rect, TileGrid.of(each), each["parts"], np.random.default_rng(3))


def check_areas(rect: list[float], grid: TileGrid, parts: dict[str, list[dict]], chance: np.random.Generator) -> None:
    tiles = grid.tiles()
    assert len(tiles) == grid.grid[2] * grid.grid[3] == len(parts) and all(tile in grid for tile in tiles)
    assert (tiles[0][0] - 1, tiles[0][1]) not in grid and (tiles[-1][0], tiles[-1][1] + 1) not in grid
    bounds_of = {(part["x"], part["y"]): part["bounds"] for each in parts.values() for part in each}
    for game in chance.permutation(list(bounds_of))[:40].tolist():
        bounds = bounds_of[tuple(game)]
        low, high = np.array(bounds[:2]), np.array(bounds[2:])
        x, z = (np.concatenate([chance.uniform(low[axis] - 0.1, high[axis] + 0.1, 50), [low[axis], high[axis]]]) for axis in (0, 1))
        homes = np.zeros(len(x), int)
        for tile in tiles:
            if any([part["x"], part["y"]] == game for part in parts[f"{tile[0]},{tile[1]}"]):
                within = inside(grid.area_of(tile), bounds, x, z)
                homes += 1 if within is None else within
        places = [np.clip(along, low[axis], np.nextafter(high[axis], -np.inf)) for axis, along in enumerate((x, z))]
        wanted = [(place >= rect[axis]) & (place < rect[axis] + rect[axis + 2]) for axis, place in enumerate(places)]
        assert np.array_equal(homes, (wanted[0] & wanted[1]).astype(int)), (grid.tile_size, game)


def test_it_is_said_when_a_scheduler_has_no_workers(monkeypatch):
    """And when it has some again; once each."""
    counts = [2, 0, 0, 3, 3, 0]
    looked = threading.Event()

    class Scheduler:
        def nthreads(self) -> dict[str, int]:
            if not counts:
                looked.set()
                raise OSError("gone")
            return {f"worker {number}": 1 for number in range(counts.pop(0))}

    monkeypatch.setattr(cluster, "LOOK_SECONDS", 0.01)
    said: list[str] = []
    with cluster.watched(Scheduler(), "tcp://here:1", said.append):
        assert looked.wait(10.0)
    assert [each.split(":1", 1)[1][:16] for each in said] == [" has no workers:", " has workers: 3.", " has no workers:"]
