"""Tests the editor's tools with a designer's steps in the real editor, with software rendering and screenshots in
build/editor."""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import REPO
from helpers.editor_project import DEMO, PASSED, PICTURES, add_steps, check_passed, link_library, new_plain_project
from helpers.engine_output import complaints
from PIL import Image

# The editor's camera when the demo scene is opened for the first time: 45 m from the ground at the position LOOKED_AT
# of demo_scene.gd.
VIEW = """[editor_states]

3D={
"viewport_mode": 1,
"viewports": [{
"distance": 45.0,
"position": Vector3(40, %s, -30),
"x_rotation": 0.6,
"y_rotation": 0.4
}]
}
"""
GROUND = 564.0


def new_demo_project(folder: Path) -> Path:
    """Copies the demo project and adds the plugin that works as a designer would. All files are saved in the copy."""
    skipped = shutil.ignore_patterns(".godot", "bin", "pictures", "project.godot")
    shutil.copytree(DEMO, folder, dirs_exist_ok=True, ignore=skipped)
    (folder / "addons/thicket/bin").symlink_to(DEMO / "addons/thicket/bin")
    settings, count = re.subn("msaa_3d=2", "msaa_3d=0", (DEMO / "project.godot").read_text())
    assert count == 1
    (folder / "project.godot").write_text(settings)
    add_steps(folder)
    states = folder / ".godot/editor"
    states.mkdir(parents=True)
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    name = hashlib.md5(b"res://demo.tscn").hexdigest()
    (states / f"demo.tscn-editstate-{name}.cfg").write_text(VIEW % GROUND)
    return folder


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    return new_demo_project(tmp_path_factory.mktemp("editor"))


@pytest.fixture(scope="module")
def imported(godot, project) -> Path:
    """Returns the project after the editor has imported its files. Deletes screenshots of earlier runs."""
    completed = godot(["--path", project, "--import"], timeout=120)
    assert not complaints(completed.stdout + completed.stderr)
    for old in PICTURES.glob("*.png"):
        old.unlink()
    return project


@pytest.fixture(scope="module")
def designer(godot_xvfb, imported, project) -> str:
    """Returns the editor's output from a designer's work on the demo scene."""
    completed = godot_xvfb(["--editor", "--path", project, "--", "demo_scene"], timeout=900)
    return completed.stdout + completed.stderr


def test_a_designers_first_hour(designer):
    """Checks a designer's first hour: creates a node and a layer, paints, undoes, redoes, saves, reopens, uses presets
    and shapes, and bakes. The checks are in demo_scene.gd."""
    check_passed(designer)


@pytest.fixture
def plain_project(tmp_path) -> Path:
    return new_plain_project(tmp_path)


@pytest.mark.parametrize("script", ["test_bake", "test_scene_files"])
def test_scripts_of_the_editor(godot, plain_project, script):
    """Runs checks of bakes, of canceled and rejected bakes, of the brush's ray on the ground, and of unwritable files."""
    link_library(plain_project)
    completed = godot(["--verbose", "--path", plain_project, "--script", REPO / f"tests/engine/{script}.gd"], timeout=120)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and re.search(r"^thicket engine tests: \d+ checks, 0 failed$", printed, re.M), printed
    assert "leaked" not in printed, printed


@pytest.fixture
def editor_project(plain_project) -> Path:
    """Returns a plain project with the library and the scripts of the editor tests, without expensive scenes."""
    link_library(plain_project)
    add_steps(plain_project)
    return plain_project


@pytest.mark.parametrize("script", ["impostors", "imports", "whole_files", "heightmap_summary"])
def test_small_scenes(godot, godot_xvfb, editor_project, script):
    """Covers baking impostors with one click, importing instances, replacing files, and the inspector of heightmaps. The checks are in these scripts."""
    run = godot_xvfb if script in ("imports", "heightmap_summary") else godot  # Without a renderer, saving a scene prints errors.
    completed = run(["--editor", "--path", editor_project, "--", script], timeout=300)
    check_passed(completed.stdout + completed.stderr)


def test_hand_placed_instances(godot, godot_xvfb, editor_project):
    """Places instances with mouse and keys. The checks are in hand.gd. Then checks that a game finds bit-identical
    hand-placed instances."""
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", "hand"], timeout=600)
    check_passed(completed.stdout + completed.stderr)
    played = godot(["--path", editor_project, "--script", "res://tests/hand_in_game.gd"], timeout=120)
    printed = played.stdout + played.stderr
    assert "hand in game: 0 failed" in printed and not complaints(printed), printed


