"""Tests that the readers of a bake reject damaged files. Also tests the export of a bake to Godot, and the node that
streams the exported world."""

from __future__ import annotations

import base64
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from bake.small import BAKES, bake, copy, edit_manifest, expected, game, manifest_of, of_tile, reader, refused, stops_of  # noqa: F401 (some are fixtures)
from conftest import REPO, run
from scipy.spatial.transform import Rotation
from helpers.engine_output import complaints


# Errors in a bake, for all readers


def test_a_folder_without_a_bake_is_rejected(tmp_path):
    assert f"{tmp_path} is not a bake: it does not contain manifest.json" in refused("maps", tmp_path, tmp_path / "maps")


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"version": 2}, "version must be 1, got 2; bake again with this version of Thicket"),
        ({"format": "other"}, "is not the manifest of a bake"),
        ({"rect": [0, 0, -5, 5]}, "rect must be x, z, width and depth in meters, the last two above 0, got -5; restore the manifest of the bake"),
        ({"tile_size": 0}, "tile_size must be a number from 0.001 to 1e+12, got 0"),
        ({"layers": [{"index": 0}]}, "layers[0].radius is missing, but is required"),
        ({"layers": [{"index": 0, "radius": 0, "models": []}]}, "layers[0].radius must be a number from 0.001 to 1e+06, got 0"),
        ({"tiles": {"0,0": {"file": "../../other", "rows": 1, "digest": "0" * 64}}}, "the file of tile 0,0 is outside of the bake"),
    ],
)
def test_an_invalid_manifest_is_rejected(copy, tmp_path, values, says):
    edit_manifest(copy, **values)
    assert says in refused("maps", copy, tmp_path / "maps")


