"""Tests the export of a bake to binary glTF with GPU instancing. Independent code parses the files, and the Khronos
validator checks them."""

from __future__ import annotations

import json
import shutil
import struct
import sys
from pathlib import Path

import numpy as np
import pytest
from bake.small import bake, copy, edit_manifest, expected, game, manifest_of, of_tile, reader, refused  # noqa: F401 (some are fixtures)
from conftest import CACHE, REPO, run

sys.path.insert(0, str(REPO / "tools/bake"))
from reading.glb import Glb  # noqa: E402 (only on the path above)


def parse(file: Path) -> tuple[dict, list[bytes]]:
    """Returns the JSON of a binary glTF file, and the data of its buffers: its own, and a separate file if it has one."""
    data = file.read_bytes()
    magic, version, length, json_length, json_kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, length, json_kind) == (b"glTF", 2, len(data), b"JSON")
    binary_length, binary_kind = struct.unpack_from("<I4s", data, 20 + json_length)
    assert binary_kind == b"BIN\0" and 28 + json_length + binary_length == len(data)
    content = json.loads(data[20 : 20 + json_length])
    buffers = [data[28 + json_length :], *((file.parent / buffer["uri"]).read_bytes() for buffer in content["buffers"][1:])]
    assert [len(buffer) for buffer in buffers] == [buffer["byteLength"] for buffer in content["buffers"]]
    return content, buffers


