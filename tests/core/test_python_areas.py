"""Tests the areas of the Python package: polygons, points that exist already, maps of densities, and areas divided into tiles."""

from __future__ import annotations

import itertools
import json
import math
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest
from scipy.spatial import cKDTree
from shapely.geometry import MultiPolygon, Point, Polygon, mapping

RECT = (-30.0, -20.0, 50.0, 60.0)


def same(one, other) -> bool:
    """Returns True if two sets contain the same points, in any order."""
    return len(one) == len(other) and one.digest() == other.digest()


def test_points_in_a_polygon(poissontiles):
    lake = Polygon([(-10, -10), (40, -5), (45, 50), (10, 20)], holes=[[(20, 10), (30, 10), (25, 20)]])
    all_points = poissontiles.sample(RECT, 1.0, 5, levels=3)
    lake_points = poissontiles.sample(RECT, 1.0, 5, levels=3, within=lake)
    expected = [lake.contains(Point(*position)) for position in all_points]
    assert same(lake_points, all_points[expected]) and 500 < len(lake_points) < len(all_points)
    # Without a rectangle, the polygon's own is used.
    assert same(poissontiles.sample(None, 1.0, 5, levels=3, within=lake), lake_points)
    assert len(poissontiles.sample(None, 1.0, 5, within=lake, n=100)) == 100


def test_kinds_of_polygons(poissontiles):
    one, other = Point(0, 0).buffer(9), Point(30, 0).buffer(6)
    union_points = poissontiles.sample(None, 1.0, within=MultiPolygon([one, other]))
    features = [{"type": "Feature", "properties": {}, "geometry": mapping(each)} for each in (one, other)]
    collection = json.loads(json.dumps({"type": "FeatureCollection", "features": features}))
    assert same(union_points, poissontiles.sample(None, 1.0, within=collection)) and len(union_points) > 150

    class Series:
        __geo_interface__ = collection

    assert same(union_points, poissontiles.sample(None, 1.0, within=Series()))
    assert same(poissontiles.sample(None, 1.0, within=features[0]), poissontiles.sample(None, 1.0, within=one))
    assert len(poissontiles.sample(None, 1.0, within=Polygon())) == 0


@pytest.mark.parametrize(
    ("within", "error", "message"),
    [
        (3, TypeError, "within must be a Shapely geometry, a GeoJSON dictionary, or have a __geo_interface__, got 3"),
        ({"kind": "Polygon"}, ValueError, "within must be valid GeoJSON: "),
        ({"type": "Polygon"}, ValueError, "within must be valid GeoJSON: "),
        (Point(0, 0), ValueError, "within must be a polygon or several, got a Point"),
        (Polygon([(0, 0), (9, 9), (9, 0), (0, 9)]), ValueError, "within must be a valid polygon: Self-intersection"),
    ],
)
def test_wrong_polygons_raise(poissontiles, within, error, message):
    with pytest.raises(error) as raised:
        poissontiles.sample(None, 1.0, within=within)
    assert str(raised.value).startswith(message)


def test_polygons_need_shapely(wheel_python):
    """The environment of `wheel_python` contains only the package and NumPy."""
    text = "import poissontiles; poissontiles.sample((0, 0, 9, 9), 1.0, within={'type': 'Polygon', 'coordinates': []})"
    result = subprocess.run([wheel_python, "-c", text], capture_output=True, text=True, timeout=60)
    assert "ImportError: within requires the package shapely: pip install 'poissontiles[areas]'" in result.stderr


def test_fixed_points_are_kept(poissontiles):
    """No new point is too close to a fixed one, and no gap remains between both."""
    random = np.random.default_rng(3)
    fixed = np.column_stack([random.uniform(-40, 60, (150, 2)), random.uniform(0.3, 4.0, 150)])
    points = poissontiles.sample(RECT, 1.0, 7, fixed=fixed)
    distances = np.linalg.norm(points.positions[:, None] - fixed[None, :, :2], axis=2)
    assert (distances >= fixed[:, 2]).all() and len(points) > 2000
    assert cKDTree(points.positions).query(points.positions, k=2)[0][:, 1].min() >= 1.0
    # Sampled places that keep the distances from all fixed points have a new point within the radius.
    wider = poissontiles.sample((-32, -22, 52, 62), 1.0, 7, fixed=fixed)
    places = random.uniform(RECT[:2], RECT[2:], (20000, 2))
    is_free = (np.linalg.norm(places[:, None] - fixed[None, :, :2], axis=2) >= fixed[:, 2]).all(axis=1)
    assert is_free.sum() > 10000 and cKDTree(wider.positions).query(places[is_free])[0].max() < 1.0
    # The set without fixed points loses more points than it has to.
    thinned = poissontiles.sample(RECT, 1.0, 7)
    thinned = thinned[(np.linalg.norm(thinned.positions[:, None] - fixed[None, :, :2], axis=2) >= fixed[:, 2]).all(axis=1)]
    assert len(points) > len(thinned)


