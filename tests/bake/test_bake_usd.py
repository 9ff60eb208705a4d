"""Tests the export of a bake to USD. The USD library reads the stage and validates it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from bake.small import BAKES, PYTHON, bake, copy, expected, game, reader, refused, select  # noqa: F401 (some are fixtures)
from conftest import REPO, run
from scipy.spatial.transform import Rotation

ORIGIN = np.array([3_000_000.0, 900.0, -1_000_000.0])


@pytest.fixture(scope="module")
def exported(bake, game, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("usd")
    options = ["--project", game, "--origin", ",".join(map(str, ORIGIN))]
    completed = run(["bash", "demo_project/bake_export.sh", bake, "usd", folder, *options], timeout=300, cwd=REPO)
    assert completed.returncode == 0 and f"wrote 2640 instances in 11 tiles to {folder / 'world.usda'}" in completed.stderr, completed.stdout + completed.stderr
    assert "pyramid" not in completed.stderr
    return folder


@pytest.fixture(scope="module")
def read(exported, tmp_path_factory) -> tuple[dict, dict[str, np.ndarray]]:
    """Returns a description of the stage, and the instances that the USD library computes, sorted by layer and ID."""
    return stage_of(exported, tmp_path_factory.mktemp("read"))


def stage_of(folder: Path, scratch: Path) -> tuple[dict, dict[str, np.ndarray]]:
    completed = run([PYTHON, BAKES / "dump_usd.py", folder / "world.usda", scratch / "rows.npz"], timeout=60)
    assert completed.returncode == 0, completed.stderr
    return json.loads(completed.stdout), dict(np.load(scratch / "rows.npz"))


def test_the_stage_has_every_instance_at_its_position(read, expected):
    """Checks the transforms that the USD library computes. USD stores rotations with half precision."""
    _, rows = read
    drawn = select(expected, ~((expected["layer"] == 2) & (expected["model"] == 1)))
    wanted = select(drawn, np.lexsort((drawn["id"], drawn["layer"])))
    rows = select(rows, np.lexsort((rows["id"], rows["layer"])))
    assert np.array_equal(rows["id"], wanted["id"]) and np.array_equal(rows["layer"], wanted["layer"])
    assert rows["tile"].tolist() == [f"{x},{z}" for x, z in zip(wanted["tile_x"], wanted["tile_z"])]
    assert rows["model"].tolist() == [f"{('Oak', '', 'Grass')[layer]}_{model}" for layer, model in zip(wanted["layer"], wanted["model"])]
    places = np.stack([wanted[axis] for axis in "xyz"], axis=1) - ORIGIN
    assert np.abs(rows["matrix"][:, 3, :3] - places).max() < 1e-4
    assert np.array_equal(rows["scale"], np.stack([wanted[f"scale_{axis}"] for axis in "xyz"], axis=1))
    turns = Rotation.from_quat(np.stack([wanted[f"q{axis}"] for axis in "xyzw"], axis=1)).as_matrix()
    # USD multiplies row vectors.
    assert np.abs(rows["matrix"][:, :3, :3] - np.swapaxes(turns * wanted["scale_x"][:, None, None], 1, 2)).max() < 1e-2
    assert np.abs(rows["rank"] - wanted["rank"] / 2**32).max() < 1e-7
    oak = wanted["layer"] == 0
    colors = wanted["color"].astype("<u4").view(np.uint8).reshape(-1, 4)[:, :3] / 255
    assert np.abs(rows["color"][oak] - colors[oak]).max() < 1e-6 and np.isnan(rows["color"][~oak]).all()
    assert np.array_equal(rows["wind"][oak], wanted["wind_phase"][oak]) and np.isnan(rows["wind"][~oak]).all()


def test_instances_are_sorted_by_rank(read):
    _, rows = read
    for tile in set(rows["tile"]):
        for layer in (0, 2):
            assert (np.diff(rows["rank"][(rows["tile"] == tile) & (rows["layer"] == layer)]) >= 0).all()


def test_tiles_are_payloads_that_share_their_prototypes(read, exported):
    """Checks that a stage without payloads has only the tiles, that models exist once, and that the USD library finds no
    problem and no instance outside the stored bounding boxes."""
    about, _ = read
    assert (about["up"], about["meters"], about["problems"], about["outside"]) == ("Y", 1.0, [], 0)
    assert about["unloaded_prims"] == 12 and about["instancers"] == 22 and about["shared_prototypes"] == 3
    assert len(about["files"]) == 13 and {"world.usda", "prototypes.usdc"} < set(about["files"])
    assert not list(exported.rglob(".*")), "unfinished files"


def test_the_models_have_their_meshes_and_materials(read):
    models = read[0]["models"]
    assert sorted(models) == ["Grass_0", "Oak_0", "Oak_1"]
    assert models["Oak_0"]["box"] == [pytest.approx([-0.5, -3, -0.5], abs=1e-3), pytest.approx([0.5, 3, 0.5], abs=1e-3)]
    assert models["Oak_1"]["triangles"] == 24, "two boxes"
    color = [float(part) for part in models["Oak_1"]["inputs"][0]["diffuseColor"].strip("()").split(",")]
    assert color[0] > color[1] and color[0] == pytest.approx(color[2])


def test_usd_with_pyramids_and_selected_tiles(copy, tmp_path):
    """Checks that models without a project become pyramids, and that a tile keeps its position relative to the origin."""
    assert reader("usd", copy, tmp_path / "some", "--stand-ins", "--tiles=60001,-20001", "--origin=3000000,0,-1000000").returncode == 0
    about, rows = stage_of(tmp_path / "some", tmp_path)
    assert set(rows["tile"]) == {"60001,-20001"} and about["models"]["Oak_0"]["box"] == [[-1.5, 0, -1.5], [1.5, 6, 1.5]]
    assert 900 < rows["matrix"][:, 3, 1].min() and rows["matrix"][:, 3, 1].max() < 950 and about["problems"] == []
    (tmp_path / "file").write_text("mine")
    assert f"Cannot read or write {tmp_path / 'file'}" in refused("usd", copy, tmp_path / "file", "--stand-ins")


def test_textures_are_written_once(tmp_path):
    """Checks that models with the same texture refer to one file, and that texture coordinates are flipped."""
    completed = run([PYTHON, "-c", TEXTURED, tmp_path], timeout=60, cwd=REPO / "tools/bake")
    assert completed.returncode == 0, completed.stderr
    assert json.loads(completed.stdout) == [1, ["./textures", "./textures"], [[0.25, 0.25]], ["a", "rgb"]]


TEXTURED = """
import json, sys
from pathlib import Path
import numpy as np
from PIL import Image
from pxr import Usd, UsdGeom, UsdShade
from reading.bake import Layer, Level, Model
from reading.glb import ARRAY_BUFFER, Glb
from reading.usd import Prototypes

