"""The demo's other scenes: what each of them promises to show, asked of what stands in it."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import REPO, run
from PIL import Image
from test_demo import DEMO, complaints, is_a_picture

ENGINE = REPO / "tests/engine"
SCENES = ["script_terrain"]
PASSED = re.compile(r"^thicket engine tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)


@pytest.mark.parametrize("scene", SCENES)
def test_scene_holds_settings_only(scene):
    path = DEMO / f"{scene}.tscn"
    text = path.read_text()
    assert path.stat().st_size < 100_000
    assert not re.search(r"MultiMesh|PackedByteArray|_surfaces|transform_array|buffer =", text)
    steps = int(re.search(r"load_steps=(\d+)", text).group(1))
    assert steps == 1 + len(re.findall(r"^\[(?:ext|sub)_resource ", text, re.MULTILINE))


@pytest.mark.parametrize("scene", SCENES)
def test_scene_runs_without_a_renderer(godot, imported_demo, scene):
    """Every stop, headless: no warning, nothing leaked, something to see at each."""
    done = godot(["--verbose", "--path", imported_demo, f"res://{scene}.tscn", "--", "--screenshots"], timeout=60)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and "demo: done" in done.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    assert "leaked" not in printed
    instances = re.findall(r"^demo: \w+: \d+ tiles, (\d+) instances", done.stdout, re.MULTILINE)
    assert len(instances) >= 3 and min(map(int, instances)) > 5_000, done.stdout


@pytest.mark.parametrize("scene", SCENES)
def test_what_stands_in_the_scene(godot, imported_demo, scene):
    done = godot(["--verbose", "--path", imported_demo, "--script", ENGINE / f"test_demo_{scene}.gd"], timeout=60)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and PASSED.search(done.stdout), printed[-4000:]
    assert "leaked" not in printed, printed[-4000:]


@pytest.mark.parametrize(("scene", "stop"), [("script_terrain", "island")])
def test_scene_is_a_picture(godot_xvfb, imported_demo, tmp_path, scene, stop):
    arguments = ["--path", imported_demo, "--resolution", "640x360", f"res://{scene}.tscn", "--"]
    done = godot_xvfb([*arguments, f"--screenshots={tmp_path}", f"--stops={stop}"], timeout=120)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and "demo: done" in done.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    image = np.asarray(Image.open(tmp_path / f"{stop}.png").convert("RGB"), np.float64)
    assert image.shape == (360, 640, 3)
    assert not is_a_picture(image, least_green=0.2), is_a_picture(image, least_green=0.2)


def test_the_script_terrain_is_short():
    """What people copy: about 30 lines that are neither empty nor a comment."""
    lines = [line.strip() for line in (DEMO / "terrain/island.gd").read_text().splitlines()]
    assert len([line for line in lines if line and not line.startswith("#")]) <= 30


def test_an_unknown_scene_is_named():
    done = run(["bash", DEMO / "run.sh", "nowhere"], timeout=10)
    assert done.returncode == 2
    assert "no scene 'nowhere'" in done.stderr
    for scene in ["demo", *SCENES]:
        assert re.search(rf"\b{scene}\b", done.stderr)
