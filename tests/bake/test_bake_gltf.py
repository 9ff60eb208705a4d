"""Tests the export of a bake to binary glTF with GPU instancing. Independent code parses the files, and the Khronos
validator checks them."""

from __future__ import annotations

import json
import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from bake.small import bake, copy, edit_manifest, expected, game, manifest_of, of_tile, reader, refused  # noqa: F401 (some are fixtures)
from conftest import CACHE, REPO, run


def parse(file: Path) -> tuple[dict, bytes]:
    """Returns the two chunks of a binary glTF file: the parsed JSON and the binary data."""
    data = file.read_bytes()
    magic, version, length, json_length, json_kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, length, json_kind) == (b"glTF", 2, len(data), b"JSON")
    binary_length, binary_kind = struct.unpack_from("<I4s", data, 20 + json_length)
    assert binary_kind == b"BIN\0" and 28 + json_length + binary_length == len(data)
    return json.loads(data[20 : 20 + json_length]), data[28 + json_length :]


def accessor(content: dict, binary: bytes, number: int) -> np.ndarray:
    one = content["accessors"][number]
    view = content["bufferViews"][one["bufferView"]]
    kind = {5126: np.float32, 5121: np.uint8, 5123: np.uint16, 5125: np.uint32}[one["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[one["type"]]
    stride = view.get("byteStride", width * np.dtype(kind).itemsize)
    start = view.get("byteOffset", 0) + one.get("byteOffset", 0)
    assert start + stride * (one["count"] - 1) + width * np.dtype(kind).itemsize <= len(binary)
    return np.ndarray((one["count"], width), kind, binary, start, (stride, np.dtype(kind).itemsize))


@pytest.fixture(scope="module")
def glbs(bake, game, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("glb")
    done = run(["bash", "demo_project/bake_export.sh", bake, "gltf", folder, "--project", game], timeout=120, cwd=REPO)
    assert done.returncode == 0 and "wrote 2640 instances in 11 tiles to" in done.stderr, done.stdout + done.stderr
    assert "pyramid" not in done.stderr
    return folder


def test_gltf_contains_every_instance(glbs, expected):
    """Checks that each tile has a node for each layer and model, with all instances. Positions must be exact to 0.01
    mm, rotations to 1e-6, and scales and colors bit for bit."""
    files = sorted(glbs.iterdir())
    assert len(files) == 11
    seen = 0
    for file in files:
        content, binary = parse(file)
        root = content["nodes"][content["scenes"][0]["nodes"][0]]
        assert file.name == "tile_{}_{}.glb".format(*root["extras"]["tile"])
        assert content["extensionsRequired"] == ["EXT_mesh_gpu_instancing"]
        for node in (content["nodes"][child] for child in root["children"]):
            rows = of_tile(expected, root["extras"]["tile"], node["extras"]["layer"], node["extras"]["model"])
            attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
            values = {name: accessor(content, binary, number) for name, number in attributes.items()}
            place = values["TRANSLATION"] + np.array(root["translation"])
            assert np.abs(place - np.stack([rows[axis] for axis in "xyz"], axis=1)).max() < 1e-5
            assert np.abs(values["ROTATION"] - np.stack([rows[f"q{axis}"] for axis in "xyzw"], axis=1)).max() < 1e-6
            assert np.array_equal(values["SCALE"], np.stack([rows[f"scale_{axis}"] for axis in "xyz"], axis=1))
            if node["extras"]["layer"] == 0:
                assert np.array_equal(values["_COLOR_0"], rows["color"].astype("<u4").view(np.uint8).reshape(-1, 4))
            else:
                assert "_COLOR_0" not in values
            seen += len(place)
    assert seen == len(expected["id"]) - int(((expected["layer"] == 2) & (expected["model"] == 1)).sum())


def test_gltf_contains_the_models(glbs):
    """Checks that the files contain the engine's meshes with their materials: the cylinder is 6 m high, and the rock
    consists of two boxes."""
    content, binary = parse(next(iter(sorted(glbs.iterdir()))))
    meshes = {node["name"]: content["meshes"][node["mesh"]] for node in content["nodes"] if "mesh" in node}

    def box(name: str) -> np.ndarray:
        (primitive,) = meshes[name]["primitives"]
        points = accessor(content, binary, primitive["attributes"]["POSITION"])
        indices = accessor(content, binary, primitive["indices"])
        assert indices.max() < len(points) and len(indices) % 3 == 0
        return np.stack([points.min(axis=0), points.max(axis=0)])

    assert box("Oak_0") == pytest.approx(np.array([[-0.5, -3, -0.5], [0.5, 3, 0.5]]), abs=1e-3)
    assert box("Oak_1") == pytest.approx(np.array([[-0.5, -0.5, -0.5], [0.5, 2.5, 0.5]]), abs=1e-3)
    assert box("Grass_0")[1][0] == pytest.approx(0.25, abs=1e-3)
    gray = content["materials"][meshes["Oak_1"]["primitives"][0]["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
    assert gray[0] > gray[1] and gray[0] == pytest.approx(gray[2])


def test_gltf_without_the_engine(copy, game, tmp_path):
    """Tests pyramids on request and as replacements for a missing model, selected tiles, a shifted origin, and a
    coarser level of detail."""
    chosen = ["--tiles=60001,-20001 60000,-20002", "--origin=3000000,0,-1000000"]
    assert reader("gltf", copy, tmp_path / "some", "--stand-ins", *chosen).returncode == 0
    assert sorted(file.name for file in (tmp_path / "some").iterdir()) == ["tile_60000_-20002.glb", "tile_60001_-20001.glb"]
    content, binary = parse(tmp_path / "some/tile_60000_-20002.glb")
    root = content["nodes"][0]
    assert root["translation"][0] == 25 and root["translation"][2] == -75
    oak = next(node for node in content["nodes"] if node["name"] == "Oak_0")
    points = accessor(content, binary, content["meshes"][oak["mesh"]]["primitives"][0]["attributes"]["POSITION"])
    assert points.min(axis=0).tolist() == [-1.5, 0, -1.5] and points.max(axis=0).tolist() == [1.5, 6, 1.5]
    assert "the bake has no tile 1,1" in refused("gltf", copy, tmp_path / "none", "--stand-ins", "--tiles=1,1")

    layers = manifest_of(copy)["layers"]
    layers[0]["models"][1] = {"path": "res://gone.tscn", "name": "rock"}
    edit_manifest(copy, layers=layers)
    done = reader("gltf", copy, tmp_path / "gone", "--project", game, "--tiles=60000,-20002", "--lod", "1")
    assert done.returncode == 0 and "res://gone.tscn is drawn as a pyramid: res://gone.tscn cannot be loaded" in done.stderr
    content, binary = parse(tmp_path / "gone/tile_60000_-20002.glb")
    counts = {}
    for node in content["nodes"][1:]:
        attributes = content["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        counts[node["name"]] = content["accessors"][attributes["POSITION"]]["count"]
    assert counts["Oak_0"] == 24 and counts["Oak_1"] == 18, "24 instances of the far box, and 18 of a pyramid"


@pytest.mark.full
def test_the_gltf_validator_finds_no_problem(glbs, bake, tmp_path):
    folders = sorted(CACHE.glob("gltf-validator-*/node_modules"))
    if not folders or shutil.which("node") is None:
        pytest.skip("no glTF validator: setup_gltf_validator in tools/setup_full.sh installs it")
    assert reader("gltf", bake, tmp_path, "--stand-ins", "--tiles=60000,-20002").returncode == 0
    script = "const v = require('gltf-validator'), fs = require('fs'); Promise.all(process.argv.slice(1).map(async f => " \
        "console.log(JSON.stringify((await v.validateBytes(new Uint8Array(fs.readFileSync(f)))).issues))))"  # fmt: skip
    files = [*sorted(glbs.iterdir()), *tmp_path.iterdir()]
    done = run(["node", "-e", script, *files], timeout=120, cwd=folders[-1].parent)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0 and len(found) == 12, done.stderr
    assert all(issues["numErrors"] == issues["numWarnings"] == 0 for issues in found), found[0]["messages"][:5]
    # Check that the validator can detect an error.
    broken = tmp_path / "broken.glb"
    broken.write_bytes(files[-1].read_bytes().replace(b'"POSITION"', b'"POSITIOM"'))
    done = run(["node", "-e", script, broken], timeout=60, cwd=folders[-1].parent)
    assert json.loads(done.stdout)["numErrors"] > 0
