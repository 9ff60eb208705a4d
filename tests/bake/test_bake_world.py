"""Tests bakes of a world into files. The files must contain the instances of the running game, regardless of the number of
workers and the order of tiles. A bake must survive killed workers and detect damaged or changed files."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import random
import resource
import shutil
import signal
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import psutil
import pyarrow as pa
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest
from bake.world import (
    PLACED_BY_HAND, RECT, Baked, bake, baked, begin, engines_below, ground, has_ended, is_engine_of, kill,  # noqa: F401
    processes_below, wait_for, workers_of, world,  # noqa: F401 (some are fixtures)
)  # fmt: skip
from conftest import REPO, run

sys.path.insert(0, str(REPO / "tools/bake"))
from baking.driver import world_digest  # noqa: E402
from baking.tile_engine import Rejected, Source, TileEngine  # noqa: E402 (only on the path above)


def copied(baked: Baked, to: Path) -> Baked:
    """Returns a copy of a bake, for tests that damage it."""
    shutil.copytree(baked.out, to)
    return Baked(0, "", to)


def test_manifest_describes_the_bake(baked):
    manifest = baked.manifest
    assert manifest["format"] == "thicket-bake" and manifest["version"] == 1 and manifest["complete"]
    assert manifest["scene"] == "res://world.tscn" and manifest["seed"] == 11
    assert manifest["rect"] == list(RECT) and manifest["tile_size"] == 32.0 and manifest["grid"] == [-3, -2, 5, 4]
    assert [layer["name"] for layer in manifest["layers"]] == ["Trees", "Grass"]
    trees = manifest["layers"][0]
    assert trees["radius"] == 3.0 and trees["tile_size"] == 32.0 and trees["colored"] and trees["custom_data"]
    assert [model["path"] for model in trees["models"]] == ["models/0_0.res", "res://cone.res"]
    assert (baked.out / "models/0_0.res").stat().st_size > 100
    assert len(manifest["tiles"]) == 20
    report = (baked.out / "report.md").read_text()
    assert manifest["digest"] in report and "0 Trees" in report and (baked.out / "map.png").stat().st_size > 1000
    assert manifest["digest"] in baked.output


def test_costs_include_the_engine(world, baked):
    """Checks that the cost of a tile includes the CPU time of the engine, even if a wrapper script runs the engine."""
    engine = TileEngine(Source((str(REPO / "tools/godot"),), str(world), "res://world.tscn"))
    try:
        first = engine.core_seconds()
        assert first > 0.1, "an engine loads the scene when it starts"
        with pytest.raises(Rejected, match="before describe succeeded"):
            next(engine.rows((0, 0)))
        engine.describe({"rect": "-160,-160,320,320", "tile_size": "320", "layers": "Grass"})
        assert sum(len(data) for tile in [(-1, -1), (0, -1), (-1, 0), (0, 0)] for _, data in engine.rows(tile)) > 1_000_000
        assert engine.core_seconds() > first + 0.01
    finally:
        engine.close()
    spent = sum(tile["core_seconds"] for tile in baked.manifest["tiles"].values())
    assert 0.0 < spent < os.cpu_count() * sum(tile["seconds"] for tile in baked.manifest["tiles"].values()) + 1.0
    assert baked.manifest["costs"]["start_seconds"] > 0.1


def test_files_match_the_manifest(baked):
    low_x, low_z, high_x, high_z = RECT[0], RECT[1], RECT[0] + RECT[2], RECT[1] + RECT[3]
    for name, entry in baked.manifest["tiles"].items():
        file = pq.ParquetFile(baked.out / entry["file"])
        table = file.read()
        assert entry["file"] == f"tiles/tile_{name.replace(',', '_')}.parquet"
        assert file.metadata.row_group(0).column(0).compression == "ZSTD" and table.num_rows == entry["rows"]
        assert table.schema.metadata[b"thicket.tile"] == name.encode()
        assert table.schema.metadata[b"thicket.digest"] == entry["digest"].encode()
        columns = {column: table[column].to_numpy() for column in table.schema.names}
        keys = list(zip(columns["layer"], columns["id"], strict=True))
        assert keys == sorted(keys) and len(set(keys)) == len(keys)
        assert entry["rows_of_layer"] == [int(np.sum(columns["layer"] == layer)) for layer in (0, 1)]
        assert entry["bounds"] == [*(columns[axis].min() for axis in "xyz"), *(columns[axis].max() for axis in "xyz")]
        i, j = map(int, name.split(","))
        # Trees have an offset along the normal, so they may be outside of their tile.
        slack = np.where(columns["layer"] == 0, 1.5, 1e-5)
        assert np.all(columns["x"] >= max(32 * i, low_x) - slack) and np.all(columns["x"] <= min(32 * i + 32, high_x) + slack)
        assert np.all(columns["z"] >= max(32 * j, low_z) - slack) and np.all(columns["z"] <= min(32 * j + 32, high_z) + slack)
        of_trees = columns["layer"] == 0
        for column in ("color", "variation", "wind_phase"):
            assert np.array_equal(np.asarray(table[column].is_valid()), of_trees), column
        turns = np.stack([columns[part] for part in ("qx", "qy", "qz", "qw")])
        assert np.allclose(np.sum(turns**2, axis=0), 1.0, atol=1e-6)


def test_digests_depend_only_on_the_rows(baked):
    """Checks that an independent implementation, written from the documentation, computes the same digests."""
    types = {pa.uint64(): "<u8", pa.uint16(): "<u2", pa.uint32(): "<u4", pa.float64(): "<f8", pa.float32(): "<f4"}
    lines = []
    for (i, j), entry in sorted((tuple(map(int, name.split(","))), entry) for name, entry in baked.manifest["tiles"].items()):
        table = pq.read_table(baked.out / entry["file"])
        hashing = hashlib.sha256()
        for field in table.schema:
            hashing.update(field.name.encode() + b"\0")
            column = table[field.name]
            if field.nullable:
                hashing.update(bytes(0 if value is None else 1 for value in column.to_pylist()))
            hashing.update(np.array([0 if value is None else value for value in column.to_pylist()], types[field.type]).tobytes())
        assert hashing.hexdigest() == entry["digest"]
        lines.append(f"{i},{j} {entry['digest']}\n")
    assert hashlib.sha256("".join(lines).encode()).hexdigest() == baked.manifest["digest"]


def rows_of_the_game(world: Path, file: Path) -> dict[tuple, tuple]:
    """Returns the instances of a running game, keyed by layer and ID. Each is a tuple: ID, position, rotation, scale,
    rank, the floats of color and custom data, and the model."""
    done = run([REPO / "tools/godot", "--headless", "--path", world, "--script", "game.gd", "--", file], timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    data = file.read_bytes()
    at, found = 0, {}
    while at < len(data):
        layer, _, _, size = struct.unpack_from("<4i", data, at)
        rows, floats = struct.unpack_from("<2I", data, at + 16)
        kinds = ["<u8", *["<f8"] * 3, *["<f4"] * 7, "<u4", *["<f4"] * floats, "<u2"]
        columns, begin_at = [], at + 32
        for kind in kinds:
            columns.append(np.frombuffer(data, kind, rows, begin_at).tolist())
            begin_at += rows * np.dtype(kind).itemsize
        assert begin_at == at + 16 + size
        for row in zip(*columns, strict=True):
            assert (layer, row[0]) not in found
            found[layer, row[0]] = row
        at = begin_at
    return found


def test_files_contain_the_instances_of_the_game(world, baked, tmp_path):
    """Checks that the files contain every instance of the game in the rectangle and no other, bit for bit."""
    shown = rows_of_the_game(world, tmp_path / "rows")
    made = baked.rows()
    assert sum(layer == 0 and id >> 63 for layer, id in made) == PLACED_BY_HAND
    for key, row in made.items():
        game = shown[key]
        assert (row[0], row[2], row[3:6], row[6:13], row[13]) == (game[0], game[-1], game[1:4], game[4:11], game[11]), key
        if key[0] == 0:
            color = [round(255 * min(max(part, 0.0), 1.0)) for part in game[12:16]]
            assert [row[14] >> 8 * place & 255 for place in range(4)] == color, key
            assert row[15:17] == game[16:18], key
    margin = 2.0  # Instances with an offset may be beyond the edge of the rectangle, by at most this many meters.
    missing = [
        key for key, row in shown.items()
        if key not in made and RECT[0] + margin < row[1] < RECT[0] + RECT[2] - margin and RECT[1] + margin < row[3] < RECT[1] + RECT[3] - margin
    ]  # fmt: skip
    assert not missing and len(made) > 5000
    near = [row for (layer, id), row in made.items() if layer == 0 and not id >> 63 and np.hypot(row[3], row[5]) < 20.0]
    assert not near, "the bake contains trees that the game removed"


def test_one_worker_in_a_different_order_generates_the_same_tiles(world, baked, tmp_path):
    other = bake(world, tmp_path / "out", "--workers", "1", "--shuffle", "5")
    assert other.code == 0, other.output
    assert other.manifest["digest"] == baked.manifest["digest"]
    assert {name: entry["digest"] for name, entry in other.manifest["tiles"].items()} == {
        name: entry["digest"] for name, entry in baked.manifest["tiles"].items()
    }


def test_a_tile_size_that_fits_no_layer_produces_the_same_instances(world, baked, tmp_path):
    other = bake(world, tmp_path / "out", "--tile-size", "27", "--workers", "2")
    assert other.code == 0 and "cut through tiles of the game" in other.output, other.output
    assert other.rows() == baked.rows()


def test_adjacent_bakes_form_one_world(world, baked, tmp_path):
    """Checks that bakes of adjacent parts, which meet along tile edges, have the same tiles as a bake of the whole rectangle.
    The documented code must read the parts together and compute the digest of the whole."""
    parts = []
    for name, rect in {"west": "-70,-50,70,100", "east": "0,-50,60,100"}.items():
        parts.append(bake(world, tmp_path / name, "--rect", rect, "--workers", "1"))
        assert parts[-1].code == 0, parts[-1].output
    assert [len(part.manifest["tiles"]) for part in parts] == [12, 8]
    tiles = {name: tile for part in parts for name, tile in part.manifest["tiles"].items()}
    assert {name: tile["digest"] for name, tile in tiles.items()} == {name: tile["digest"] for name, tile in baked.manifest["tiles"].items()}
    assert world_digest(tiles) == baked.manifest["digest"]
    together = ds.dataset([ds.dataset(part.out / "tiles") for part in parts])
    order = [("layer", "ascending"), ("id", "ascending")]
    assert together.to_table().sort_by(order).equals(ds.dataset(baked.out / "tiles").to_table().sort_by(order))


def test_damaged_files_are_regenerated(world, baked, tmp_path):
    """Checks that truncated, changed, swapped and missing files are generated again. Valid files must be kept, even
    though the manifest is damaged as well. Leftovers of a killed bake and tiles of another bake must be removed."""
    damaged = copied(baked, tmp_path / "out")
    names = sorted(damaged.manifest["tiles"])
    before = {name: damaged.file(name).read_bytes() for name in names}
    times = {name: damaged.file(name).stat().st_mtime_ns for name in names}
    truncated, flipped, swapped, missing, *intact = names
    damaged.file(truncated).write_bytes(before[truncated][:-100])
    changed = bytearray(before[flipped])
    changed[len(changed) // 3] ^= 1
    damaged.file(flipped).write_bytes(changed)
    shutil.copy(damaged.file(intact[0]), damaged.file(swapped))
    damaged.file(missing).unlink()
    (damaged.out / "tiles/.tile_0_0.parquet.1234.part").write_bytes(b"half")
    shutil.copy(damaged.file(intact[0]), damaged.out / "tiles/tile_9_9.parquet")
    (damaged.out / "manifest.json").write_text("{\"format\": \"thick")
    again = bake(world, damaged.out, "--workers", "1")
    assert again.code == 0 and "4 of them generated in this run" in again.output, again.output
    assert again.manifest["digest"] == baked.manifest["digest"]
    assert {name: again.file(name).read_bytes() for name in names} == before
    assert [name for name in names if again.file(name).stat().st_mtime_ns == times[name]] == intact
    assert not list(again.out.glob("**/*.part")) and len(list(again.out.glob("tiles/*.parquet"))) == len(names)


def test_a_bake_of_some_tiles_does_not_list_missing_files(world, baked, tmp_path):
    partial = copied(baked, tmp_path / "out")
    missing, requested = sorted(partial.manifest["tiles"])[:2]
    partial.file(missing).unlink()
    again = bake(world, partial.out, "--workers", "1", "--tiles", requested)
    assert again.code == 0 and "0 of them generated in this run" in again.output, again.output
    assert missing not in again.manifest["tiles"] and not again.manifest["complete"] and again.manifest["digest"] is None


def test_a_changed_scene_is_rejected(world, baked, tmp_path):
    other_world = shutil.copytree(world, tmp_path / "project", symlinks=True)
    out = copied(baked, tmp_path / "out").out
    scene = other_world / "world.tscn"
    text = scene.read_text()
    assert text.count("max_scale = 2.0") == 1
    scene.write_text(text.replace("max_scale = 2.0", "max_scale = 2.25"))
    refused = bake(other_world, out, "--workers", "1")
    assert refused.code == 2 and "has changed since this bake was started: layer 0 (Trees)." in refused.output, refused.output
    assert Baked(0, "", out).manifest["digest"] == baked.manifest["digest"], "the bake is unchanged"
    (other_world / "hills.gd").write_text((world / "hills.gd").read_text().replace("6.0 * sin", "6.5 * sin"))
    scene.write_text(text)
    refused = bake(other_world, out, "--workers", "1")
    assert refused.code == 2 and "the ground, the heights of the ground." in refused.output, refused.output
    fresh = bake(other_world, out, "--workers", "1", "--fresh")
    assert fresh.code == 0 and "20 of them generated in this run" in fresh.output, fresh.output
    assert fresh.manifest["digest"] != baked.manifest["digest"]


def test_a_second_bake_into_the_folder_is_rejected(world, baked, tmp_path):
    out = copied(baked, tmp_path / "out").out
    with (out / ".lock").open("a+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        refused = bake(world, out, "--workers", "1")
        assert refused.code == 2 and "Another bake is using" in refused.output, refused.output
    refused = bake(world, out, "--workers", "1", "--rect", "0,0,64,64")
    assert refused.code == 2 and "the rectangle is [-70.0, -50.0, 130.0, 100.0]" in refused.output, refused.output


def test_failing_tiles_are_reported_and_others_generated(world, baked, tmp_path):
    with ground(world, "bad"):
        broken = bake(world, tmp_path / "out", "--workers", "2")
    assert broken.code == 1 and "tile 1,0 failed. Tile" in broken.output and "heights" in broken.output, broken.output
    assert set(broken.manifest["tiles"]) == {name for name in baked.manifest["tiles"] if not name.startswith("1,")}
    assert not broken.manifest["complete"] and broken.manifest["digest"] is None
    assert "## Tiles that failed" in (broken.out / "report.md").read_text()
    completed = bake(world, broken.out, "--workers", "1")
    assert completed.code == 0 and "4 of them generated in this run" in completed.output, completed.output
    assert completed.manifest["digest"] == baked.manifest["digest"]


def test_a_full_disk_stops_with_an_error(world, baked, tmp_path):
    """Simulates a full disk with a limit on the size of files."""
    largest = max((baked.out / entry["file"]).stat().st_size for entry in baked.manifest["tiles"].values())

    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest - 1, largest - 1))

    stopped = bake(world, tmp_path / "out", "--workers", "1", preexec_fn=little_room)
    assert stopped.code == 1 and "Cannot write" in stopped.output and "File too large" in stopped.output, stopped.output
    assert not list(stopped.out.glob("**/*.part")) and not stopped.manifest["complete"]
    again = bake(world, stopped.out, "--workers", "1")
    assert again.code == 0 and again.manifest["digest"] == baked.manifest["digest"], again.output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--layers", "Ferns"], "no layer 'Ferns'. It has: 0 Trees, 1 Grass"),
        (["--tiles", "9,0"], "Tile 9,0 is not in the rectangle"),
        (["--node", "Nobody", "--wait", "1"], "there is no TerrainScatter3D after 1 s"),
        (["--workers", "0"], "--workers must be 1 or more, got 0"),
        (["--tile-size", "nan"], "tile_size must be between 1 and 1000000 meters, got 'nan'"),
        (["--rect", "0,0,-5,5"], "rect must be X,Z,WIDTH,DEPTH"),
        (["--rect", "1e11,0,5,5", "--tile-size", "1"], "is too far from the origin for tiles of 1"),
        (["--rect", "0,0,1e7,1e7"], "97656250000 tiles are more than the maximum of 1000000: choose larger tiles (tile size), or bake parts"),
        (["--scheduler", "tcp://127.0.0.1:1"], "No Dask scheduler answers at tcp://127.0.0.1:1"),
    ],
)
def test_invalid_requests_are_rejected_with_a_message(world, tmp_path, options, message):
    refused = bake(world, tmp_path / "out", "--workers", "1", *options)
    assert refused.code == 2 and message in refused.output and "Traceback" not in refused.output, refused.output


def survive(world: Path, out: Path, digest: str, victim: str, seconds: float | None = None) -> None:
    """Starts a bake with two workers and kills a worker, an engine or the driver, after `seconds` or in the middle of
    the bake. Checks that all processes end and that the same command then completes the bake."""
    with ground(world, "slow"):
        driver = begin(world, out, "--workers", "2")
        try:
            if seconds is None:
                wait_for(lambda: len(list(out.glob("tiles/*.parquet"))) > 3, "some tiles")
            else:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    driver.wait(seconds)
            below = processes_below(driver)
            workers = workers_of(driver)
            victims = {"driver": [driver], "worker": workers[:1], "engine": [each for worker in workers[:1] for each in engines_below(worker)]}
            assert seconds is not None or (victims[victim] and driver.poll() is None and len(list(out.glob("tiles/*.parquet"))) < 16)
            for each in victims[victim]:
                kill(each.pid)
            output = driver.communicate(timeout=360)[0]
            if victim == "driver":
                wait_for(lambda: all(has_ended(each) for each in below), "the end of all workers and engines")
            else:
                assert driver.returncode == 0, output
        finally:
            driver.kill()
    after = bake(world, out, "--workers", "2")
    assert after.code == 0 and after.manifest["digest"] == digest, after.output
    assert not list(out.glob("**/*.part"))


@pytest.mark.parametrize("victim", ["worker", "driver", "engine"])
def test_a_killed_process_costs_only_time(world, baked, tmp_path, victim):
    survive(world, tmp_path / "out", baked.manifest["digest"], victim)


def test_an_interrupt_ends_the_bake_with_a_message(world, baked, tmp_path):
    """Checks that Ctrl-C, which the driver, its workers and their engines receive, ends the bake with a message."""
    out = tmp_path / "out"
    with ground(world, "slow"):
        driver = begin(world, out, "--workers", "2")
        wait_for(lambda: len(list(out.glob("tiles/*.parquet"))) > 3, "some tiles")
        below = processes_below(driver)
        os.killpg(driver.pid, signal.SIGINT)
        output = driver.communicate(timeout=180)[0]
    assert driver.returncode == 130 and "interrupted; run the same command to continue" in output, output
    assert "Traceback" not in output, output
    wait_for(lambda: all(has_ended(each) for each in below), "the end of all workers and engines")
    known = Baked(0, "", out).manifest["tiles"]
    assert 0 < len(known) < 20 and not list(out.glob("**/*.part"))
    assert all(entry["digest"] == baked.manifest["tiles"][name]["digest"] for name, entry in known.items())


@pytest.mark.full
@pytest.mark.parametrize("number", range(20))
def test_kills_at_random_moments(world, baked, tmp_path, number):
    chance = random.Random(number)
    for victim in ("worker", "driver"):
        survive(world, tmp_path / victim, baked.manifest["digest"], victim, chance.uniform(0.2, 6.0))


def test_workers_of_an_existing_cluster(world, baked, tmp_path):
    """Checks that the bake waits for workers and sends them its modules, and that their engines end with the bake."""
    with contextlib.ExitStack() as stack:
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}

        def start(*words: str) -> None:
            process = subprocess.Popen([sys.executable, "-m", *words], env=environment, cwd=tmp_path, stderr=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.terminate)

        where = tmp_path / "scheduler.json"
        start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(where))
        wait_for(lambda: where.is_file() and where.stat().st_size > 10, "a scheduler")
        address = json.loads(where.read_text())["address"]
        driver = begin(world, tmp_path / "out", "--scheduler", address)
        stack.callback(driver.kill)
        first = driver.stdout.readline()
        assert f"The scheduler at {address} has no workers: the bake waits" in first
        start("distributed.cli.dask_worker", address, "--nworkers", "1", "--nthreads", "2", "--no-dashboard")
        output = driver.communicate(timeout=360)[0]
        assert driver.returncode == 0 and baked.manifest["digest"] in output, output
        only = bake(world, tmp_path / "estimated", "--scheduler", address, "--estimate")
        assert only.code == 0 and "20 tiles: about" in only.output, only.output
        assert not [each for each in psutil.process_iter(["name", "cmdline"]) if is_engine_of(each, world)]
