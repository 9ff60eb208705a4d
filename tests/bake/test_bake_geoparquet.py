"""Tests the export of a bake to GeoParquet. Independent code decodes the files, and geopandas reads them."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest
from bake.small import bake, copy, expected, game, manifest_of, reader, refused  # noqa: F401 (some are fixtures)
from conftest import CACHE, REPO, run
from scipy.spatial.transform import Rotation

ORIGIN = np.array([-2_500_000.0, 6_000_000.0, 100.0])
# Converts x, y (up), z (south) to x (east), y (north), z (up).
TO_MAP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


@pytest.fixture(scope="module")
def exported(bake, tmp_path_factory) -> Path:
    """Returns the folder of an export with a coordinate reference system, written with the documented command."""
    folder = tmp_path_factory.mktemp("geoparquet")
    options = ["--crs", "EPSG:32632", "--origin", ",".join(map(str, ORIGIN))]
    completed = run(["bash", "demo_project/bake_export.sh", bake, "geoparquet", folder, *options], timeout=300, cwd=REPO)
    assert completed.returncode == 0 and "wrote 2640 instances in 11 tiles to" in completed.stderr, completed.stdout + completed.stderr
    return folder


@pytest.fixture(scope="module")
def wkb(bake, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wkb")
    assert reader("geoparquet", bake, folder, "--wkb").returncode == 0
    return folder


def places_of(rows: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([rows[axis] for axis in "xyz"], axis=1)


def test_every_instance_is_at_its_map_position(exported, expected):
    """Checks that all files together contain each instance once, with its layer's name, and that positions, rotations and
    scales are converted to map axes."""
    table = ds.dataset(exported).to_table()
    order, wanted_order = np.lexsort([table["id"].to_numpy(), table["layer"].to_numpy()]), np.lexsort([expected["id"], -expected["layer"].astype(int)])
    wanted = {name: values[wanted_order] for name, values in expected.items()}
    assert table["layer"].to_numpy()[order].tolist() == np.where(wanted["layer"] == 0, "Oak", "Grass").tolist()
    assert np.array_equal(table["id"].to_numpy()[order], wanted["id"])
    points = np.stack([table["geometry"].combine_chunks().field(axis).to_numpy() for axis in "xyz"], axis=1)[order]
    assert np.abs(points - (places_of(wanted) @ TO_MAP.T + ORIGIN)).max() < 1e-8
    turns = Rotation.from_quat(np.stack([table[f"q{axis}"].to_numpy() for axis in "xyzw"], axis=1)[order]).as_matrix()
    baked = Rotation.from_quat(np.stack([wanted[f"q{axis}"] for axis in "xyzw"], axis=1)).as_matrix()
    assert np.abs(turns - TO_MAP @ baked @ TO_MAP.T).max() < 1e-5
    assert np.array_equal(table["scale"].to_numpy()[order], wanted["scale_x"])
    assert table["scale_y"].null_count == table["scale_z"].null_count == len(table), "all scales are uniform"
    assert np.array_equal(table["rank"].to_numpy()[order], wanted["rank"])
    oak = wanted["layer"] == 0
    for name in ("color", "variation", "wind_phase"):
        column = table[name].take(order)
        assert np.array_equal(np.asarray(column.is_valid()), oak) and np.array_equal(column.drop_null().to_numpy(), wanted[name][oak])
    assert set(table["model"].to_pylist()) == {"oak", "rock", "tuft", "Grass_1"}


def test_files_describe_their_geometry(exported, wkb):
    """Checks the metadata that GeoParquet 1.1 requires, in both encodings."""
    for folder, encoding in ((exported, "point"), (wkb, "WKB")):
        for file in folder.iterdir():
            table = pq.read_table(file)
            geo = json.loads(table.schema.metadata[b"geo"])
            assert (geo["version"], geo["primary_column"], list(geo["columns"])) == ("1.1.0", "geometry", ["geometry"])
            about = geo["columns"]["geometry"]
            assert (about["encoding"], about["geometry_types"]) == (encoding, ["Point Z"])
            geometry = table["geometry"].combine_chunks()
            if encoding == "point":
                points = np.stack([geometry.field(axis).to_numpy() for axis in "xyz"], axis=1)
                assert about["crs"]["id"] == {"authority": "EPSG", "code": 32632} and about["crs"]["type"] == "ProjectedCRS"
            else:
                decoded = [struct.unpack("<BI3d", point) for point in geometry.to_pylist()]
                assert {point[:2] for point in decoded} == {(1, 1001)}
                points = np.array([point[2:] for point in decoded])
                assert about["crs"] is None, "positions without a reference system must not be taken for degrees"
                assert about["covering"] == {"bbox": {side: ["bbox", side] for side in ("xmin", "ymin", "xmax", "ymax")}}
                box = table["bbox"].combine_chunks()
                assert all(np.array_equal(box.field(side).to_numpy(), points[:, axis]) for side, axis in (("xmin", 0), ("xmax", 0), ("ymin", 1), ("ymax", 1)))
            assert about["bbox"] == [*points.min(axis=0), *points.max(axis=0)]
            assert json.loads(table.schema.metadata[b"thicket.layers"]) == {"0": {"name": "Oak", "radius": 6.0}, "2": {"name": "Grass", "radius": 1.0}}


def test_row_groups_cover_small_areas():
    """Checks that a reader that needs an eighth of a tile can skip most of its rows."""
    completed = run([CACHE / "bake-venv/bin/python", "-c", SPREAD], timeout=60, cwd=REPO / "tools/bake")
    assert completed.returncode == 0, completed.stderr
    read, rows = map(int, completed.stdout.split())
    assert rows == 500_000 and read < 0.4 * rows


SPREAD = """
import numpy as np, pyarrow as pa, pyarrow.parquet as pq
from reading import geoparquet
places = np.random.default_rng(1).uniform(0, 100, (500_000, 3))
columns = {name: pa.array(np.zeros(len(places), np.float32)) for name in ("qx", "qy", "qz", "qw", "scale", "variation", "wind_phase")}
columns |= {"layer": pa.array(["a"] * len(places)), "model": pa.array(["b"] * len(places))}
order = geoparquet._spatial_order(places)
file = pq.ParquetFile(pa.BufferReader(geoparquet._content(pa.table({**columns, **geoparquet._geometry(places[order], False)}))))
names = [file.metadata.row_group(0).column(column).path_in_schema for column in range(file.metadata.num_columns)]
read = 0
for number in range(file.metadata.num_row_groups):
    group = file.metadata.row_group(number)
    x, y = (group.column(names.index(f"geometry.{axis}")).statistics for axis in "xy")
    read += group.num_rows * (x.min < 25 and y.min < 50)
