"""Tests the demo's other scenes: their content and the screenshots that they take."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import REPO, run
from helpers.engine_output import complaints
from PIL import Image
from test_demo import DEMO, TERRAIN, is_a_picture
from test_demo_terrain import load_script

ENGINE = REPO / "tests/engine"
SCENES = ["rules", "biomes", "fill", "mixed", "rows", "script_terrain", "surfaces", "gameplay"]
PASSED = re.compile(r"^thicket engine tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)


@pytest.mark.parametrize("scene", SCENES)
def test_scene_contains_only_settings(scene):
    path = DEMO / f"{scene}.tscn"
    text = path.read_text()
    assert path.stat().st_size < 100_000
    assert not re.search(r"MultiMesh|PackedByteArray|\b_surfaces|transform_array|buffer =", text)


@pytest.mark.parametrize("scene", SCENES)
def test_scene_runs_without_a_renderer(godot, imported_demo, scene):
    """Visits every stop of a scene, headless: no warnings, no leaks, and more than 5,000 instances at each."""
    completed = godot(["--verbose", "--path", imported_demo, f"res://{scene}.tscn", "--", "--screenshots"], timeout=300)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    assert "leaked" not in printed
    instances = re.findall(r"^demo: \w+: \d+ tiles, (\d+) instances", completed.stdout, re.MULTILINE)
    assert len(instances) >= 3 and min(map(int, instances)) > 5_000, completed.stdout


@pytest.mark.parametrize("scene", ["rules", "biomes", "script_terrain", "surfaces"])
def test_content_of_the_scene(godot, imported_demo, scene):
    completed = godot(["--verbose", "--path", imported_demo, "--script", ENGINE / f"test_demo_{scene}.gd"], timeout=300)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and PASSED.search(completed.stdout), printed[-4000:]
    assert "leaked" not in printed, printed[-4000:]


@pytest.mark.parametrize(("scene", "stop"), [("rules", "valley"), ("biomes", "biomes"), ("script_terrain", "island"), ("surfaces", "gorge")])
def test_screenshot_of_the_scene(godot_xvfb, imported_demo, tmp_path, scene, stop):
    arguments = ["--path", imported_demo, "--resolution", "640x360", f"res://{scene}.tscn", "--"]
    completed = godot_xvfb([*arguments, f"--screenshots={tmp_path}", f"--stops={stop}"], timeout=120)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    image = np.asarray(Image.open(tmp_path / f"{stop}.png").convert("RGB"), np.float64)
    assert image.shape == (360, 640, 3)
    assert not is_a_picture(image, least_green=0.2), is_a_picture(image, least_green=0.2)


def test_felled_trees_stay_felled(godot, imported_demo, tmp_path):
    """In the gameplay scene, one process fells a tree and saves. A second process loads the file, and the tree is missing from the
    rendered tiles, the queries and the bodies."""
    for test in ("test_felled_and_saved", "test_felled_after_a_restart"):
        script = ["--script", ENGINE / "test_demo_gameplay.gd", "--", test, f"file={tmp_path}/felled"]
        completed = godot(["--verbose", "--path", imported_demo, *script], timeout=120)
        printed = completed.stdout + completed.stderr
        assert completed.returncode == 0 and PASSED.search(completed.stdout), printed[-4000:]
        assert "leaked" not in printed, printed[-4000:]


def test_the_game_takes_screenshots(godot_xvfb, imported_demo, tmp_path):
    """Runs the gameplay scene's scripted key presses. Each step's screenshot differs from the previous one."""
    arguments = ["--path", imported_demo, "--resolution", "640x360", "res://gameplay.tscn", "--"]
    completed = godot_xvfb([*arguments, f"--screenshots={tmp_path}"], timeout=400)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    names = re.findall(r"^demo: (\w+): \d+ tiles", completed.stdout, re.MULTILINE)
    assert names == ["arrive", "look", "falling", "stump", "map", "loaded"]
    before = None
    for name in names:
        image = np.asarray(Image.open(tmp_path / f"{name}.png").convert("RGB"), np.float64)
        assert image.shape == (360, 640, 3)
        why = is_a_picture(image, least_green=0.2)
        assert name == "map" or not why, f"{name}: {why}"  # The map covers half of the landscape.
        assert before is None or np.abs(image - before).mean() > 3.0, name
        before = image


def test_an_unknown_scene_is_reported_by_name():
    completed = run(["bash", DEMO / "run.sh", "nowhere"], timeout=10)
    assert completed.returncode == 2
    assert "no scene 'nowhere'" in completed.stderr
    for scene in ["demo", *SCENES]:
        assert re.search(rf"\b{scene}\b", completed.stderr)


def test_the_valley_matches_its_script():
    """Heights may differ by one step of 2 mm, and soils by 1/255, because numpy versions round the last bit differently."""
    valley = load_script("make_valley")
    posts, soil = valley.make()
    stored = np.frombuffer((TERRAIN / "valley.r16").read_bytes(), "<u2").astype(int)
    assert np.abs(stored - np.frombuffer(posts, "<u2").astype(int)).max() <= 1
    shares = np.asarray(Image.open(TERRAIN / "valley_soil.png"), int)
    assert shares.shape == (valley.SOIL_POSTS, valley.SOIL_POSTS, 4)
    assert np.abs(shares - np.asarray(soil, int)).max() <= 1
    assert np.abs(shares.sum(axis=-1) - 255).max() <= 2
    assert np.array_equal(np.asarray(Image.open(TERRAIN / "valley_biomes.png").convert("RGB")), np.asarray(valley.biomes()))
    text = (DEMO / "biomes.tscn").read_text()
    for color in (valley.MEADOW, valley.WOOD):
        assert "color = Color({:.3g}, {:.3g}, {:.3g}, 1)".format(*(channel / 255 for channel in color)) in text


def test_the_rules_scene_and_the_valley_agree():
    valley = load_script("make_valley")
    text = (DEMO / "rules.tscn").read_text()
    assert f"post_count = Vector2i({valley.POSTS}, {valley.POSTS})" in text
    assert text.count(f"rect = Rect2({-valley.SIZE / 2:g}, {-valley.SIZE / 2:g}, {valley.SIZE:g}, {valley.SIZE:g})") == 2
    assert f"min_height = {valley.LOW}\n" in text and f"max_height = {valley.HIGH}\n" in text
    numbers = re.search(r'"points": PackedVector3Array\((.*?)\)', text).group(1).split(",")
    points = np.array(numbers, float).reshape(-1, 3, 3)[:, 2]  # Each point is stored as in, out and position.
    assert np.array_equal(points[:, [0, 2]], np.array(valley.PATH, float))
    heights = valley.heights(points[:, 0], points[:, 2])
    assert np.abs(points[:, 1] - heights).max() < 0.01, "the path must be on the ground"
