"""What a bake consists of, by itself: which tiles there are, and what is said of a scheduler."""

from __future__ import annotations

import sys
import threading

import numpy as np
from conftest import REPO

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import cluster, grid  # noqa: E402 (only on the path above)


def test_areas_share_instances_among_them():
    """Every place of a tile of the game is in exactly one of the tiles of a bake, edges and what lies beyond them included."""
    chance = np.random.default_rng(3)
    for size, game_size in ((32.0, 32.0), (27.0, 20.0), (10.3, 0.7), (64.0, 33.3)):
        rect = [-1e5 - 17.0, 2e6, 96.5, 81.25]
        first_x, first_z, columns, rows = grid.grid_of(rect, size)
        tiles = grid.tiles_of([first_x, first_z, columns, rows])
        assert len(tiles) == columns * rows
        for game in chance.permutation(grid.game_tiles((rect[0], rect[1], rect[0] + rect[2], rect[1] + rect[3]), game_size))[:40].tolist():
            low = np.array(game) * game_size
            high = (np.array(game) + 1) * game_size
            x, z = (np.concatenate([chance.uniform(low[axis] - 0.1, high[axis] + 0.1, 50), [low[axis], high[axis]]]) for axis in (0, 1))
            homes = np.zeros(len(x), int)
            for tile in tiles:
                area = grid.area_of(rect, size, tile)
                if tuple(game) in grid.game_tiles(area, game_size):
                    within = grid.inside(area, game_size, tuple(game), x, z)
                    homes += 1 if within is None else within
            places = [np.clip(along, low[axis], np.nextafter(high[axis], -np.inf)) for axis, along in enumerate((x, z))]
            wanted = [(place >= rect[axis]) & (place < rect[axis] + rect[axis + 2]) for axis, place in enumerate(places)]
            assert np.array_equal(homes, (wanted[0] & wanted[1]).astype(int)), (size, game_size, game)


def test_tiles_are_of_a_size_that_fits():
    oak = {"tile_size": 192.0, "radius": 5.0}
    assert grid.default_size([0, 0, 1000, 1000], [oak]) == 384.0
    assert grid.default_size([0, 0, 1000, 1000], [oak, {"tile_size": 128.0, "radius": 5.0}]) == 384.0
    assert grid.default_size([0, 0, 100_000, 100_000], [oak]) == 1536.0
    assert grid.default_size([0, 0, 100_000, 100_000], [oak, {"tile_size": 64.0, "radius": 0.4}]) == 384.0
    assert grid.default_size([0, 0, 1000, 1000], [oak, {"tile_size": 100.5, "radius": 5.0}]) == 384.0


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