print(read, len(places))
"""


def test_stretched_instances_keep_their_scales(copy, tmp_path):
    """Checks an instance whose scales along x, y and z differ: the height is its scale along the map's z axis."""
    tile = manifest_of(copy)["tiles"]["60000,-20002"]
    table = pq.read_table(copy / tile["file"])
    height = table["scale_y"].to_numpy().copy()
    height[5] *= 2.0
    pq.write_table(table.set_column(table.schema.get_field_index("scale_y"), table.schema.field("scale_y"), [height]), copy / tile["file"])
    assert reader("geoparquet", copy, tmp_path, "--tiles=60000,-20002", "--no-verify").returncode == 0
    rows = pq.read_table(tmp_path / "tile_60000_-20002.parquet").to_pylist()
    stretched = [row for row in rows if row["scale_z"] is not None or row["scale_y"] is not None]
    assert [(row["id"], row["scale_z"], row["scale_y"]) for row in stretched] == [(table["id"][5].as_py(), height[5], None)]


def test_invalid_options_are_rejected(bake, tmp_path):
    for crs, says in (("EPSG:2263", "must be a projected coordinate reference system in meters"), ("nowhere", "must be a known")):
        assert says in refused("geoparquet", bake, tmp_path / "out", "--crs", crs)
    assert "is the bake itself: choose another folder" in refused("geoparquet", bake, bake / "tiles")
    assert not (tmp_path / "out").exists()


@pytest.mark.full
def test_geopandas_reads_the_files(exported, wkb, expected):
    python = CACHE / "bake-tests-venv/bin/python"
    if not python.exists():
        pytest.skip("no geopandas: setup_bake_tests in tools/setup_full.sh installs it")
    script = """
import json, sys, geopandas
for folder in sys.argv[1:]:
    world = geopandas.read_parquet(folder)
    x, y = world.geometry.x, world.geometry.y
    corner = (x.min(), y.min(), x.min() + 60.0, y.min() + 60.0)
    near = geopandas.read_parquet(folder, bbox=corner)
    print(json.dumps([len(world), world.crs and world.crs.to_epsg(), len(near), int(((x <= corner[2]) & (y <= corner[3])).sum()), world.geometry.has_z.all().item()]))
"""
    completed = run([python, "-c", script, exported, wkb], timeout=120)
    native, binary = map(json.loads, completed.stdout.splitlines())
    assert native[:2] == [len(expected["id"]), 32632] and binary[:2] == [len(expected["id"]), None], completed.stderr
    assert 0 < native[2] == native[3] == binary[2] == binary[3] < native[0] and native[4] and binary[4]
