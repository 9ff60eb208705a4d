"""Tests the demo's elevation data: its source, and the ground that is drawn from it."""

from __future__ import annotations

import importlib.util
import json
import re
import struct

import numpy as np
import pytest
from conftest import REPO

TERRAIN = REPO / "demo_project/terrain"


def load_script(name: str):
    """Loads a script from the terrain folder as a module."""
    spec = importlib.util.spec_from_file_location(name, TERRAIN / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_heightmap_comes_from_the_elevation_model():
    pytest.importorskip("matplotlib")
    converter = load_script("convert_dem")
    samples, description = converter.convert(converter.find_source())
    assert (TERRAIN / "jacksboro.r16").read_bytes() == samples
    assert json.loads((TERRAIN / "jacksboro.json").read_text()) == description


def test_heightmap_contains_the_exact_elevations():
    pytest.importorskip("matplotlib")
    converter = load_script("convert_dem")
    with np.load(converter.find_source()) as dem:
        elevation = dem["elevation"].astype(np.float64)
    description = json.loads((TERRAIN / "jacksboro.json").read_text())
    samples = np.fromfile(TERRAIN / "jacksboro.r16", "<u2").reshape(description["rows"], description["columns"])
    low, high = description["min_height"], description["max_height"]
    assert np.array_equal(low + samples * ((high - low) / 65535.0), elevation)
    assert (elevation.min(), elevation.max()) == (236.0, 1076.0)


def test_heightmap_has_the_true_scale():
    """Compares the sample distances with 3 arc-seconds on the ellipsoid, from the usual series for the length of a degree."""
    description = json.loads((TERRAIN / "jacksboro.json").read_text())
    latitude = np.radians((36.73291666666667 + 36.44625) / 2.0)
    degree_z = 111132.92 - 559.82 * np.cos(2 * latitude) + 1.175 * np.cos(4 * latitude)
    degree_x = 111412.84 * np.cos(latitude) - 93.5 * np.cos(3 * latitude)
    assert description["post_meters_x"] == pytest.approx(degree_x / 1200.0, rel=1e-4)
    assert description["post_meters_z"] == pytest.approx(degree_z / 1200.0, rel=1e-4)
    for axis, posts in (("x", 403), ("z", 344)):
        size = description[f"size_{axis}"]
        assert size == description[f"post_meters_{axis}"] * (posts - 1)
        # Half the size must be exact in the engine's single precision.
        assert struct.unpack("f", struct.pack("f", size / 2.0))[0] == size / 2.0


def test_converter_rejects_a_model_that_does_not_fit(tmp_path):
    converter = load_script("convert_dem")
    corners = {"xmin": -84.0, "xmax": -83.9, "ymin": 36.7, "ymax": 36.4, "dx": 1 / 1200, "dy": 1 / 1200}
    np.savez(tmp_path / "tall.npz", elevation=np.array([[0, 2000]], np.int16), **corners)
    with pytest.raises(ValueError, match="do not fit 16 bits"):
        converter.convert(tmp_path / "tall.npz")
    np.savez(tmp_path / "turned.npz", elevation=np.zeros((2, 2), np.int16), **{**corners, "ymin": 36.4, "ymax": 36.7})
    with pytest.raises(ValueError, match="northern"):
        converter.convert(tmp_path / "turned.npz")


def test_drawn_ground_is_close_to_the_bilinear_surface():
    """Near the camera, terrain_view.gd draws 16 quads between two height samples. Their triangles deviate from the bilinear
    surface by less than 5 cm anywhere on the map, and by at most 2 cm on 97 % of it."""
    quads = int(re.search(r"^const QUADS := (\d+)$", (TERRAIN / "terrain_view.gd").read_text(), re.MULTILINE).group(1))
    description = json.loads((TERRAIN / "jacksboro.json").read_text())
    heights = np.fromfile(TERRAIN / "jacksboro.r16", "<u2").reshape(description["rows"], description["columns"]) / 64.0
    twist = np.abs(heights[:-1, :-1] - heights[:-1, 1:] - heights[1:, :-1] + heights[1:, 1:])
    deviation = twist / (4.0 * quads**2)
    assert deviation.max() < 0.05
    assert (deviation > 0.02).mean() < 0.03
