"""Tests parts of the baker separately: the areas of tiles, the messages about a scheduler, the manifest, and the
files."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import psutil
import pytest
from conftest import REPO, new_project, run
from distributed import Client, LocalCluster

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import cluster, driver, report, schedule  # noqa: E402 (only on the path above)
from baking.__main__ import main  # noqa: E402
from baking.command_line import folder_argument, place_argument  # noqa: E402
from baking.format import FORMAT, MANIFEST, VERSION, BakeError  # noqa: E402
from baking.grid import TileGrid, inside  # noqa: E402
from baking.tile_engine import ProcessorTime, Source  # noqa: E402
from baking.whole_file import whole_file, write_whole  # noqa: E402
from reading.__main__ import main as read  # noqa: E402
from reading.glb import BINARY_CHUNK, MAGIC, GlbError, read_glb  # noqa: E402


def test_each_instance_belongs_to_one_area(godot, tmp_path):
    """Checks that every position in a tile of the game is in exactly one tile of a bake, including edges and positions
    beyond them."""
    rect = [-1e5 - 17.0, 2e6, 96.5, 81.25]
    sizes = ((32.0, 32.0), (27.0, 20.0), (10.3, 0.7), (64.0, 33.3))
    cases = [json.dumps([rect, size, game_size]) for size, game_size in sizes]
    completed = godot(["--path", new_project(tmp_path), "--script", REPO / "tests/bake/dump_grid.gd", "--", *cases], timeout=60)
    described = [json.loads(line.removeprefix("grid ")) for line in completed.stdout.splitlines() if line.startswith("grid ")]
    assert len(described) == len(sizes), completed.stdout + completed.stderr
    for each in described:
        check_areas(rect, TileGrid.of(each), each["parts"], np.random.default_rng(3))


def test_a_terminal_gets_one_line_of_progress(monkeypatch, capsys):
    """Checks that a terminal gets one line that is updated, as `bake.sh` prints it, and that a file gets whole lines."""
    for terminal, ends in ((True, "\r"), (False, "2 of 2")):
        monkeypatch.setattr(sys.stdout, "isatty", lambda terminal=terminal: terminal, raising=False)
        report.Progress(2, functools.partial(print, flush=True)).end(report.Outcome({}, made=2))
        assert capsys.readouterr().out.startswith(ends)


@pytest.mark.parametrize("url", ["s4://bucket/world", "http://store.example/world", "memory://world", "s3://", "file://server/world", "gs://bucket/world"])
def test_an_unsupported_url_is_not_a_folder(url, tmp_path, monkeypatch, capsys):
    """Checks that no command creates a folder whose name begins with the scheme of a URL. Exports need a folder."""
    monkeypatch.chdir(tmp_path)
    for program, arguments in ((main, ["world.tscn", url]), (read, [url, "maps", "out"]), (read, ["bake", "maps", url]), (read, ["bake", "gltf", url])):
        with pytest.raises(SystemExit, match="2"):
            program(arguments)
        printed = capsys.readouterr().err
        if arguments[0] == "bake":
            assert f"'{url}' must be a folder on this machine or a file:///... URL" in printed
        elif url.startswith("gs"):
            assert "'gs://bucket/world' needs the Python package" in printed and "gcsfs: see tools/bake/README.md#object-stores" in printed
        else:
            assert f"'{url}' must" in printed or f"'{url}' is the memory of this process" in printed or f"'{url}' needs" in printed
    assert not list(tmp_path.iterdir())


def test_a_file_url_is_a_folder():
    assert folder_argument("file:///data/my%20world") == Path("/data/my world") == place_argument("file:///data/my%20world")
    assert folder_argument("a:b/c") == Path("a:b/c") and folder_argument("out/") == Path("out")


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


def test_processor_time_of_an_ended_engine_is_included():
    """Checks that the CPU time of an engine that has exited is not lost. Otherwise, the tile during which it exits
    would have a negative cost in the manifest."""
    busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    time_of = ProcessorTime([psutil.Process(busy.pid)])
    try:
        deadline = time.monotonic() + 30.0
        while time_of.total() < 0.1 and time.monotonic() < deadline:
            time.sleep(0.02)
    finally:
        busy.kill()
        busy.wait()
    assert time_of.total() >= 0.1


def test_a_scheduler_without_workers_is_reported(monkeypatch):
    """Checks that the bake reports once when the scheduler has no workers, and once when it has workers again."""
    counts = [2, 0, 0, 3, 3, 0]
    looked = threading.Event()

    class Scheduler:
        def nthreads(self) -> dict[str, int]:
            if not counts:
                looked.set()
                raise OSError("gone")
            return {f"worker {number}": 1 for number in range(counts.pop(0))}

    monkeypatch.setattr(cluster, "CHECK_SECONDS", 0.01)
    output: list[str] = []
    with cluster.watched(Scheduler(), "tcp://here:1", output.append):
        assert looked.wait(10.0)
    assert [each.split(":1", 1)[1][:16] for each in output] == [" has no workers:", " has workers: 3.", " has no workers:"]


class SlowTile:
    """Replaces `tile.make`. Counts the tiles that are generated concurrently."""

    lock = threading.Lock()
    now = 0
    most = 0

    @classmethod
    def make(cls, *_: object, **__: object) -> dict:
        with cls.lock:
            cls.now += 1
            cls.most = max(cls.most, cls.now)
        time.sleep(0.1)
        with cls.lock:
            cls.now -= 1
        return {"failed": "not made"}


def test_workers_that_join_later_get_tiles(monkeypatch, tmp_path):
    """Checks that a bake that began with one worker hands out more tiles once others have joined."""
    monkeypatch.setattr(driver.tile, "make", SlowTile.make)
    tiles = [(column, 0) for column in range(200)]
    outcome = report.Outcome(dict(WORLD))
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as workers, Client(workers) as client:
        threading.Timer(0.5, workers.scale, [12]).start()
        driver._make_all(
            SimpleNamespace(out=str(tmp_path)), client, 1, tiles, outcome, report.Map((0, 0, 32, 32), 1.0, []), report.Progress(len(tiles), print)
        )
    assert len(outcome.failed) == len(tiles)
    assert SlowTile.most > 7, "more than the seven tiles that a bake with one worker hands out at a time"


WORLD = {
    "scene": "res://world.tscn", "seed": 1, "rect": [0, 0, 32, 32], "grid": [0, 0, 1, 1], "tile_size": 32, "complete": False, "digest": None,
    "layers": [], "tiles": {}, "scene_digest": "", "scene_parts": {}, "world_offset": [0, 0, 0],
}  # fmt: skip


def test_a_failure_to_write_the_report_is_reported(tmp_path):
    outcome = report.Outcome(dict(WORLD))
    (tmp_path / "map.png").mkdir()
    report.write_report(tmp_path, 1, outcome, report.Map((0, 0, 32, 32), 1.0, []))
    assert str(tmp_path / "map.png") in outcome.unreported, outcome.unreported


def test_a_leftover_that_cannot_be_removed_is_reported(tmp_path):
    stuck = tmp_path / "tiles/.tile_0_0.part"
    stuck.mkdir(parents=True)
    with pytest.raises(BakeError, match="Cannot remove .*tile_0_0.part"):
        driver.bake(driver.BakeRequest(Source(("godot",), "/nowhere", "res://world.tscn"), tmp_path), print)


def test_an_unusable_manifest_is_reported(tmp_path):
    """Checks that a file that is not a manifest is replaced with a message, and that a manifest with a missing or invalid field
    is rejected."""
    request = driver.BakeRequest(Source(("godot",), "/nowhere", "res://world.tscn"), tmp_path)
    output: list[str] = []
    driver._resume(request, dict(WORLD), output.append)
    assert not output, "a new folder has no manifest"
    (tmp_path / MANIFEST).write_text("{")
    driver._resume(request, dict(WORLD), output.append)
    assert len(output) == 1 and str(tmp_path / MANIFEST) in output[0] and "replaced" in output[0], output
    (tmp_path / MANIFEST).write_text(json.dumps({**WORLD, "format": FORMAT, "version": VERSION, "rect": None}))
    with pytest.raises(BakeError, match="manifest.json: rect must be an array of 4 values, got null; restore the manifest of the bake"):
        driver._resume(request, dict(WORLD), output.append)
    (tmp_path / MANIFEST).write_text(json.dumps({"format": FORMAT, "version": VERSION, "scene": "res://world.tscn"}))
    with pytest.raises(BakeError, match="manifest.json: scene_digest is missing, but is required"):
        driver._resume(request, dict(WORLD), output.append)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--tiles", "0,0 1;2"], "'1;2' must be a pair of whole numbers I,J"),
        (["--wait", "nan"], "--wait must be between 0 and 1e+06 seconds, got nan"),
        (["--project", "/nowhere"], "--project must be a folder with a project.godot, got /nowhere"),
    ],
)
def test_a_bake_is_rejected_before_an_engine_starts(tmp_path, capsys, options, sentence):
    try:
        code = main(["res://world.tscn", str(tmp_path / "out"), *options])
    except SystemExit as ended:
        code = ended.code
    assert code == 2 and sentence in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_a_forecast_rejects_workers_that_are_not_numbers(tmp_path, capsys):
    with pytest.raises(SystemExit):
        schedule.main([str(tmp_path), "--workers", "1,many"])
    assert "--workers must be integers separated by commas, such as 1,10,100, got '1,many'" in capsys.readouterr().err


def test_a_model_without_json_is_not_binary_gltf():
    with pytest.raises(GlbError, match="JSON cannot be read"):
        read_glb(np.array([MAGIC, 2, 20, 0, BINARY_CHUNK], "<u4").tobytes())


# Runs in a separate process, with a limit on the size of files.
FULL_DISK = """
import resource, sys
from pathlib import Path
sys.path.insert(0, "tools/bake")
import numpy as np
from baking.whole_file import CannotWrite, whole_file, write_whole
from reading.__main__ import main as read  # noqa: E402
from reading.glb import Glb