def test_hand_placed_instances_on_a_planet(godot_xvfb, editor_project):
    """Places instances on the side of a planet with mouse and keys. The checks are in hand_planet.gd."""
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", "hand_planet"], timeout=300)
    check_passed(completed.stdout + completed.stderr)


@pytest.mark.parametrize("script", ["planet_tools", "level_tools"])
def test_tools_on_all_sides_of_the_ground(godot_xvfb, editor_project, script):
    """Uses the tools on the top, the side and the underside of a planet, and on, below and beside a bridge. The checks are in these scripts."""
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", script], timeout=300)
    check_passed(completed.stdout + completed.stderr)


def test_shapes(godot_xvfb, editor_project):
    """Runs the checks of regions and their handles in shapes.gd."""
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", "shapes"], timeout=600)
    check_passed(completed.stdout + completed.stderr)


@pytest.fixture(scope="module")
def ground_follows(godot_xvfb, tmp_path_factory) -> str:
    """Returns the editor's output while a designer chooses a ground and moves it."""
    folder = new_plain_project(tmp_path_factory.mktemp("ground"))
    link_library(folder)
    add_steps(folder)
    completed = godot_xvfb(["--editor", "--path", folder, "--", "ground_follows"], timeout=300)
    return completed.stdout + completed.stderr


def test_a_ground_can_be_chosen_and_moved(ground_follows):
    """Checks that the selection becomes the ground, that undo restores every byte, and that the scatter is updated when the
    ground moves. The checks are in ground_follows.gd."""
    check_passed(ground_follows)


def test_terrain_plugins_as_ground(godot_xvfb, editor_project):
    """Checks water, and ground from the stand-ins for terrain plugins that tests/engine provides, in the editor. The checks
    are in plugin_ground.gd."""
    (editor_project / "doubles").mkdir()
    for name in ("harness", "terrain_harness", "terrain3d_harness", "hterrain_harness", "plugins_harness"):
        text = (REPO / f"tests/engine/{name}.gd").read_text(encoding="utf-8")
        (editor_project / f"doubles/{name}.gd").write_text(f"@tool\n{text}", encoding="utf-8")
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", "plugin_ground"], timeout=600)
    check_passed(completed.stdout + completed.stderr)


def test_workarounds_for_the_crash_of_a_first_import(godot, plain_project):
    """Checks the two workarounds in docs/troubleshooting.md for engines up to 4.7, which may crash when they quit after a first
    import with any extension (godot issue 111048). Everything is imported before the crash, so a second import
    succeeds. A first import succeeds if extension_list.cfg already lists the extension."""
    link_library(plain_project)
    project = plain_project / "project.godot"
    project.write_text(project.read_text().split("[editor_plugins]")[0])  # The plugin's scripts would delay quitting and so avoid the crash.
    listed = (plain_project / ".godot/extension_list.cfg").read_text()
    for first in (False, True):
        shutil.rmtree(plain_project / ".godot")
        if first:
            (plain_project / ".godot").mkdir()
            (plain_project / ".godot/extension_list.cfg").write_text(listed)
        else:
            godot(["--path", plain_project, "--import"], timeout=120)
            imported = {path.name.split("-")[0] for path in (plain_project / ".godot/imported").glob("*.ctex")}
            assert imported == {path.name for path in (plain_project / "addons/thicket/icons").glob("*.svg")}
        completed = godot(["--path", plain_project, "--import"], timeout=120)
        assert completed.returncode == 0 and not complaints(completed.stdout + completed.stderr), completed.stdout + completed.stderr


@pytest.fixture(scope="module")
def why(godot, godot_xvfb, tmp_path_factory) -> str:
    """Returns the editor's output while a designer finds out why a position is empty. The camera is at its initial position."""
    project = new_demo_project(tmp_path_factory.mktemp("why"))
    godot(["--path", project, "--import"], timeout=120)
    completed = godot_xvfb(["--editor", "--path", project, "--", "why"], timeout=600)
    return completed.stdout + completed.stderr


def test_why_a_position_is_empty(why):
    """Runs the checks of hovering, pinning and colors in why.gd."""
    check_passed(why)


def test_screenshots_of_the_ground_colors(why):
    """Checks the colors in the screenshots: much of the ground is red where nothing is permitted, green where the slope is
    gentle, and blue where instances have the lowest ranks."""
    shares = {}
    for name in ("why", "why_density", "why_slope", "why_rank"):
        image = np.asarray(Image.open(PICTURES / f"{name}.png").convert("RGB"), np.int16)[150:850, 290:1150]
        red, green, blue = image[..., 0], image[..., 1], image[..., 2]
        shares[name] = [(red > green + 40).mean(), (green > red + 40).mean(), (blue > red + 40).mean()]
    assert shares["why_density"][0] > shares["why"][0] + 0.02, shares
    assert shares["why_slope"][1] > shares["why"][1] + 0.1, shares
    assert shares["why_rank"][2] > shares["why"][2] + 0.02, shares