def test_windows_around_fixed_points_fit_together(poissontiles):
    fixed = np.random.default_rng(4).uniform(-60, 90, (400, 2))
    full_sample = poissontiles.sample(RECT, 1.5, 8, fixed=fixed)
    parts = [poissontiles.sample((x, y, x + 20, y + 20), 1.5, 8, fixed=fixed) for x in range(-30, 50, 20) for y in range(-20, 60, 20)]
    assert np.array_equal(np.sort(full_sample.ids), np.sort(np.concatenate([part.ids for part in parts])))
    assert same(full_sample, poissontiles.sample(RECT, 1.5, 8, fixed=fixed[::-1], threads=2))
    # The default distance is the radius.
    assert same(full_sample, poissontiles.sample(RECT, 1.5, 8, fixed=np.column_stack([fixed, np.full(400, 1.5)])))
    assert same(poissontiles.sample(RECT, 1.5, 8, fixed=[]), poissontiles.sample(RECT, 1.5, 8))


@pytest.mark.parametrize(
    ("fixed", "error", "message"),
    [
        ([[0.0]], TypeError, "fixed must be an array of numbers of shape (n, 2) or (n, 3), got float64 of shape (1, 1)"),
        ([["a", "b"]], TypeError, "fixed must be an array of numbers of shape (n, 2) or (n, 3), got <U1"),
        ([[0, np.nan]], ValueError, "fixed must be finite, with radii of at least 0, got [ 0. nan  1.]"),
        ([[0, 0, -1]], ValueError, "fixed must be finite, with radii of at least 0, got [ 0.  0. -1.]"),
    ],
)
def test_wrong_fixed_points_raise(poissontiles, fixed, error, message):
    with pytest.raises(error) as raised:
        poissontiles.sample((0, 0, 9, 9), 1.0, fixed=fixed)
    assert str(raised.value).startswith(message)


@pytest.mark.parametrize(("period", "levels"), [(64.0, 1), ((96.0, 32.0), 3)])
def test_a_torus(poissontiles, period, levels):
    """The points keep their distance and leave no gap across the edges, and the set repeats."""
    radius = poissontiles.torus_radius(period, 1.0, levels)
    assert radius == pytest.approx(1.0, rel=0.2)
    size = np.broadcast_to(period, 2)
    torus = poissontiles.sample(None, radius, 11, levels=levels, period=period)
    assert len(torus) == pytest.approx(0.7 * size.prod() / radius**2, rel=0.1) and len(np.unique(torus.ids)) == len(torus)
    tree = cKDTree(torus.positions % size, boxsize=size)
    assert tree.query(torus.positions % size, k=2)[0][:, 1].min() >= radius * (1 - 1e-12)
    places = np.random.default_rng(5).uniform((0, 0), size, (50000, 2))
    assert tree.query(places)[0].max() < radius
    start = 0.37 * radius
    shifted = poissontiles.sample((start - size[0], start, start, start + size[1]), radius, 11, levels=levels, period=period)
    assert np.array_equal(np.sort(shifted.ids), np.sort(torus.ids))
    strip = poissontiles.sample((0, -200, 30, 200), 0.5 * 2**0.5, 3, period=(10.0, 0))
    single_column = poissontiles.sample((0, -200, 10, 200), 0.5 * 2**0.5, 3, period=(10.0, 0))
    assert len(single_column) == len(np.unique(single_column.ids)) == len(np.unique(strip.ids)) == len(strip) / 3


def test_a_domain_of_tiles(poissontiles):
    plain = poissontiles.sample_domain((50, 30), 1.0, 4, method="tiles")
    assert np.array_equal(plain, poissontiles.sample((0, 0, 50, 30), 1.0, 4).positions)
    radius = poissontiles.torus_radius(40, 1.0)
    torus = poissontiles.sample_domain((40, 40), radius, 4, method="tiles", toroidal=True)
    assert np.array_equal(torus, poissontiles.sample(None, radius, 4, period=40).positions)