def accessor(content: dict, buffers: list[bytes], number: int) -> np.ndarray:
    one = content["accessors"][number]
    view = content["bufferViews"][one["bufferView"]]
    binary = buffers[view["buffer"]]
    kind = {5126: np.float32, 5121: np.uint8, 5123: np.uint16, 5125: np.uint32}[one["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[one["type"]]
    stride = view.get("byteStride", width * np.dtype(kind).itemsize)
    start = view.get("byteOffset", 0) + one.get("byteOffset", 0)
    assert start + stride * (one["count"] - 1) + width * np.dtype(kind).itemsize <= len(binary)
    return np.ndarray((one["count"], width), kind, binary, start, (stride, np.dtype(kind).itemsize))


@pytest.fixture(scope="module")
def glbs(bake, game, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("glb")
    completed = run(["bash", "demo_project/bake_export.sh", bake, "gltf", folder, "--project", game], timeout=120, cwd=REPO)
    assert completed.returncode == 0 and "wrote 2640 instances in 11 tiles to" in completed.stderr, completed.stdout + completed.stderr
    assert "pyramid" not in completed.stderr
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
    completed = reader("gltf", copy, tmp_path / "gone", "--project", game, "--tiles=60000,-20002", "--lod", "1")
    assert completed.returncode == 0 and "res://gone.tscn is drawn as a pyramid: res://gone.tscn cannot be loaded" in completed.stderr
    content, binary = parse(tmp_path / "gone/tile_60000_-20002.glb")
    counts = {}
    for node in content["nodes"][1:]:
        attributes = content["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        counts[node["name"]] = content["accessors"][attributes["POSITION"]]["count"]
    assert counts["Oak_0"] == 24 and counts["Oak_1"] == 18, "24 instances of the far box, and 18 of a pyramid"


def test_shared_models_are_stored_once(bake, game, glbs, tmp_path):
    """Checks that --share-models moves the meshes of all files into one, and that the files describe the same meshes."""
    assert reader("gltf", bake, tmp_path, "--project", game, "--share-models").returncode == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["models.bin", *sorted(file.name for file in glbs.iterdir())]
    for file in glbs.iterdir():
        (content, binary), (other, shared) = parse(file), parse(tmp_path / file.name)
        assert content["nodes"] == other["nodes"] and content["meshes"] == other["meshes"]
        assert all(np.array_equal(accessor(content, binary, number), accessor(other, shared, number)) for number in range(len(content["accessors"])))
        assert len(shared[0]) < len(binary[0]) and {other["bufferViews"][one["bufferView"]]["buffer"] for one in other["accessors"]} == {0, 1}


def test_models_with_the_same_image_store_it_once():
    """Checks that the images of a file have different content, and that textures and vertices still refer to the right
    data."""
    image, other = bytes(range(200)), bytes(range(55, 255))

    def textured(content: bytes, height: float) -> tuple[dict, bytes]:
        glb = Glb("test")
        glb.add_pyramid("x", 1.0, height, (1.0, 1.0, 1.0))
        glb.add_accessor(np.frombuffer(content, np.uint8))
        glb.json |= {"images": [{"bufferView": len(glb.json["bufferViews"]) - 1}], "textures": [{"source": 0}]}
        return glb.content()

    glb = Glb("test")
    for content, height in ((image, 1.0), (other, 2.0), (image, 3.0)):
        glb.add_meshes(*textured(content, height))
    whole, binary = glb.content()
    views = [whole["bufferViews"][whole["images"][texture["source"]]["bufferView"]] for texture in whole["textures"]]
    assert [binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] for view in views] == [image, other, image]
    assert len(whole["images"]) == 2
    tops = [accessor(whole, [binary], mesh["primitives"][0]["attributes"]["POSITION"])[:, 1].max() for mesh in whole["meshes"]]
    assert tops == [1.0, 2.0, 3.0]


def test_a_tileset_describes_all_tiles(bake, glbs, tmp_path):
    """Checks that the leaves of the tileset are the files, that boxes contain all instances and child boxes, and that
    errors decrease toward the leaves."""
    origin = np.array([3_000_000.0, 900.0, -1_000_000.0])
    assert reader("gltf", bake, tmp_path, "--stand-ins", "--tileset", f"--origin={','.join(map(str, origin))}").returncode == 0
    tileset = json.loads((tmp_path / "tileset.json").read_text())
    assert tileset["asset"]["version"] == "1.1" and tileset["geometricError"] > tileset["root"]["geometricError"] and tileset["root"]["refine"] == "ADD"
    files = []

    def box_of(node: dict) -> np.ndarray:
        box = np.array(node["boundingVolume"]["box"])
        assert np.flatnonzero(box[3:]).tolist() == [0, 4, 8], "the axes of the box"
        return np.stack([box[:3] - box[[3, 7, 11]], box[:3] + box[[3, 7, 11]]])

    def visit(node: dict) -> None:
        outer = box_of(node)
        assert ("content" in node) != ("children" in node) and (node["geometricError"] == 0) == ("content" in node)
        for child in node.get("children", []):
            inner = box_of(child)
            assert (inner[0] >= outer[0] - 1e-6).all() and (inner[1] <= outer[1] + 1e-6).all() and child["geometricError"] < node["geometricError"]
            visit(child)
        if "content" in node:
            files.append(node["content"]["uri"])
            content, binary = parse(tmp_path / files[-1])
            for child in (content["nodes"][number] for number in content["nodes"][0]["children"]):
                places = accessor(content, binary, child["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"]) + content["nodes"][0]["translation"]
                turned = np.stack([places[:, 0], -places[:, 2], places[:, 1]], axis=1)
                assert (turned > outer[0]).all() and (turned < outer[1]).all()

    visit(tileset["root"])
    assert sorted(files) == sorted(file.name for file in glbs.iterdir())


@pytest.mark.full
def test_the_gltf_validator_finds_no_problem(glbs, bake, tmp_path):
    folders = sorted(CACHE.glob("gltf-validator-*/node_modules"))
    if not folders or shutil.which("node") is None:
        pytest.skip("no glTF validator: setup_gltf_validator in tools/setup_full.sh installs it")
    assert reader("gltf", bake, tmp_path, "--stand-ins", "--tiles=60000,-20002").returncode == 0
    assert reader("gltf", bake, tmp_path / "shared", "--stand-ins", "--share-models", "--tiles=60000,-20002").returncode == 0
    script = "const v = require('gltf-validator'), fs = require('fs'), p = require('path'), read = f => new Uint8Array(fs.readFileSync(f));" \
        "Promise.all(process.argv.slice(1).map(async f => console.log(JSON.stringify((await v.validateBytes(read(f), " \
        "{externalResourceFunction: async uri => read(p.join(p.dirname(f), uri))})).issues))))"  # fmt: skip
    files = [*sorted(glbs.iterdir()), *sorted(tmp_path.rglob("*.glb"))]
    completed = run(["node", "-e", script, *files], timeout=120, cwd=folders[-1].parent)
    found = [json.loads(line) for line in completed.stdout.splitlines()]
    assert completed.returncode == 0 and len(found) == 13, completed.stderr
    assert all(issues["numErrors"] == issues["numWarnings"] == 0 for issues in found), found[0]["messages"][:5]
    # Check that the validator can detect an error.
    broken = tmp_path / "broken.glb"
    broken.write_bytes(files[-1].read_bytes().replace(b'"POSITION"', b'"POSITIOM"'))
    completed = run(["node", "-e", script, broken], timeout=60, cwd=folders[-1].parent)
    assert json.loads(completed.stdout)["numErrors"] > 0
