"""Compares the predicted durations of bakes with values that were computed by hand."""

import json
import sys

import pytest
from conftest import REPO

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import schedule  # noqa: E402
from baking.format import FORMAT  # noqa: E402
from baking.schedule import Costs  # noqa: E402


def test_equal_tiles_take_rounds():
    costs = Costs([2.0] * 100, start=5.0, driver=0.0, bytes=10)
    assert schedule.simulate(costs, 1) == pytest.approx(205.0)
    assert schedule.simulate(costs, 10) == pytest.approx(25.0)
    # With 7 workers, there are 14 full rounds and one round with 2 tiles.
    assert schedule.simulate(costs, 7) == pytest.approx(5.0 + 15 * 2.0)
    assert schedule.simulate(costs, 1000) == pytest.approx(7.0)


def test_the_driver_serves_one_at_a_time():
    costs = Costs([1.0] * 1000, start=0.0, driver=0.01, bytes=10)
    assert schedule.simulate(costs, 1) == pytest.approx(1010.0)
    assert schedule.simulate(costs, 1000) == pytest.approx(11.0)
    assert schedule.forecast(costs, 1000, 1010.0).bound == "the driver"
    assert schedule.forecast(costs, 10, 1010.0).bound == "tiles"


def test_the_bottleneck_of_a_bake_is_reported():
    uneven = Costs([1.0] * 99 + [50.0], start=0.0, driver=0.001, bytes=10)
    assert schedule.forecast(uneven, 100, 149.0).bound == "the longest tile"
    assert schedule.simulate(uneven, 100) >= 50.0
    slow_start = Costs([1.0] * 100, start=30.0, driver=0.001, bytes=10)
    assert schedule.forecast(slow_start, 100, 130.0).bound == "engines that start"


def test_shared_cores_limit_a_bake():
    """Checks that the driver's work also uses the cores, and that more workers than cores do not make a bake faster."""
    costs = Costs([1.0] * 100, start=2.0, driver=0.1, bytes=10)
    assert schedule.simulate(costs, 2, cores=2) == pytest.approx(2.0 + (100.0 + 10.0) / 2, abs=0.2)
    assert schedule.simulate(costs, 8, cores=2) == pytest.approx(2.0 + (100.0 + 10.0) / 2)
    assert schedule.simulate(costs, 1, cores=2) == schedule.simulate(costs, 1), "a second core does not help a single worker"
    assert schedule.forecast(costs, 8, 110.0, cores=2).bound == "the cores"


@pytest.mark.parametrize("workers", [1, 2, 3, 10, 64])
def test_no_schedule_beats_its_bounds(workers):
    tiles = [0.1 + (7919 * index % 101) / 50.0 for index in range(500)]
    costs = Costs(tiles, start=1.0, driver=0.002, bytes=10)
    seconds = schedule.simulate(costs, workers)
    assert seconds >= 1.0 + costs.work / workers
    assert seconds <= 1.0 + costs.work / workers + max(tiles) + 0.002 * len(tiles)


def test_a_larger_world_costs_as_much_as_its_tiles():
    costs = Costs([1.0, 3.0], start=1.0, driver=0.1, bytes=10)
    world = schedule.larger(costs, 10000)
    assert len(world.tiles) == 10000 and set(world.tiles) == {1.0, 3.0}
    assert world.work == pytest.approx(20000.0, rel=0.05)
    assert schedule.larger(costs, 10000).tiles == world.tiles


def test_a_bake_without_costs_is_rejected(tmp_path, capsys):
    assert schedule.main([str(tmp_path / "none")]) == 2
    (tmp_path / "manifest.json").write_text(json.dumps({"format": FORMAT, "tiles": {"0,0": {"seconds": 1.0, "core_seconds": 1.2}}, "costs": None}))
    assert schedule.main([str(tmp_path)]) == 2
    assert "has no costs of tiles" in capsys.readouterr().err


def test_a_table_is_printed(tmp_path, capsys):
    manifest = {"format": FORMAT, "tiles": {f"{i},0": {"seconds": 0.4, "core_seconds": 0.5} for i in range(20)}, "costs": {"start_seconds": 2.0, "driver_seconds": 0.01, "bytes": 4000}}
    (tmp_path / "manifest.json").write_text(json.dumps(manifest))
    assert schedule.main([str(tmp_path), "--workers", "1,10", "--tiles", "1000"]) == 0
    printed = capsys.readouterr().out
    assert "1,000 tiles of 0.5 core-seconds on average" in printed
    assert "| 1 | 8 min 32 s | 1.0 | tiles | 7.81 kB |" in printed
    assert "| 10 |" in printed