folder = Path(sys.argv[1])
Image.new("RGBA", (2, 2), (10, 200, 30, 255)).save(folder / "leaf.png")
pixels = np.frombuffer((folder / "leaf.png").read_bytes(), np.uint8)

class Models:
    def key(self, layer, model):
        return str(model)

    def reach(self, layer, model):
        return 1.0

    def file(self, layer, model):
        glb = Glb("test")
        glb.add_pyramid("x", 1.0, 2.0 + model, (1.0, 1.0, 1.0))
        content = glb.json
        primitive = content["meshes"][0]["primitives"][0]
        primitive["attributes"]["TEXCOORD_0"] = glb.add_accessor(np.full((18, 2), (0.25, 0.75), np.float32), ARRAY_BUFFER)
        glb.add_accessor(pixels)
        content["images"] = [{"bufferView": len(content["bufferViews"]) - 1, "mimeType": "image/png"}]
        content["textures"] = [{"source": 0}]
        content["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        content["materials"][0]["alphaMode"] = "MASK"
        return glb.content()

layer = Layer(0, "Oak", 1.0, False, False, tuple(Model("m", (Level("res://m", 0.0),)) for _ in range(2)))
prototypes = Prototypes(folder, Models())
for model in (0, 1):
    prototypes.prototype(layer, model)
prototypes.file.write(folder / "prototypes.usdc")
stage = Usd.Stage.Open(str(folder / "prototypes.usdc"))
shaders = [UsdShade.Shader(prim) for prim in stage.Traverse() if prim.GetName() == "Texture"]
files = [shader.GetInput("file").Get().path.rsplit("/", 1)[0] for shader in shaders]
st = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/Prototypes/Oak_0/Mesh_0")).GetPrimvar("st").Get()
print(json.dumps([len(list((folder / "textures").iterdir())), files, np.unique(np.array(st), axis=0).tolist(), sorted(output.GetBaseName() for output in shaders[0].GetOutputs())]))
"""