def test_damaged_tiles_are_rejected(copy, tmp_path):
    """Checks that a missing, truncated or swapped tile is rejected, with the name of the file and the command that bakes
    the tile again."""
    first, second = (copy / f"tiles/tile_{x}_-20002.parquet" for x in (60000, 60001))
    whole = first.read_bytes()
    for damage in (lambda: first.unlink(), lambda: first.write_bytes(whole[: len(whole) // 2]), lambda: shutil.copy(copy / "tiles/tile_60002_-20001.parquet", first)):
        damage()
        output = refused("maps", copy, tmp_path / "maps")
        assert "tile_60000_-20002.parquet" in output or "tile 60000,-20002 cannot be read" in output, output
        assert "bake that tile again: run the command of the bake with --tiles 60000,-20002" in output
    first.write_bytes(whole)
    broken = bytearray(second.read_bytes())
    broken[100:2000] = bytes(1900)
    second.write_bytes(broken)
    assert "tile 60001,-20002 is damaged" in refused("gltf", copy, tmp_path / "gltf", "--stand-ins")
    assert "tile_60001_-20002.parquet is damaged" in refused("gltf", copy, tmp_path / "gltf", "--stand-ins", "--no-verify")


def test_an_unwritable_folder_is_rejected_by_name(copy, tmp_path):
    (tmp_path / "file").write_text("mine")
    for writer, options in (("maps", ()), ("gltf", ("--stand-ins",))):
        output = refused(writer, copy, tmp_path / "file", *options)
        assert f"Cannot read or write {tmp_path / 'file'}" in output, output


def test_the_command_prints_its_usage(bake):
    for arguments in ([], [bake, "obj", "out"]):
        completed = run(["bash", "demo_project/bake_export.sh", *arguments], timeout=60, cwd=REPO)
        assert completed.returncode == 2 and "bake_export.sh BAKE gltf FOLDER" in completed.stderr


# The export to Godot


@pytest.fixture(scope="module")
def world(bake, game) -> Path:
    """Returns the folder of the world in the game's project, exported with the documented command."""
    completed = run(["bash", "demo_project/bake_export.sh", bake, "godot", game / "world", "--cell", "25"], timeout=120, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    assert "res://world/baked_world.scn streams 2640 instances in 11 tiles" in completed.stderr, completed.stderr
    return game / "world"


@pytest.fixture(scope="module")
def nodes(godot, game, world) -> list[dict]:
    """Returns the nodes of all tiles as the engine has loaded them."""
    completed = godot(["--path", game, "--script", BAKES / "dump_tiles.gd", "--", "res://world/baked_world.baked"], timeout=60)
    found = [json.loads(line) for line in re.findall(r"^node (.*)$", completed.stdout, re.MULTILINE)]
    assert completed.returncode == 0 and found and not complaints(completed.stdout + completed.stderr), completed.stdout + completed.stderr
    for node in found:
        stride = 12 + 4 * node["colors"] + 4 * node["custom"]
        node["rows"] = np.frombuffer(base64.b64decode(node["buffer"]), np.float32).reshape(-1, stride)
    return found


def transforms_of(rows: dict[str, np.ndarray]) -> np.ndarray:
    """Returns the transforms of n rows as an array of n x 3 x 4 doubles: a basis and a position in the world."""
    turn = Rotation.from_quat(np.stack([rows[name] for name in ("qx", "qy", "qz", "qw")], axis=1)).as_matrix()
    scale = np.stack([rows[f"scale_{axis}"] for axis in "xyz"], axis=1).astype(np.float64)
    place = np.stack([rows[axis] for axis in "xyz"], axis=1)
    return np.concatenate([turn * scale[:, None, :], place[:, :, None]], axis=2)


def test_exported_tiles_have_every_instance_at_its_baked_position(nodes, expected):
    """Checks that positions 3,000 km from the origin are exact to 0.01 mm. Colors and custom data must match, and each
    level of detail must have all instances."""
    seen = 0
    for tile in sorted({tuple(node["tile"]) for node in nodes}):
        for layer, model, name, levels in ((0, 0, "Oak_0", ["_LOD0", "_LOD1"]), (0, 1, "Oak_1", [""]), (2, 0, "Grass_0", [""])):
            wanted = of_tile(expected, list(tile), layer, model)
            for level in levels:
                here = [node for node in nodes if tuple(node["tile"]) == tile and re.fullmatch(rf"{name}_\d+{level}", node["name"])]
                rows = np.concatenate([node["rows"] for node in here])
                center = np.array(here[0]["center"])
                want = transforms_of(wanted)
                want[:, :, 3] -= center
                order, want_order = np.lexsort(rows[:, [3, 11]].T), np.lexsort(want.reshape(-1, 12)[:, [3, 11]].T)
                assert np.abs(rows[order, :12] - want.reshape(-1, 12)[want_order]).max() < 1e-5
                assert np.abs(rows[:, [3, 11]]).max() < 25.1
                if layer == 0:
                    colors = wanted["color"].astype("<u4").view(np.uint8).reshape(-1, 4) / 255
                    custom = np.stack([wanted["variation"], wanted["wind_phase"], wanted["rank"] / 2**32, np.abs(wanted["scale_x"])], axis=1)
                    assert np.abs(rows[order, 12:16] - colors[want_order]).max() < 1e-3
                    assert np.abs(rows[order, 16:20] - custom[want_order]).max() < 2e-3
                else:
                    assert not here[0]["colors"] and not here[0]["custom"]
                ranks = np.empty(len(rows), np.int64)
                ranks[order] = wanted["rank"][want_order]
                cells = np.unique((want[:, [0, 2], 3] > 0) & (name != "Oak_1"), axis=0)
                assert len(here) == len(cells), "only models that change with distance have cells"
                for part in np.split(ranks, np.cumsum([len(node["rows"]) for node in here])[:-1]):
                    assert (np.diff(part) >= 0).all(), "a cell is thinned from the end of its buffer"
                seen += len(rows) if level != "_LOD1" else 0
    empty_models = int(((expected["layer"] == 2) & (expected["model"] == 1)).sum())
    assert empty_models > 0 and seen == len(expected["id"]) - empty_models


def test_meshes_are_referenced_or_copied_once(nodes, world, bake):
    """Checks that tiles refer to a mesh of the project by its path, and that a mesh that exists only in the bake is
    copied once."""
    meshes = {re.sub(r"(_\d+)_\d+", r"\1", node["name"]): node["mesh"] for node in nodes}
    assert meshes["Oak_0_LOD0"] == "res://oak.tres" and meshes["Oak_0_LOD1"] == "res://far.tres"
    assert meshes["Grass_0"] == "res://world/models/2_0.res"
    assert (world / "models/2_0.res").read_bytes() == (bake / "models/2_0.res").read_bytes()
    assert len(list((world / "models").iterdir())) == 2
    rock = next(node for node in nodes if node["name"].startswith("Oak_1_"))
    assert rock["mesh"].startswith("res://world/models/") and rock["surfaces"] == 1 and rock["height"] == pytest.approx(3.0)


def test_levels_of_detail_have_no_gap_and_never_begin_too_early(nodes):
    """Checks that a level begins where the previous one ends, measured from the same center. No instance nearer than 40 m may
    use the coarse level."""
    fine = {(*node["tile"], node["name"][:-5]): node for node in nodes if node["name"].endswith("_LOD0")}
    coarse = {(*node["tile"], node["name"][:-5]): node for node in nodes if node["name"].endswith("_LOD1")}
    assert fine.keys() == coarse.keys() and len(fine) >= 11
    for key, near in fine.items():
        far = coarse[key]
        assert near["begin"] == 0 and near["end"] == far["begin"] and far["end"] == 0
        assert near["box"] == far["box"]
        box = np.reshape(near["box"], (2, 3))
        middle = box.mean(axis=0)
        places = near["rows"][:, [3, 7, 11]]
        assert np.linalg.norm(places - middle, axis=1).max() <= near["end"] - 40 + 1e-3
        assert ((places > box[0]) & (places < box[1])).all()
    grass = [node for node in nodes if node["name"].startswith("Grass_0_")]
    assert all(70 < node["end"] < 70 + 50 for node in grass)


def test_cells_are_smaller_if_levels_change_nearby(godot, copy, game):
    """Checks that a 50 m tile has up to 3 x 3 cells if the second level begins at 5 m, although --cell permits larger
    ones. Models without levels are not divided."""
    layers = manifest_of(copy)["layers"]
    layers[0]["models"][0]["lods"][1]["distance"] = 5.0
    edit_manifest(copy, layers=layers)
    assert reader("godot", copy, game / "near").returncode == 0
    completed = godot(["--path", game, "--script", BAKES / "dump_tiles.gd", "--", "res://near/baked_world.baked"], timeout=60)
    here = [node for node in map(json.loads, re.findall(r"^node (.*)$", completed.stdout, re.MULTILINE)) if node["tile"] == [60001, -20001]]
    assert 5 <= sum(node["name"].endswith("_LOD0") for node in here) <= 9
    assert all(5 <= node["end"] < 5 + 30 for node in here if node["name"].endswith("_LOD0"))
    assert sum(node["name"].startswith("Oak_1_") for node in here) == 1


def test_an_export_only_replaces_an_earlier_export(bake, game, world, tmp_path):
    """Checks that the export keeps other files, and that it rejects a folder outside a project and a project without the
    scripts."""
    foreign = game / "mine"
    foreign.mkdir()
    (foreign / "tiles.txt").write_text("mine")
    assert "has files that are not from an export" in refused("godot", bake, foreign)
    assert [file.name for file in foreign.iterdir()] == ["tiles.txt"]
    assert "is not in a Godot project" in refused("godot", bake, tmp_path / "out")
    bare = tmp_path / "bare"
    bare.mkdir()
    (bare / "project.godot").write_text("config_version=5\n")
    assert "has no addons/thicket/baked_world.gd: copy the add-on, or only these scripts" in refused("godot", bake, bare / "out")
    assert "--cell must be above 0 m, got -1.0" in refused("godot", bake, game / "again", "--cell", "-1")
    again = game / "again"
    shutil.copytree(world, again)
    (again / "tiles/tile_1_1.baked").write_bytes(b"of an earlier bake")
    assert reader("godot", bake, again).returncode == 0
    assert sorted(file.name for file in (again / "tiles").iterdir()) == sorted(file.name for file in (world / "tiles").iterdir())


def test_an_unavailable_model_is_reported_by_name(copy, game):
    layers = manifest_of(copy)["layers"]
    layers[0]["models"][1] = {"path": "res://gone.tscn", "name": "rock"}  # Older manifests contain paths of scenes.
    edit_manifest(copy, layers=layers)
    assert "res://gone.tscn cannot be loaded: check that it is in the project." in refused("godot", copy, game / "without")
    assert not (game / "without/baked_world.baked").exists()
    layers[0]["models"][1]["path"] = "models/gone.res"
    edit_manifest(copy, layers=layers)
    assert f"{copy} has no models/gone.res, which its manifest names" in refused("godot", copy, game / "without")
    (game / "oak.tscn").write_text('[gd_scene format=3]\n[node name="Oak" type="Node3D"]\n')
    layers[0]["models"][1]["path"] = "res://oak.tscn"
    edit_manifest(copy, layers=layers)
    assert "res://oak.tscn is a scene, which only Thicket's library can read" in refused("godot", copy, game / "without")


# The streaming node


def distance(tile: str, place: tuple[float, float]) -> float:
    """Returns the distance from a position in the world to the square of a tile, in meters."""
    low = np.array([int(part) * 50.0 for part in tile.split(",")])
    return float(np.linalg.norm(np.clip(place, low, low + 50) - place))


@pytest.mark.parametrize("engine", ["godot", "godot_xvfb"])
def test_tiles_appear_and_disappear_with_the_camera(engine, game, world, bake, request):
    """Checks that exactly the tiles within the view distance appear, and that tiles disappear when they are a quarter
    of a tile beyond it. The content must match the manifest. Runs with and without a renderer, because files are read
    on threads only with a renderer."""
    tiles = {key: entry for key, entry in manifest_of(bake)["tiles"].items() if entry["rows"]}
    walk = [(20.0, -80.0), (120.0, -80.0), (170.0, 20.0), (5000.0, 0.0)]
    stops, printed = stops_of(request.getfixturevalue(engine), game, *(f"{x},{z}" for x, z in walk))
    assert not complaints(printed), printed[-4000:]
    before: set[str] = set()
    for (x, z), stop in zip(walk, stops, strict=True):
        here = (3_000_000.0 + x, -1_000_000.0 + z)
        shown = {f"{i},{j}" for i, j in stop["tiles"]}
        near = {key for key in tiles if distance(key, here) <= 30}
        kept = {key for key in before if distance(key, here) <= 30 + 12.5}
        assert shown == near | kept
        assert stop["children"] == len(shown)
        assert stop["instances"] == sum(tiles[key]["rows"] for key in shown)
        # Instances of the empty model are counted but not drawn.
        assert 0 <= stop["instances"] - stop["drawn"] <= 0.05 * stop["instances"]
        for key, place in stop["places"].items():
            i, j = (int(part) for part in key.split(","))
            assert place[0] == (i + 0.5) * 50 - 3_000_000 and place[2] == (j + 0.5) * 50 + 1_000_000
        before = shown
    assert 2 <= len(stops[0]["tiles"]) < len(tiles) and not stops[3]["tiles"]


def test_work_in_a_frame_is_bounded(godot, game, world):
    """Checks that, with a tiny time budget, one tile is added per frame, regardless of how many tiles are ready, and one
    is removed, regardless of how many are too far away."""
    stops, _ = stops_of(godot, game, "90,-40", "far=200", "5000,0")
    assert stops[1]["most"] == 1 and len(stops[1]["tiles"]) == 11
    assert stops[2]["most_removed"] == 1 and not stops[2]["tiles"]


def test_the_world_moves_with_the_origin(godot, game, world):
    stops, printed = stops_of(godot, game, "90,-40", "offset=3000064")
    assert not complaints(printed)
    assert stops[0]["tiles"] == stops[1]["tiles"]
    for key, place in stops[0]["places"].items():
        assert stops[1]["places"][key] == [place[0] - 64, place[1], place[2]]
