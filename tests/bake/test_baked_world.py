"""Tests that ScatterBakedWorld rejects untrusted and damaged files with an error message and does not run code from them."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from pathlib import Path

import pytest
from bake.small import BAKES, bake, game, reader, stops_of  # noqa: F401 (some are fixtures)
from helpers.engine_output import complaints

FIRST = "tile_60000_-20002"
PRESETS = """[preset.0]
name="Linux"
platform="Linux"
export_filter="all_resources"
include_filter=""
exclude_filter=""

[preset.0.options]
binary_format/architecture="x86_64"
"""
# A scene that prints a line when its script runs.
EVIL = """[gd_scene format=3]
[sub_resource type="GDScript" id="1"]
script/source = "extends Node3D
func _init():
	print(\\"CODE OF THE TILE RUNS\\")
"
[node name="Evil" type="Node3D"]
script = SubResource("1")
"""


@pytest.fixture(scope="module")
def world(bake, game) -> Path:
    completed = reader("godot", bake, game / "world", "--cell", "25")
    assert completed.returncode == 0, completed.stdout + completed.stderr
    return game / "world"


@pytest.fixture
def hurt(game, world) -> Path:
    """Returns a copy of the world, for tests that damage it, with a scene that refers to the copied index."""
    folder = game / "hurt"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(world, folder)
    script = '[ext_resource type="Script" path="res://addons/thicket/baked_world.gd" id="1"]\n'
    node = '[node name="World" type="Node3D"]\nscript = ExtResource("1")\nindex_file = "res://hurt/baked_world.baked"\n'
    (folder / "hurt.tscn").write_text(f"[gd_scene format=3]\n{script}{node}")
    return folder


def errors_of(engine, game: Path, *steps: str) -> tuple[list[dict], list[str], str]:
    stops, printed = stops_of(engine, game, "90,-40", "other=res://hurt/baked_world.baked", *steps)
    return stops, [line for line in complaints(printed) if "ScatterBakedWorld" in line], printed


def test_an_unusable_tile_is_reported_and_the_others_appear(godot, game, hurt):
    """Tests four tiles: one file is missing, one is not a tile, one is from another position, and one has a changed
    bit. Checks that each causes one error with the name of the file, and that the other tiles appear."""
    tiles = hurt / "tiles"
    (tiles / f"{FIRST}.baked").unlink()
    (tiles / "tile_60001_-20002.baked").write_text("no tile" * 20)
    shutil.copy(tiles / "tile_60003_-20000.baked", tiles / "tile_60002_-20000.baked")
    changed = bytearray((tiles / "tile_60003_-20001.baked").read_bytes())
    changed[len(changed) // 2] ^= 4
    (tiles / "tile_60003_-20001.baked").write_bytes(changed)
    stops, errors, _ = errors_of(godot, game, "far=200", "far=201")
    reasons = {
        "60000, -20002": "cannot be read: it cannot be opened", "60001, -20002": "it is not a file of a baked world",
        "60002, -20000": "is not the file that the index names", "60003, -20001": "it is damaged: its SHA-256 must be",
    }  # fmt: skip
    for name, why in reasons.items():
        (line,) = [line for line in errors if f"({name})" in line]
        assert why in line and "Export the bake again." in line and "res://hurt/tiles/tile_" in line
    assert len(stops[-1]["failed"]) == 4 and len(stops[-1]["tiles"]) == 7


@pytest.mark.parametrize("engine", ["godot", "godot_xvfb"])
def test_foreign_scripts_do_not_run(engine, game, hurt, request):
    """Checks that a scene with a script is not loaded in place of a tile, next to it, or through a remap. Runs with and
    without a renderer, that is, with and without threads."""
    evil = game / "evil.tscn"
    evil.write_text(EVIL)
    for name in (f"{FIRST}.baked", f"{FIRST}.scn", f"{FIRST}.tscn"):
        shutil.copy(evil, hurt / "tiles" / name)
    second = hurt / "tiles/tile_60001_-20002.baked"
    second.rename(hurt / "tiles/kept")
    second.with_name(second.name + ".remap").write_text('[remap]\npath="res://evil.tscn"\n')
    stops, errors, printed = errors_of(request.getfixturevalue(engine), game, "far=200")
    assert "CODE OF THE TILE RUNS" not in printed
    assert sorted(stops[-1]["failed"]) == [[60000, -20002], [60001, -20002]] and len(errors) == 2, printed[-4000:]
    proof = request.getfixturevalue("godot")(["--path", game, "--script", BAKES / "instantiate.gd", "--", "res://evil.tscn"], timeout=60)
    assert "CODE OF THE TILE RUNS" in proof.stdout, "loading the scene runs its code"


def test_foreign_files_are_rejected_for_their_values(godot, game, world, tmp_path):
    """Checks tiles with changed bits, and tiles in which each field is replaced by values of any kind, with matching
    digests as in forged files."""
    completed = godot(["--path", game, "--script", BAKES / "foreign_tiles.gd", "--", "res://world/baked_world.baked", tmp_path / "foreign"], timeout=300)
    printed = completed.stdout + completed.stderr
    cases = [json.loads(line) for line in re.findall(r"^case (.*)$", completed.stdout, re.MULTILINE)]
    assert completed.returncode == 0 and len(cases) > 1000 and not [line for line in complaints(printed) if "SCRIPT" in line], printed[-4000:]
    taken = [what for what, refused in cases if not refused]
    harmless = {"good", "nodes = []", "begin = 0.5", "begin = 1000000000.0", "end = 0.5", "end = 1000000000.0", "box = null", "no box", "material = -1", 'name = "x"'}
    harmless |= {"render_layers = 1000000000.0", "index layer_names = []", "index meshes = []", 'index scene_digest = "x"', "index tile_size = 0.5"}
    harmless |= {"index tile_size = 1000000000.0", "index tile_size = 4294967296.0"}
    assert set(taken) <= harmless and "good" in taken, set(taken) - harmless
    assert all("must be" in refused or "must" in refused or "damaged" in refused or "is not " in refused or "belongs to" in refused or "index names" in refused
               for _, refused in cases if refused)  # fmt: skip
    assert len([what for what, _ in cases if what == "flip"]) == 200
    assert any("must be in res://, got user://evil.tscn" in refused for _, refused in cases)


def test_an_unusable_index_is_reported(godot, game, hurt):
    """Checks the errors for a damaged index and for an index resource written by an earlier version."""
    index = hurt / "baked_world.baked"
    index.write_bytes(index.read_bytes()[:-1])
    completed = godot(["--path", game, "--script", BAKES / "instantiate.gd", "--", "res://hurt/hurt.tscn"], timeout=60)
    errors = complaints(completed.stdout + completed.stderr)
    assert len(errors) == 1 and "ScatterBakedWorld.index_file is res://hurt/baked_world.baked" in errors[0] and "it is damaged" in errors[0] and "bake_export.sh" in errors[0]
    old = '[gd_resource type="Resource" script_class="BakedWorldIndex" format=3]\n[ext_resource type="Script" path="res://addons/thicket/baked_world_index.gd" id="1"]\n'
    (game / "old.tres").write_text(old + '[resource]\nscript = ExtResource("1")\nscene_digest = "5ce7e"\n')
    world = '[gd_scene format=3]\n[ext_resource type="Script" path="res://addons/thicket/baked_world.gd" id="1"]\n[ext_resource type="Resource" path="res://old.tres" id="2"]\n'
    (game / "old.tscn").write_text(world + '[node name="World" type="Node3D"]\nscript = ExtResource("1")\nindex = ExtResource("2")\n')
    completed = godot(["--path", game, "--script", BAKES / "instantiate.gd", "--", "res://old.tscn"], timeout=60)
    errors = complaints(completed.stdout + completed.stderr)
    assert len(errors) == 1 and "ScatterBakedWorld.index names res://old.tres, which an earlier version exported" in errors[0] and "Export the bake again" in errors[0], errors


def test_a_missing_mesh_is_reported_once(godot, game, hurt):
    kept = game / "far.tres"
    kept.rename(game / "far.kept")
    try:
        stops, errors, printed = errors_of(godot, game, "far=200")
    finally:
        (game / "far.kept").rename(kept)
    # Each of the two worlds reports the mesh once.
    assert len([line for line in errors if "res://far.tres cannot be loaded" in line]) == 2, errors
    assert len(stops[-1]["tiles"]) == 11, printed[-4000:]


@pytest.mark.parametrize("engine", ["godot", "godot_xvfb"])
def test_it_streams_without_threads(engine, game, world, request):
    """Checks that streaming works without threads, as in most web builds, with and without a renderer."""
    project = game / "project.godot"
    settings = project.read_text()
    project.write_text(settings + "[threading]\nworker_pool/max_threads=0\n")
    try:
        stops, printed = stops_of(request.getfixturevalue(engine), game, "90,-40", "far=200")
    finally:
        project.write_text(settings)
    assert len(stops[-1]["tiles"]) == 11 and not complaints(printed), printed[-4000:]


def test_a_game_export_includes_the_files(godot, game, world, tmp_path):
    """Checks that the default export filter of a game, which includes all resources, includes the files of the
    world."""
    (game / "export_presets.cfg").write_text(PRESETS)
    godot(["--path", game, "--import"], timeout=300)
    completed = godot(["--path", game, "--export-pack", "Linux", tmp_path / "game.zip"], timeout=300)
    packed = tmp_path / "game.zip"
    assert packed.is_file(), completed.stdout + completed.stderr
    names = set(zipfile.ZipFile(packed).namelist())
    assert {f"world/{file.relative_to(world).as_posix()}" for file in world.rglob("*.baked")} <= names, names
