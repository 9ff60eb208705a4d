"""Provides the small bake that all tests of bake readers use, and a project with the models of that bake."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ADDON, CACHE, REPO, run

PYTHON = CACHE / "bake-venv/bin/python"
BAKES = REPO / "tests/bake"
TOOLS = REPO / "tools/bake"


def new_game(folder: Path) -> Path:
    """Creates a project without the extension. It contains only the scripts that stream a world and the models of the
    small bake."""
    scripts = folder / "addons/thicket"
    scripts.mkdir(parents=True)
    (folder / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Baked"\n')
    for script in ADDON.glob("baked_world*.gd"):
        shutil.copy(script, scripts)
    (folder / "oak.tres").write_text('[gd_resource type="CylinderMesh" format=3]\n[resource]\nheight = 6.0\n')
    (folder / "far.tres").write_text('[gd_resource type="BoxMesh" format=3]\n[resource]\nsize = Vector3(1, 6, 1)\n')
    return folder


@pytest.fixture(scope="module")
def game(tmp_path_factory) -> Path:
    return new_game(tmp_path_factory.mktemp("game"))


@pytest.fixture(scope="module")
def bake(tmp_path_factory, godot, game) -> Path:
    """Returns the folder of the small bake, which tests/bake/make_bake.py writes."""
    folder = tmp_path_factory.mktemp("bakes") / "small"
    completed = run([PYTHON, BAKES / "make_bake.py", folder], timeout=60)
    assert completed.returncode == 0, f"{completed.stderr}\nsetup_bake in tools/setup.sh installs the Python packages"
    (folder / "models").mkdir()
    completed = godot(["--path", game, "--script", BAKES / "make_models.gd", "--", folder / "models"], timeout=60)
    assert (folder / "models/2_0.res").is_file(), completed.stdout + completed.stderr
    return folder


@pytest.fixture(scope="module")
def expected(bake) -> dict[str, np.ndarray]:
    """Returns the concatenated columns of all tiles of the small bake."""
    return dict(np.load(bake / "expected.npz"))


@pytest.fixture
def copy(bake, tmp_path) -> Path:
    """Returns a copy of the small bake, for tests that damage it."""
    return Path(shutil.copytree(bake, tmp_path / "copy"))


def reader(name: str, bake: Path, *arguments: str | Path, timeout: float = 120) -> subprocess.CompletedProcess[str]:
    return run([PYTHON, "-m", "reading", bake, name, *arguments], timeout, env={**os.environ, "PYTHONPATH": str(TOOLS)})


def refused(name: str, bake: Path, *arguments: str | Path) -> str:
    """Runs a reader that must reject a bake and must not print a traceback. Returns the error message."""
    completed = reader(name, bake, *arguments)
    assert completed.returncode == 1 and "Traceback" not in completed.stderr, completed.stdout + completed.stderr
    return completed.stderr


def manifest_of(folder: Path) -> dict:
    return json.loads((folder / "manifest.json").read_text())


def edit_manifest(folder: Path, **values: object) -> None:
    (folder / "manifest.json").write_text(json.dumps({**manifest_of(folder), **values}))


def select(rows: dict[str, np.ndarray], which: np.ndarray) -> dict[str, np.ndarray]:
    return {name: values[which] for name, values in rows.items()}


def of_tile(rows: dict[str, np.ndarray], tile: list[int], layer: int, model: int) -> dict[str, np.ndarray]:
    """Returns the rows of a model in a tile, sorted by rank and ID."""
    here = (rows["tile_x"] == tile[0]) & (rows["tile_z"] == tile[1]) & (rows["layer"] == layer) & (rows["model"] == model)
    found = select(rows, here)
    return select(found, np.lexsort((found["id"], found["rank"])))


def stops_of(engine, game: Path, *steps: str) -> tuple[list[dict], str]:
    """Runs tests/bake/stream_tiles.gd. Returns a description of the visible nodes after each step, and the output."""
    completed = engine(["--verbose", "--path", game, "--script", BAKES / "stream_tiles.gd", "--", "res://world/baked_world.scn", *steps], timeout=120)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "stream: done" in completed.stdout and "never settled" not in completed.stdout, printed[-4000:]
    assert "leaked" not in printed, printed[-4000:]
    return [json.loads(line) for line in re.findall(r"^stop (.*)$", completed.stdout, re.MULTILINE)], printed