@pytest.mark.parametrize(
    ("function", "wrong", "message"),
    [
        ("sample", {"period": 10.0}, "period must be a multiple of 3.535533906 for this radius, got 10.0. Use the radius that torus_radius() returns"),
        ("sample", {"period": (0.0, 0.0)}, "period must be positive, or 0 on one axis without an end, got (0.0, 0.0)"),
        ("sample", {"period": 7.0710678118654755, "fixed": [(0, 0)]}, "period cannot be combined with fixed"),
        ("sample_domain", {"method": "tiles", "precision": "single"}, "precision must be 'double' with the method 'tiles', got 'single'"),
        ("torus_radius", {"period": (1.0, math.pi)}, "period must have a width and height in a ratio of integers up to 1000, got (1.0, 3.14"),
    ],
)
def test_wrong_periods_raise(poissontiles, function, wrong, message):
    first = {"sample": {"rect": (0, 0, 9, 9)}, "sample_domain": {"size": (9, 9)}, "torus_radius": {}}[function]
    with pytest.raises(ValueError) as raised:
        getattr(poissontiles, function)(**first, radius=1.0, **wrong)
    assert str(raised.value).startswith(message)


def test_a_map_of_densities(poissontiles):
    """The first row of an image is at the largest y, and values lie at the centers of pixels."""
    image = np.array([[0, 255], [128, 255]], np.uint8)
    density = poissontiles.DensityMap(image, (0, 0, 4, 2))
    positions = np.array([[1.0, 1.5], [3.0, 0.5], [2.0, 1.5], [1.0, 1.0], [-9.0, 9.0], [9.0, 9.0]])
    assert density(positions) == pytest.approx([0, 1, 0.5, 64 / 255, 0, 1])
    nearest = poissontiles.DensityMap(image, (0, 0, 4, 2), interpolation="nearest", origin="lower")
    assert nearest(positions) == pytest.approx([128 / 255, 1, 1, 128 / 255, 128 / 255, 1])
    points = poissontiles.sample((0, 0, 400, 200), 1.0, levels=4)
    mask = poissontiles.DensityMap(np.array([[True, False]]), (0, 0, 400, 200), interpolation="nearest")
    assert same(points.thin(mask), points[points.positions[:, 0] < 200])
    assert np.array_equal(pickle.loads(pickle.dumps(density))(positions), density(positions))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (([[1.5]], (0, 0, 1, 1)), ValueError, "values must be between 0 and 1, got 1.5"),
        (([[1]], (0, 0, 1, 1)), TypeError, "values must be floats, unsigned integers or booleans of shape (rows, columns), got int64 of shape (1, 1)"),
        (([0.5], (0, 0, 1, 1)), TypeError, "values must be floats, unsigned integers or booleans of shape (rows, columns), got float64 of shape (1,)"),
        (([[0.5]], (0, 0, 0, 1)), ValueError, "rect must be finite and not empty, got (0, 0, 0, 1)"),
    ],
)
def test_wrong_maps_raise(poissontiles, arguments, error, message):
    with pytest.raises(error) as raised:
        poissontiles.DensityMap(*arguments)
    assert str(raised.value).startswith(message)


@pytest.mark.parametrize("threads", [1, 3])
def test_tiles_are_the_whole_set(poissontiles, threads):
    full_sample = poissontiles.sample(RECT, 1.0, 9, levels=2)
    parts = list(poissontiles.tiles(RECT, 32, 1.0, 9, levels=2, threads=threads))
    assert [rect for rect, _ in parts][:4] == [(-30, -20, 0, 0), (0, -20, 32, 0), (32, -20, 50, 0), (-30, 0, 0, 32)]
    assert len(parts) == 9 and all(len(points) for _, points in parts)
    assert np.array_equal(np.sort(full_sample.ids), np.sort(np.concatenate([points.ids for _, points in parts])))
    for rect, points in parts:
        assert (points.positions >= rect[:2]).all() and (points.positions < rect[2:]).all()
    assert len({points.seed for _, points in poissontiles.tiles(RECT, 32, 1.0, None)}) == 1


def test_tiles_are_generated_on_demand(poissontiles):
    """The area has 10^12 tiles. The first ones come quickly, and no thread remains after the last one that is read."""
    before = threading.active_count()
    reader = poissontiles.tiles((-1e6, -1e6, 1e6, 1e6), 2, 1.0, threads=2, within=Point(0, 0).buffer(2e6))
    assert len(list(itertools.islice(reader, 5))) == 5
    reader.close()
    assert threading.active_count() == before


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"size": 0}, "size must be positive, got 0"),
        ({"threads": 300}, "threads must be between 0 and 256, got 300"),
        ({"rect": (0, 0, float("inf"), 1)}, "rect must be finite, got (0, 0, inf, 1)"),
    ],
)
def test_wrong_tiles_raise_immediately(poissontiles, wrong, message):
    with pytest.raises(ValueError) as raised:
        poissontiles.tiles(**{"rect": RECT, "size": 8, "radius": 1.0, **wrong})
    assert str(raised.value) == message
