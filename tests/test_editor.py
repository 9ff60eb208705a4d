"""The editor's side: a designer's steps in the real editor, drawn in software, with pictures in build/editor."""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import REPO
from PIL import Image

DEMO = REPO / "demo_project"
STEPS = REPO / "tests/engine/editor"
PICTURES = REPO / "build/editor"
PASSED = re.compile(r"^editor tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)
COMPLAINT = re.compile(r"^(?:SCRIPT |USER |SHADER )?(?:ERROR|WARNING)\b.*", re.MULTILINE)
# What the software renderer and a machine without sound say on their own.
HARMLESS = ("V-Sync mode", "audio driver", "X509")

# Where the editor's camera stands when the demo scene is opened for the first time: 45 m from the place that
# demo_scene.gd calls LOOKED_AT, on the ground there.
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


def complaints(printed: str) -> list[str]:
    return [line for line in COMPLAINT.findall(printed) if not any(words in line for words in HARMLESS)]


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    """The demo project, with the plugin that works as a designer would; what is saved goes into the copy."""
    folder = tmp_path_factory.mktemp("editor")
    skipped = shutil.ignore_patterns(".godot", "bin", "pictures", "project.godot")
    shutil.copytree(DEMO, folder, dirs_exist_ok=True, ignore=skipped)
    (folder / "addons/thicket/bin").symlink_to(DEMO / "addons/thicket/bin")
    shutil.copytree(STEPS, folder / "tests")
    PICTURES.mkdir(parents=True, exist_ok=True)
    (folder / "pictures_of_tests").symlink_to(PICTURES)
    (PICTURES / ".gdignore").touch()
    settings = (DEMO / "project.godot").read_text()
    both = 'enabled=PackedStringArray("res://addons/thicket/plugin.cfg", "res://tests/plugin.cfg")'
    settings, count = re.subn(r"^enabled=PackedStringArray\(.*\)$", both, settings, flags=re.MULTILINE)
    assert count == 1, "the demo project has the plugin switched on"
    settings, count = re.subn("msaa_3d=2", "msaa_3d=0", settings)
    assert count == 1
    (folder / "project.godot").write_text(settings)
    states = folder / ".godot/editor"
    states.mkdir(parents=True)
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    name = hashlib.md5(b"res://demo.tscn").hexdigest()
    (states / f"demo.tscn-editstate-{name}.cfg").write_text(VIEW % GROUND)
    return folder


@pytest.fixture(scope="module")
def designer(godot, godot_xvfb, project) -> str:
    """What is printed while the demo scene is worked on."""
    imported = godot(["--path", project, "--import"], timeout=120)
    assert not complaints(imported.stdout + imported.stderr)
    for old in PICTURES.glob("*.png"):
        old.unlink()
    done = godot_xvfb(["--editor", "--path", project, "--", "demo_scene"], timeout=900)
    return done.stdout + done.stderr


def test_a_designers_first_hour(designer):
    """A node, a layer, a stroke, undo, redo, save, reopen, presets, shapes, bake: checks in demo_scene.gd."""
    assert PASSED.search(designer), designer[-6000:]
    assert not complaints(designer), complaints(designer)


@pytest.fixture
def plain_project(tmp_path) -> Path:
    """A new project with the addon, and nothing else."""
    text = 'config_version=5\n[application]\nconfig/name="Plain"\n[editor_plugins]\n'
    (tmp_path / "project.godot").write_text(text + 'enabled=PackedStringArray("res://addons/thicket/plugin.cfg")\n')
    skipped = shutil.ignore_patterns("bin", "*.gdextension*")
    shutil.copytree(DEMO / "addons/thicket", tmp_path / "addons/thicket", ignore=skipped)
    return tmp_path


def test_bake(godot, plain_project):
    """What a bake writes, how it is given up, what it refuses; where the brush's ray meets the ground."""
    addon = plain_project / "addons/thicket"
    (addon / "bin").symlink_to(DEMO / "addons/thicket/bin")
    shutil.copy(DEMO / "addons/thicket/thicket.gdextension", addon)
    (plain_project / ".godot").mkdir()
    (plain_project / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    done = godot(["--verbose", "--path", plain_project, "--script", REPO / "tests/engine/test_bake.gd"], timeout=120)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and re.search(r"^thicket engine tests: \d+ checks, 0 failed$", printed, re.M), printed
    assert "leaked" not in printed, printed


def test_one_click_bakes_impostors(godot, plain_project):
    """Checks in impostors.gd."""
    addon = plain_project / "addons/thicket"
    (addon / "bin").symlink_to(DEMO / "addons/thicket/bin")
    shutil.copy(DEMO / "addons/thicket/thicket.gdextension", addon)
    shutil.copytree(STEPS, plain_project / "tests")
    settings = plain_project / "project.godot"
    settings.write_text(settings.read_text().replace("cfg\")", 'cfg", "res://tests/plugin.cfg")'))
    (plain_project / ".godot").mkdir()
    (plain_project / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    done = godot(["--editor", "--path", plain_project, "--", "impostors"], timeout=120)
    printed = done.stdout + done.stderr
    assert PASSED.search(printed) and not complaints(printed), printed[-6000:]


def test_without_the_library_the_plugin_is_silent(godot, plain_project):
    """As in a checkout that is not built yet: the editor reads all scripts, and none of them complains."""
    done = godot(["--editor", "--path", plain_project, "--quit-after", "60"], timeout=120)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and not complaints(printed), complaints(printed)


@pytest.mark.parametrize(
    "name",
    ["added", "brush", "preset", "gizmos", "region", "neighbors", "region_layers", "dropped", "layer", "inspector", "help"],
)
def test_pictures(designer, name):
    """The editor drew something: many shades, none of them most of the picture."""
    image = np.asarray(Image.open(PICTURES / f"{name}.png").convert("L"), np.int16)
    shades = np.bincount(image.ravel(), minlength=256) / image.size
    assert image.shape == (900, 1440)
    assert (shades > 1e-4).sum() > 60 and shades.max() < 0.6


def test_picture_of_the_cursor(designer):
    """The ring of an erasing brush is red, and no other picture has so much of it."""
    reds = {}
    for name in ("added", "brush"):
        image = np.asarray(Image.open(PICTURES / f"{name}.png").convert("RGB"), np.int16)[150:850, 290:1150]
        reds[name] = ((image[..., 0] > 200) & (image[..., 1] < 150) & (image[..., 2] < 130)).sum()
    assert reds["brush"] > reds["added"] + 200, reds
