"""Follows README.md in an empty project, with mouse and keys only: a newcomer's own tree grows on a newcomer's own ground. The page must state how
many clicks this takes, and its pictures must show what the newcomer sees."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import REPO
from helpers.editor_project import PICTURES, STEPS, add_steps, check_passed, link_library, new_plain_project
from helpers.engine_output import complaints
from PIL import Image

README = (REPO / "README.md").read_text(encoding="utf-8")
SECTION = README.split("## Install\n")[1].split("## A first forest in ten lines")[0]
# The frames of the film, for tools/film.sh.
FRAMES = REPO / "build/film/frames/editor"
# The largest mean difference in brightness, from 0 to 255, between a picture of the page and the screen, both scaled down to SMALL. Other fonts and
# rasterizers stay below it. A moved panel or a different dialog does not.
MOST = 8.0
SMALL = (160, 90)


def new_project(folder: Path, godot) -> Path:
    """Creates an empty project with the add-on's folder, in which the plugin is off, and with the newcomer's files."""
    new_plain_project(folder)
    link_library(folder)
    add_steps(folder)
    settings = folder / "project.godot"
    settings.write_text(settings.read_text().replace('"res://addons/thicket/plugin.cfg", ', "").replace('"Plain"', '"My forest"'))
    shutil.copytree(REPO / "demo_project/meshes", folder / "meshes")
    made = godot(["--path", folder, "--script", "res://tests/newcomer_files.gd"], timeout=120)
    assert "written" in made.stdout and not complaints(made.stdout + made.stderr), made.stdout + made.stderr
    shutil.rmtree(folder / "meshes")
    godot(["--path", folder, "--import"], timeout=120)
    # When the editor first draws the texture in 3D, it imports it again for graphics cards. That takes minutes with software rendering.
    (texture,) = folder.glob("oak_*.png.import")
    texture.write_text(texture.read_text().replace("detect_3d/compress_to=1", "detect_3d/compress_to=0").replace("mipmaps/generate=false", "mipmaps/generate=true"))
    godot(["--path", folder, "--import"], timeout=120)
    settings.write_text(settings.read_text() + '[rendering]\nrenderer/rendering_method="gl_compatibility"\n')
    return folder


@pytest.fixture(scope="module")
def project(godot, tmp_path_factory) -> Path:
    return new_project(tmp_path_factory.mktemp("newcomer"), godot)


@pytest.fixture(scope="module")
def newcomer(godot_xvfb, project) -> str:
    """Returns the output of the editor in which the steps of the page are performed."""
    completed = godot_xvfb(["--single-window", "--editor", "--path", project, "--", "newcomer"], timeout=300)
    return completed.stdout + completed.stderr


@pytest.fixture(scope="module")
def game(godot_xvfb, newcomer, project) -> str:
    """Returns the output of the game, which plays the newcomer's scene."""
    completed = godot_xvfb(["--path", project, "--script", "res://tests/newcomer_game.gd", "--", PICTURES / "newcomer_6.png"], timeout=120)
    return completed.stdout + completed.stderr


def test_the_steps_of_the_readme(newcomer):
    """Checks that all steps succeed. The checks themselves are in newcomer.gd."""
    check_passed(newcomer)


def test_the_pages_state_the_effort(newcomer):
    clicks, drags, keys = re.search(r"^newcomer: (\d+) clicks, (\d+) drags, (\d+) keys$", newcomer, re.MULTILINE).groups()
    for text in (SECTION, (REPO / "docs/getting_started.md").read_text(encoding="utf-8")):
        assert f"{clicks} clicks, {drags} drags and {keys} keys" in text


def test_the_readme_names_what_is_clicked():
    """Checks that the page names each button, tab and dialog that the steps use, in the same order."""
    steps = (STEPS / "newcomer_steps.gd").read_text(encoding="utf-8")
    clicked = [name for name in re.findall(r'(?:button\(|choose\(.*|click\(\w*tab.*)"([A-Z3][^"]+)"', steps) if name not in ("Save", "Close")]
    assert clicked == ["Project Settings", "Plugins", "3D Scene", "Scatter", "New Scatter", "Use as Ground...", "Add Camera, Sun, Sky and Wind"]
    places = [SECTION.index(f"*{name}*" if name not in ("Project Settings", "Plugins") else name) for name in clicked]
    assert places == sorted(places)


def test_the_forest_grows_in_the_game(game):
    assert not complaints(game), game
    assert int(re.search(r"^newcomer: (\d+) trees in the game$", game, re.MULTILINE).group(1)) > 100


@pytest.mark.parametrize("step", range(1, 7))
def test_the_pictures_match_the_screen(game, step):
    """Checks that the page has a picture of each step, and that it shows the same as the screen after this step."""
    picture = f"demo_project/pictures/newcomer_{step}.jpg"
    assert f"]({picture})" in SECTION
    images = [Image.open(path).convert("L").resize(SMALL, Image.Resampling.BOX) for path in (REPO / picture, PICTURES / f"newcomer_{step}.png")]
    expected, seen = (np.asarray(image, np.float64) for image in images)
    assert seen.std() > 15
    assert np.abs(expected - seen).mean() < MOST, "run bash tools/tutorial_pictures.sh"


@pytest.mark.full
def test_frames_of_the_film(godot, godot_xvfb, tmp_path):
    """Films the steps in the editor and a stroke of the brush. The steps are in newcomer_film.gd."""
    folder = new_project(tmp_path, godot)
    shutil.rmtree(FRAMES, ignore_errors=True)
    FRAMES.mkdir(parents=True)
    completed = godot_xvfb(["--single-window", "--editor", "--path", folder, "--", "newcomer_film", FRAMES], timeout=600)
    check_passed(completed.stdout + completed.stderr)
    frames = sorted(FRAMES.glob("*.png"))
    shades = [np.asarray(Image.open(path).convert("L").resize(SMALL)).std() for path in frames]
    assert len(frames) > 60 and min(shades) > 15