def streamed(path, size):
    with whole_file(path) as file:
        for _ in range(size // 1000):
            file.write(bytes(1000))

def glb(path, size):
    model = Glb("test")
    model.add_accessor(np.zeros(size // 4, np.float32))
    model.write(path)

folder = Path(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
for write in (streamed, glb, lambda path, size: write_whole(path, bytes(size))):
    path = folder / "file"
    write(path, 4000)
    before = path.read_bytes()
    try:
        write(path, 200000)
        print("written")
    except CannotWrite as error:
        print(error)
    print(path.read_bytes() == before, [each.name for each in folder.iterdir()])
"""


def test_a_full_disk_keeps_the_old_file(tmp_path):
    """Checks that the error is a readable message, the old file is unchanged, and no other file is left, for files of the baker
    and the readers."""
    completed = run([sys.executable, "-c", FULL_DISK, tmp_path], timeout=60, cwd=REPO)
    sentence = f"Cannot write {tmp_path / 'file'}: File too large. Free space there, or choose a writable folder."
    assert completed.stdout.splitlines() == [sentence, "True ['file']"] * 3, completed.stdout + completed.stderr


def test_an_unrelated_error_during_writing_is_passed_on(tmp_path):
    """Checks that an error of other code in the block, such as reading another file, is not reported as a failure to write this
    file."""
    path = tmp_path / "file"
    write_whole(path, b"old")
    with pytest.raises(FileNotFoundError, match="missing"), whole_file(path) as file:
        file.write(b"new")
        (tmp_path / "missing").read_bytes()
    with pytest.raises(KeyboardInterrupt), whole_file(path):
        raise KeyboardInterrupt
    assert path.read_bytes() == b"old" and [each.name for each in tmp_path.iterdir()] == ["file"]
