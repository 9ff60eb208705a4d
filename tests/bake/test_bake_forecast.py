"""Tests the estimate that a bake prints before it starts. Large bakes must need a confirmation, small bakes must not."""

from __future__ import annotations

import io
import random
import re
import sys
from pathlib import Path

import pytest
from bake.world import Baked, bake, baked, command, world  # noqa: F401 (some are fixtures)
from conftest import REPO

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import forecast  # noqa: E402 (only on the path above)
from baking.__main__ import main  # noqa: E402
from baking.forecast import Estimate, Sample, from_samples, tiles_to_sample  # noqa: E402


def test_sizes_are_extrapolated_by_area():
    """Checks that tiles at the edge of the rectangle, which are smaller, do not distort the estimate, and that the time is
    divided among workers."""
    samples = [Sample(area, round(5 * area), round(200 * area), area / 1000) for area in (1000.0, 250.0, 1000.0, 500.0)]
    found = from_samples(samples, 4000, 4000 * 700.0, 2.0, 1e12, workers=4, cores=4)
    assert (found.rows, found.bytes, found.error) == (5 * 4000 * 700.0, 200 * 4000 * 700.0, pytest.approx(0.0, abs=1e-9))
    assert found.seconds == pytest.approx(2.0 + 4000 * (0.6875 + forecast.DRIVER_SECONDS) / 4, rel=0.05)
    assert found.free == 1e12 and "4,000 tiles: about 14 M instances, 560 MB, 1" in str(found) and "1e" not in str(found)


def test_the_stated_range_contains_the_true_size():
    """Checks the range for worlds with forests and bare land: it must contain the true size in most cases."""
    chance = random.Random(2)
    hits = 0
    for _ in range(200):
        world = [Sample(1.0, 0, round(chance.choice((100, 5000)) * chance.uniform(0.5, 1.5)), 1.0) for _ in range(1000)]
        found = from_samples(chance.sample(world, 24), 1000, 1000.0, 1.0, 1e12, 1, None)
        hits += abs(sum(tile.bytes for tile in world) - found.bytes) <= found.error * found.bytes
    assert hits >= 180
    assert from_samples(world, 1000, 1000.0, 1.0, 1e12, 1, None).error == 0.0, "all tiles were sampled"
    assert from_samples([Sample(1.0, 0, 0, 1.0)] * 3, 1000, 1000.0, 1.0, 1e12, 1, None).bytes == 0.0


def test_samples_come_from_the_entire_world():
    tiles = [(i, j) for j in range(70) for i in range(96)]
    found = tiles_to_sample(tiles)
    assert len(set(found)) == forecast.MOST_SAMPLES and found == tiles_to_sample(tiles)
    assert {tiles.index(at) * forecast.MOST_SAMPLES // len(tiles) for at in found} == set(range(forecast.MOST_SAMPLES))
    assert tiles_to_sample(tiles[:1]) == tiles[:1] and len(set(tiles_to_sample(tiles[:2]))) == 2


@pytest.mark.parametrize(
    ("size", "seconds", "free", "concern"),
    [
        (9.9e9, 3000.0, 1e12, ""),
        (9.9e9, None, 1e12, ""),
        (2e10, 100.0, 1e12, "it is larger than 10 GB"),
        (1e9, 4000.0, 1e12, "it takes longer than 1 h 0 min"),
        (1e9, 10.0, 1.05e9, "it may not fit into the 1.05 GB of free space"),
    ],
)
def test_only_large_long_and_too_large_bakes_need_a_confirmation(size, seconds, free, concern):
    assert Estimate(100, 5, 1e6, size, 0.0, seconds, free).concern == concern


def test_a_large_bake_needs_yes(world, tmp_path):
    """Checks that a bake of a huge rectangle without a terminal exits before it writes anything, and prints what to do."""
    refused = bake(world, tmp_path / "out", "--workers", "2", "--rect", "-200000,-200000,400000,400000", "--tile-size", "1000000", stdin=-3)
    assert refused.code == 2 and re.search(r"4 tiles: at most \S+ G instances, \S+ TB \(from the density of the layers\)", refused.output), refused.output
    assert "Add --yes to start it anyway, or choose fewer --layers or a smaller --rect." in refused.output, refused.output
    assert [path.name for path in refused.out.iterdir()] == [".lock"]


def test_a_small_bake_is_not_sampled(baked):
    assert "estimate" not in baked.output


def test_an_estimate_alone_writes_nothing(world, baked, tmp_path):
    """Checks that --estimate works for small bakes, and that tiles that exist are not included."""
    only = bake(world, tmp_path / "out", "--workers", "1", "--estimate")
    assert only.code == 0 and "20 tiles: about" in only.output and "estimated from 2 of them" in only.output, only.output
    assert [path.name for path in only.out.iterdir()] == [".lock"]
    sizes = [path.stat().st_size for path in baked.out.glob("tiles/*.parquet")]
    everything = Estimate(20, 20, 0.0, float(sum(sizes)), 0.0, None, 0.0)
    assert everything.concern and forecast.missing_tiles(baked.out, [(-3, -2), (99, 0)], fresh=False) == [(99, 0)]
    assert forecast.missing_tiles(baked.out, [(-3, -2), (99, 0)], fresh=True) == [(-3, -2), (99, 0)]
    assert forecast.free_space(baked.out, fresh=True) >= forecast.free_space(baked.out, fresh=False) + sum(sizes) // 2


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_terminal_is_asked(world, baked, tmp_path, monkeypatch, capsys):
    """Checks that "no" and an empty answer prevent the bake and keep an existing one, even with --fresh, and that the
    estimate does not change the digest of the bake that "yes" starts."""
    for name in ("SMALL_BYTES", "LARGE_BYTES"):
        monkeypatch.setattr(forecast, name, 0.0)
    out = tmp_path / "out"
    arguments = [*command(world, out)[3:], "--workers", "1"]
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    for answer, code, options in (("n\n", 2, []), ("yes\n", 0, []), ("", 2, ["--fresh"])):
        monkeypatch.setattr(sys, "stdin", Terminal(answer))
        assert main([*arguments, *options]) == code
        printed = capsys.readouterr()
        assert "estimated from 2 of them" in printed.out and "This bake is large: it is larger than 0B. Start it? [y/N]" in printed.out
        assert ("was not started" in printed.err) == (code == 2)
        assert (out / "manifest.json").is_file() == (answer != "n\n")
    assert Baked(0, "", out).manifest["digest"] == baked.manifest["digest"]
    before = (out / "manifest.json").stat().st_mtime_ns
    assert main([*arguments, "--estimate"]) == 0 and "no tiles are missing" in capsys.readouterr().out
    assert (out / "manifest.json").stat().st_mtime_ns == before, "an estimate does not start a bake"


@pytest.mark.full
def test_yes_starts_a_large_bake_without_asking(world, baked, tmp_path, monkeypatch, capsys):
    for name in ("SMALL_BYTES", "LARGE_BYTES"):
        monkeypatch.setattr(forecast, name, 0.0)
    assert main([*command(world, tmp_path / "out")[3:], "--workers", "2", "--yes"]) == 0
    assert "Start it?" not in capsys.readouterr().out
    assert Baked(0, "", Path(tmp_path / "out")).manifest["digest"] == baked.manifest["digest"]