@pytest.mark.parametrize(
    "script",
    ["layers_panel", "shared_layers", "biome_layers", "undo_steps", "toolbar_room", "pasted", "first_minute"]
    + ["loose_states", "clicks", "navigation", "viewports"],
)
def test_layers_panel(godot, godot_xvfb, editor_project, script):
    """Runs scripts with the checks of the layers panel: mouse and keys, resources that duplicated and pasted nodes share, and
    confirmations before many more instances are shown. They also undo every step, byte for byte, and check the toolbar in a
    narrow window and instances that scripts have placed. Other scripts use the brush, regions and a radius with clicks only,
    bake a navigation mesh, and check the instances in each viewport."""
    godot(["--path", editor_project, "--import"], timeout=120)
    completed = godot_xvfb(["--editor", "--path", editor_project, "--", script], timeout=300)
    check_passed(completed.stdout + completed.stderr)


@pytest.fixture
def libraryless_project(plain_project) -> Path:
    """Returns a plain project without the library, with scripts for an editor that lacks it. The folder `later` contains the library."""
    add_steps(plain_project, ("plugin.cfg", "plugin.gd", "steps.gd", "without_library.gd", "library_later.gd"))
    later = plain_project / "later"
    later.mkdir()
    (later / ".gdignore").touch()
    (later / "bin").symlink_to(DEMO / "addons/thicket/bin")
    shutil.copy(DEMO / "addons/thicket/thicket.gdextension", later)
    return plain_project


def test_without_the_library_the_plugin_warns_once(godot, godot_xvfb, libraryless_project):
    """Checks that, in a checkout before the first build, the plugin prints one warning that says how to fix the problem, and no
    script fails. The checks are in without_library.gd."""
    imported = godot(["--path", libraryless_project, "--import"], timeout=120)
    assert imported.returncode == 0
    # Only an editor with a window compiles all scripts that it indexes, to create their class reference.
    completed = godot_xvfb(["--editor", "--path", libraryless_project, "--", "without_library"], timeout=300)
    assert (libraryless_project / ".godot/editor/editor_script_doc_cache.res").exists(), completed.stdout
    for printed in (imported.stdout + imported.stderr, completed.stdout + completed.stderr):
        warning, *others = complaints(printed)
        assert not others and re.search(r"no native library for linux\.x86_64 is loaded\. Install .*addons/thicket/bin", warning), printed
    assert PASSED.search(completed.stdout), completed.stdout


def test_a_first_import_finds_the_library(godot, plain_project):
    """Checks that the plugin does not warn. The editor loads the library before it starts the plugin."""
    link_library(plain_project)
    shutil.rmtree(plain_project / ".godot")
    completed = godot(["--path", plain_project, "--import"], timeout=120)
    assert not complaints(completed.stdout + completed.stderr), completed.stdout + completed.stderr


def test_the_tools_appear_once_the_library_is_loaded(godot, libraryless_project):
    """Checks that the tools appear if the library is built or copied into the project while the editor runs. The steps
    are in library_later.gd."""
    completed = godot(["--editor", "--path", libraryless_project, "--", "library_later"], timeout=200)
    printed = completed.stdout + completed.stderr
    assert "library later: the tools exist" in printed and "library reloaded: the panel has added a layer" in printed, printed
    assert "SCRIPT ERROR" not in printed, printed


@pytest.mark.parametrize(
    "name",
    ["added", "brush", "preset", "gizmos", "region", "neighbors", "region_layers", "dropped", "layer", "inspector", "help"],
)
def test_screenshots(designer, name):
    """Checks that the editor has drawn its contents: the screenshot must have many shades of gray, none of which covers most of
    it."""
    image = np.asarray(Image.open(PICTURES / f"{name}.png").convert("L"), np.int16)
    shades = np.bincount(image.ravel(), minlength=256) / image.size
    assert image.shape == (900, 1440)
    assert (shades > 1e-4).sum() > 60 and shades.max() < 0.6


def test_screenshot_of_the_cursor(designer):
    """Checks that the ring of an erasing brush is red, by comparing the amount of red in its screenshot with a screenshot
    without a brush."""
    reds = {}
    for name in ("added", "brush"):
        image = np.asarray(Image.open(PICTURES / f"{name}.png").convert("RGB"), np.int16)[150:850, 290:1150]
        reds[name] = ((image[..., 0] > 200) & (image[..., 1] < 150) & (image[..., 2] < 130)).sum()
    assert reds["brush"] > reds["added"] + 200, reds
