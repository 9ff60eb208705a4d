"""Tests bakes from a folder into which an engine has written tiles without a driver. Such a bake must be bit-identical
to a bake by the driver, even if an engine was killed or files were damaged before the bake."""

from __future__ import annotations

import re
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from bake.world import RECT, USUAL, Baked, bake, baked, environment, ground, has_ended, kill, processes_below, wait_for, world  # noqa: F401 (some are fixtures)
from conftest import REPO, run

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import tile_folder  # noqa: E402 (only on the path above)

ASKED = [f"rect={','.join(map(str, RECT))}", "tile_size=32"]
TILES = 20


@pytest.fixture(scope="module")
def made(world, tmp_path_factory) -> Path:
    """Returns a folder with the tiles of the world, written by one engine."""
    folder = tmp_path_factory.mktemp("made")
    done = make(world, folder)
    assert done.returncode == 0 and f"{TILES} tiles generated, 0 already present" in done.stdout, done.stdout + done.stderr
    return folder


def command(project: Path, *arguments: str | Path) -> list[str]:
    script = ["--script", "res://addons/thicket/bake_world.gd", "--", *map(str, arguments)]
    return [str(REPO / "tools/godot"), "--headless", "--path", str(project), *script]


def make(project: Path, folder: Path, *further: str, **options) -> subprocess.CompletedProcess[str]:
    asked = [] if any(word.startswith("rect=") for word in further) else ASKED
    return run(command(project, "scene=res://world.tscn", f"out={folder}", *asked, *further), 120, **options)


def bake_of(folder: Path, out: Path, *options: str) -> Baked:
    """Bakes the tiles of a folder, which needs neither the project nor an engine."""
    words = [sys.executable, "-m", "baking", str(folder), str(out), "--workers", "2", *options]
    done = run(words, 120, env={**environment(), "GODOT": "/nowhere"}, cwd=folder)
    return Baked(done.returncode, done.stdout + done.stderr, out)


def without_costs(manifest: dict) -> dict:
    tiles = {name: {key: value for key, value in tile.items() if "seconds" not in key} for name, tile in manifest["tiles"].items()}
    return {**manifest, "costs": None, "tiles": tiles}


def same(one: Baked, other: Baked) -> bool:
    names = sorted(other.manifest["tiles"])
    return without_costs(one.manifest) == without_costs(other.manifest) and all(
        one.file(name).read_bytes() == other.file(name).read_bytes() for name in names
    )


def test_a_bake_from_a_folder_equals_that_of_the_driver(baked, made, tmp_path):
    """Checks that all files are equal, including the models. The manifests must also be equal, except for the costs."""
    moved = shutil.copytree(made, tmp_path / "elsewhere")
    other = bake_of(moved, tmp_path / "out")
    assert other.code == 0 and baked.manifest["digest"] in other.output, other.output
    assert other.manifest["complete"] and len(other.manifest["tiles"]) == TILES and same(other, baked)
    assert [path.name for path in other.out.glob("models/*")] == [path.name for path in baked.out.glob("models/*")]


