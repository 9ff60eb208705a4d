"""Tests the density maps of a bake: a grayscale image for each layer, from which the instance counts can be
computed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from bake.small import PYTHON, TOOLS, bake, copy, edit_manifest, expected, game, manifest_of, reader, refused  # noqa: F401 (some are fixtures)
from conftest import REPO, run
from PIL import Image


def map_of(folder: Path, name: str) -> tuple[np.ndarray, dict]:
    about = json.loads((folder / "maps.json").read_text())
    (entry,) = [entry for entry in about["maps"] if entry["name"] == name]
    with Image.open(folder / entry["file"]) as image:
        return np.asarray(image).astype(np.int64), {**about, **entry}


def counted(rows: dict[str, np.ndarray], layer: int, meters: float, width: int, height: int) -> np.ndarray:
    """Returns the number of a layer's instances in each pixel. Instances beyond the border belong to the pixels at the
    border."""
    here = rows["layer"] == layer
    columns = ((rows["x"][here] - 3_000_010) // meters).clip(0, width - 1).astype(int)
    lines = ((rows["z"][here] + 1_000_100) // meters).clip(0, height - 1).astype(int)
    counts = np.zeros((height, width), np.int64)
    np.add.at(counts, (lines, columns), 1)
    return counts


@pytest.mark.parametrize(("meters", "memory", "size"), [(None, "256", (180, 130)), (7.3, "0.005", (25, 18)), (200.0, "256", (1, 1)), (0.5, "0.05", (360, 260))])
def test_maps_count_every_instance(bake, expected, tmp_path, meters, memory, size):
    """Checks that the counts can be computed for any pixel size, whether the map is created as a whole or in bands of a
    few rows."""
    options = [] if meters is None else ["--meters", str(meters)]
    completed = reader("maps", bake, tmp_path / "maps", *options, "--memory", memory)
    assert completed.returncode == 0, completed.stderr
    assert (meters is None or memory == "256") == (completed.stderr.count("%") == 1), completed.stderr
    width, height = size
    for layer, name in ((0, "Oak"), (2, "Grass")):
        gray, about = map_of(tmp_path / "maps", name)
        want = counted(expected, layer, meters or 1.0, width, height)
        assert gray.shape == (height, width) and about["meters_a_pixel"] == (meters or 1.0)
        one = about["gray_of_one"]
        assert one == int(one) >= 1
        assert np.array_equal(gray, np.minimum(want * one, 65535))
        assert about["instances"] == want.sum() and about["pixels_beyond_white"] == (want * one > 65535).sum()
        assert about["pixels_beyond_white"] == 0 or f"{about['file']}: " in completed.stderr
    assert not list((tmp_path / "maps").glob(".*.part"))


def test_maps_of_8_bits(bake, expected, tmp_path):
    """Tests 8-bit maps with 20 m per pixel. One instance of a dense layer changes a pixel by less than one gray
    value."""
    assert run(["bash", "demo_project/bake_export.sh", bake, "maps", tmp_path, "--meters", "20", "--bits", "8"], timeout=60, cwd=REPO).returncode == 0
    gray, about = map_of(tmp_path, "Grass")
    want = counted(expected, 2, 20.0, 9, 7)
    assert about["bits"] == 8 and 0 < about["gray_of_one"] < 1
    assert np.array_equal(gray, np.rint(want * about["gray_of_one"]))
    assert gray.max() < 255


def test_memory_for_maps_is_bounded(bake, tmp_path):
    """Checks that a map with a hundred million pixels, which would need 600 MB as a whole, takes less than an eighth of
    that memory. The memory of Python and Arrow is not included."""
    script = (
        "import resource, sys; from pathlib import Path; from reading import bake, maps; "
        "world = bake.open_bake(sys.argv[1]); base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss; "
        "maps.write_maps(world, Path(sys.argv[2]), 0.0216, 8, 32_000_000, lambda share: None); "
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base)"
    )
    completed = run([PYTHON, "-c", script, bake, tmp_path], timeout=60, cwd=TOOLS)
    assert completed.returncode == 0, completed.stderr
    assert int(completed.stdout) < 75_000, "kilobytes"
    assert json.loads((tmp_path / "maps.json").read_text())["width"] > 8_000


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--meters", "0"], "--meters must be above 0 m, got 0.0"),
        (["--meters", "nan"], "--meters must be above 0 m, got nan"),
        (["--meters", "1e-9"], "but the width and height of a PNG must be at most"),
        (["--memory", "0.001"], "MB or more for a row of 180 pixels in 2 layers, got 0.001 MB"),
        (["--memory", "-1"], "--memory must be above 0 MB, got -1.0"),
    ],
)
def test_invalid_options_of_maps_are_rejected(bake, tmp_path, options, says):
    assert says in refused("maps", bake, tmp_path, *options)


def test_a_layer_that_is_not_in_the_manifest_is_rejected(copy, tmp_path):
    edit_manifest(copy, layers=manifest_of(copy)["layers"][1:])
    for name, options in (("maps", []), ("gltf", ["--stand-ins"])):
        assert "has instances of layer 0" in refused(name, copy, tmp_path / name, *options)