def test_parts_add_up_to_the_whole(world, baked, tmp_path):
    """Checks that two engines can generate their parts independently, in two folders that are then merged."""
    engines = [
        subprocess.Popen(command(world, "scene=res://world.tscn", f"out={tmp_path / str(share)}", *ASKED, f"share={share}/2"), stdout=subprocess.DEVNULL)
        for share in (1, 2)
    ]
    assert [engine.wait(120) for engine in engines] == [0, 0]
    counts = [len(list((tmp_path / str(share)).glob("tiles/*.rows"))) for share in (1, 2)]
    assert counts == [TILES // 2, TILES // 2]
    shutil.copytree(tmp_path / "1", tmp_path / "2", dirs_exist_ok=True)
    whole = bake_of(tmp_path / "2", tmp_path / "out")
    assert whole.code == 0 and same(whole, baked), whole.output


def test_chosen_tiles_and_layers_with_the_default_tile_size(world, tmp_path):
    """Checks that the result equals the driver's bake with the same arguments."""
    rect = f"{-RECT[2]},{-RECT[3]},900,700.5"
    done = make(world, tmp_path / "made", f"rect={rect}", "layers=Trees", "tiles=-1,0 0,0")
    assert done.returncode == 0 and "2 tiles generated, 0 already present" in done.stdout, done.stdout + done.stderr
    theirs = bake_of(tmp_path / "made", tmp_path / "theirs", "--tiles", "-1,0 0,0")
    ours = bake(world, tmp_path / "ours", "--workers", "1", "--layers", "0", "--tiles", "-1,0 0,0", "--rect", rect, "--tile-size", "256")
    assert theirs.code == 0 and ours.code == 0, theirs.output + ours.output
    assert theirs.manifest["tile_size"] == 256.0 and same(theirs, ours) and not theirs.manifest["complete"]


def test_a_killed_engine_only_costs_time(world, baked, tmp_path):
    """Checks that complete tiles are kept, that missing, truncated and damaged tiles are generated again, and that no
    partial file is left."""
    folder = tmp_path / "made"
    with ground(world, "slow"):
        engine = subprocess.Popen(command(world, "scene=res://world.tscn", f"out={folder}", *ASKED), stdout=subprocess.DEVNULL)
        wait_for(lambda: len(list(folder.glob("tiles/*.rows"))) > 4, "some tiles")
        # The engine may be a child process of a launcher. If only the launcher were killed, the engine would continue
        # and finish the tiles.
        processes = [*processes_below(engine), psutil.Process(engine.pid)]
        for process in processes:
            kill(process.pid)
        engine.wait(10)
        wait_for(lambda: all(map(has_ended, processes)), "the end of the engine")
    finished = sorted(folder.glob("tiles/*.rows"))
    assert 4 < len(finished) < TILES
    truncated, flipped, emptied, swapped, *intact = finished
    truncated.write_bytes(truncated.read_bytes()[:-100])
    changed = bytearray(flipped.read_bytes())
    changed[len(changed) // 2] ^= 1
    flipped.write_bytes(changed)
    emptied.write_bytes(b"")
    shutil.copy(intact[0], swapped)
    times = {path: path.stat().st_mtime_ns for path in intact}
    again = make(world, folder)
    assert again.returncode == 0, again.stdout + again.stderr
    assert f"{TILES - len(intact)} tiles generated, {len(intact)} already present, 0 failed" in again.stdout
    assert {path: path.stat().st_mtime_ns for path in intact} == times and not list(folder.glob("**/.*.part"))
    whole = bake_of(folder, tmp_path / "out")
    assert whole.code == 0 and same(whole, baked), whole.output


def test_the_bake_reports_missing_and_damaged_tiles(world, baked, made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "made")
    (folder / "tiles/tile_0_0.rows").unlink()
    damaged = folder / "tiles/tile_1_0.rows"
    damaged.write_bytes(damaged.read_bytes()[:-1])
    shutil.copy(folder / "tiles/tile_-1_0.rows", folder / "tiles/tile_-2_0.rows")
    some = bake_of(folder, tmp_path / "out")
    assert some.code == 1 and "tile_0_0.rows is missing" in some.output, some.output
    assert "tile_1_0.rows is damaged" in some.output and "tile_-2_0.rows is damaged" in some.output, some.output
    assert len(some.manifest["tiles"]) == TILES - 3 and not some.manifest["complete"]
    assert make(world, folder).returncode == 0
    whole = bake_of(folder, tmp_path / "out")
    assert whole.code == 0 and "3 of them generated in this run" in whole.output and same(whole, baked), whole.output


def test_failing_tiles_are_reported_and_others_generated(world, tmp_path):
    with ground(world, "bad"):
        broken = make(world, tmp_path / "made")
    assert broken.returncode == 1 and "tile 1,0 failed. Tile" in broken.stderr and "16 tiles generated, 0 already present, 4 failed" in broken.stdout, broken.stderr
    completed = make(world, tmp_path / "made")
    assert completed.returncode == 0 and "4 tiles generated, 16 already present" in completed.stdout, completed.stdout + completed.stderr


def test_a_changed_scene_is_detected(world, made, tmp_path):
    """Checks that a folder is rejected if the scene has changed, and that a bake rejects a tile that was copied from another
    scene."""
    other_world = shutil.copytree(world, tmp_path / "project", symlinks=True)
    scene = other_world / "world.tscn"
    scene.write_text(scene.read_text().replace("max_scale = 2.0", "max_scale = 2.25"))
    folder = shutil.copytree(made, tmp_path / "made")
    refused = make(other_world, folder)
    assert refused.returncode == 2 and "these parts of the scene differ: layer 0 (Trees)." in refused.stderr, refused.stderr
    scene.write_text((world / "world.tscn").read_text().replace("view_distance = ", "view_distance = 1"))
    assert scene.read_text() != (world / "world.tscn").read_text() and make(other_world, folder).returncode == 0, "drawing settings have no effect"
    scene.write_text((world / "world.tscn").read_text().replace("max_scale = 2.0", "max_scale = 2.25"))
    refused = make(world, folder, "rect=0,0,64,64", "tile_size=32")
    assert refused.returncode == 2 and "contains tiles of another bake: the rectangle is different" in refused.stderr, refused.stderr
    assert make(other_world, tmp_path / "other").returncode == 0
    shutil.copy(tmp_path / "other/tiles/tile_0_0.rows", folder / "tiles/tile_0_0.rows")
    mixed = bake_of(folder, tmp_path / "out")
    assert mixed.code == 1 and "tile_0_0.rows is damaged or belongs to another bake" in mixed.output, mixed.output


def test_a_full_disk_stops_with_an_error(world, made, tmp_path):
    """Simulates a full disk with a limit on the size of files."""
    largest = max(path.stat().st_size for path in made.glob("tiles/*.rows"))

    def little_room():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest - 1, largest - 1))

    stopped = make(world, tmp_path / "made", preexec_fn=little_room)
    assert stopped.returncode == 1 and "Cannot write" in stopped.stderr and "Run the same command again" in stopped.stderr, stopped.stderr
    assert not list(tmp_path.glob("made/**/.*.part"))
    assert all(path.stat().st_size < largest for path in tmp_path.glob("made/tiles/*.rows"))
    again = make(world, tmp_path / "made")
    assert again.returncode == 0, again.stdout + again.stderr


REFUSED_RECT = "rect must be X,Z,WIDTH,DEPTH in meters, with a width and a depth above 0 and all below 1e12"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "out is missing"),
        (["out=made"], "out must be the absolute path of a folder"),
        (["out=s3://bucket/made"], "out must be the absolute path of a folder"),
        (["out=/dev/null/made", *ASKED], "Cannot write /dev/null/made"),
        (["out=/tmp/made", "rect=1,2,3"], "rect must be X,Z,WIDTH,DEPTH"),
        (["out=/tmp/made", "rect=0,0,-5,5"], f"{REFUSED_RECT}, got '0,0,-5,5'"),
        (["out=/tmp/made", "rect=0,0,nan,5"], f"{REFUSED_RECT}, got '0,0,nan,5'"),
        (["out=/tmp/made", "tile_size=0.5"], "tile_size must be between 1 and 1000000 meters, got '0.5'"),
        (["out=/tmp/made", *ASKED, "layers=Ferns"], "The scene has no layer 'Ferns'. It has: 0 Trees, 1 Grass"),
        (["out=/tmp/made", *ASKED, "tiles=0,0 9,0"], "tiles must be from -3,-2 to 1,1, got '9,0'"),
        (["out=/tmp/made", *ASKED, "tiles=0,0 here"], "tiles must be pairs of integers I,J separated by spaces, got 'here'"),
        (["out=/tmp/made", *ASKED, "share=3/2"], "share must be K/N"),
        (["out=/tmp/made", "rect=0,0,1e7,1e7", "tile_size=32"], "97656250000 tiles are more than the maximum of 1000000"),
        (["out=/tmp/made"], "The ground does not report its extent: set rect to"),
        (["out=/tmp/made", *ASKED, "node=Nobody", "wait=1"], "In the scene res://world.tscn there is no TerrainScatter3D after 1 s"),
        (["out=/tmp/made", *ASKED, "wait=-1"], "wait must be at least 0 seconds, got '-1'"),
        (["out=/tmp/made", *ASKED, "wait=long"], "wait must be at least 0 seconds, got 'long'"),
        (["out=/tmp/made", "rekt=0,0,5,5"], "rekt is '0,0,5,5', which is not an argument"),
        (["out=/tmp/made", "scene=res://none.tscn"], "There is no scene 'res://none.tscn'."),
        (["connect=1", "token=x"], "connect is '1', but no driver listens"),
    ],
)
def test_invalid_arguments_are_rejected_with_a_message(world, arguments, sentence):
    done = run(command(world, "scene=res://world.tscn", *arguments), 60)
    assert done.returncode == 2 and f"bake_world: {sentence}" in done.stderr, done.stderr
    assert "SCRIPT ERROR" not in done.stderr and not Path("/tmp/made").exists(), done.stderr


def test_options_that_the_folder_determines_are_rejected(made, tmp_path):
    for options, sentence in ((USUAL[:2], "--rect is -70"), (["--layers", "Trees"], "--layers is Trees, but the tiles in")):
        refused = bake_of(made, tmp_path / "out", *options)
        assert refused.code == 2 and sentence in refused.output and "already have a fixed value" in refused.output, refused.output
    spoiled = shutil.copytree(made, tmp_path / "made")
    (spoiled / tile_folder.WORLD).write_text("{")
    refused = bake_of(spoiled, tmp_path / "out")
    assert refused.code == 2 and "world.json cannot be read" in refused.output and "Traceback" not in refused.output, refused.output


def test_a_missing_library_is_reported(godot, tmp_path):
    """Checks that, without a library for the processor, the bake prints one error with a fix and no script
    error."""
    addon = tmp_path / "addons/thicket"
    shutil.copytree(REPO / "demo_project/addons/thicket", addon, ignore=shutil.ignore_patterns("bin", "*.gdextension*"))
    (tmp_path / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Plain"\n')
    done = godot(["--path", tmp_path, "--script", "res://addons/thicket/bake_world.gd", "--", "scene=res://world.tscn", "out=/nowhere"])
    assert done.returncode == 2 and "ERROR" not in done.stderr, done.stderr
    assert re.search(r"^bake_world: .*no native library .*addons/thicket/bin", done.stderr, re.MULTILINE), done.stderr
