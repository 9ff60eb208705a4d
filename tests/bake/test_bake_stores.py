"""Tests bakes at URLs: in object stores, and with the URL of a folder."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlunsplit

import pytest
from bake.small import PYTHON, TOOLS, bake, game, reader  # noqa: F401 (some are fixtures)
from bake.world import USUAL, environment, world  # noqa: F401 (some are fixtures)
from bake.world import bake as bake_world
from conftest import CACHE, run


def test_files_in_a_store_are_complete_and_checked(bake):
    """Checks the functions that read and write bakes with a store in memory: files are replaced, listed, removed, and
    rejected if they differ from the manifest."""
    completed = run([PYTHON, "-c", IN_MEMORY, bake], timeout=60, env={**os.environ, "PYTHONPATH": str(TOOLS)})
    assert completed.returncode == 0, completed.stdout + completed.stderr
    found = json.loads(completed.stdout)
    assert found["names"] == ["tile_1_2.parquet"] and found["rows"] == found["again"] == 240 and found["after"] == []
    assert found["read"] == 2640 and found["model"] == "memory://store/small/models/2_0.res"
    assert "tile 60000,-20002 is damaged or belongs to another bake" in found["damaged"]
    assert "the file of tile 60000,-20002 is outside of the bake" in found["outside"]
    assert found["empty"] == "memory://store/nothing is not a bake: it does not contain manifest.json"


IN_MEMORY = """
import json, sys
from pathlib import Path
import fsspec
from baking import files, rows
from baking.format import BakeError
from baking.location import location
from reading.bake import open_bake, read_tile
import pyarrow.parquet as pq

source, found = Path(sys.argv[1]), {}
out = location("memory://store/new")
marks = {"thicket.tile": "1,2"}
columns = rows.to_columns(pq.read_table(source / "tiles/tile_60000_-20002.parquet"))
marks["thicket.digest"] = rows.digest(columns)
path = files.tile_path(out, (1, 2))
with files.locked(out):
    files.sweep(out)
    sha256 = files.write_tile(path, columns, marks)
    assert files.write_tile(path, columns, marks) == sha256
    found["names"] = sorted(files.names_of_tiles(out))
    found["rows"] = len(files.read_tile(path, marks, {})[0]["id"])
    found["again"] = len(files.read_tile(path, marks, {"sha256": sha256})[0]["id"])
    assert files.read_tile(path, marks, {"sha256": "0" * 64}) is None and files.read_tile(out / "none", marks, {}) is None
    files.write_manifest(out, {"tiles": {}})
    files.sweep_strays(out, set())
    found["after"] = sorted(files.names_of_tiles(out))
    files.empty(out)
    assert not (out / "manifest.json").exists()

store = fsspec.filesystem("memory")
store.put(str(source), "/store/small", recursive=True)
small = open_bake("memory://store/small")
found["read"] = sum(len(read_tile(tile)) for tile in small.tiles)
found["model"] = str(small.model_file("models/2_0.res"))

def error_of(change):
    manifest = json.loads((source / "manifest.json").read_text())
    change(manifest["tiles"]["60000,-20002"])
    (location("memory://store/small") / "manifest.json").write_text(json.dumps(manifest))
    try:
        read_tile(open_bake("memory://store/small").tiles[0])
    except BakeError as error:
        return str(error)

found["damaged"] = error_of(lambda tile: tile.update(sha256="0" * 64))
found["outside"] = error_of(lambda tile: tile.update(file="../other/tile.parquet"))
try:
    open_bake("memory://store/nothing")
except BakeError as error:
    found["empty"] = str(error)
print(json.dumps(found))
"""


def test_a_file_url_names_a_folder(bake, tmp_path, monkeypatch):
    """Checks that an export accepts file:///... instead of a path."""
    monkeypatch.chdir(tmp_path)
    assert reader("maps", bake.as_uri(), (tmp_path / "maps").as_uri()).returncode == 0
    assert (tmp_path / "maps/maps.json").is_file() and [path.name for path in tmp_path.iterdir()] == ["maps"]


@pytest.mark.full
def test_a_bake_at_a_file_url_is_in_that_folder(world, tmp_path):
    completed = run([PYTHON, "-m", "baking", world / "world.tscn", (tmp_path / "out").as_uri(), *USUAL, "--workers", "1", "--tiles", "0,0"], 120, env=environment())
    assert completed.returncode == 0 and (tmp_path / "out/tiles/tile_0_0.parquet").is_file(), completed.stdout + completed.stderr


@pytest.fixture
def store(monkeypatch) -> Iterator[None]:
    """Starts a local server with the interface of Amazon S3 and creates a bucket."""
    python = CACHE / "bake-tests-venv/bin/python"
    if not python.exists():
        pytest.skip("no moto: setup_bake_tests in tools/setup_full.sh installs it")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    for name, value in {
        "AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "test", "AWS_DEFAULT_REGION": "us-east-1", "AWS_ENDPOINT_URL": urlunsplit(("http", f"127.0.0.1:{port}", "", "", "")),
    }.items():  # fmt: skip
        monkeypatch.setenv(name, value)
    server = subprocess.Popen([python, "-m", "moto.server", "-p", str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + 60.0
        while socket.socket().connect_ex(("127.0.0.1", port)) != 0:
            assert time.monotonic() < deadline and server.poll() is None, "the server does not start"
            time.sleep(0.1)
        assert run([PYTHON, "-c", "import s3fs; s3fs.S3FileSystem().mkdir('worlds')"], timeout=60).returncode == 0
        yield
    finally:
        server.terminate()
        server.wait()


@pytest.mark.full
def test_a_bake_in_a_store_equals_a_bake_in_a_folder(world, store, tmp_path):
    """Checks that a bake in an object store has the same files, can be continued and exported, and that a missing bucket
    results in a message."""
    local = bake_world(world, tmp_path / "local", "--workers", "2")

    def bake_to(url: str, *options: str) -> subprocess.CompletedProcess[str]:
        return run([PYTHON, "-m", "baking", world / "world.tscn", url, *USUAL, "--workers", "2", *options], 180, env=environment())

    some = bake_to("s3://worlds/test", "--tiles", "-1,0 0,0")
    assert some.returncode == 0 and "2 of them generated" in some.stdout, some.stdout + some.stderr
    whole = bake_to("s3://worlds/test")
    assert whole.returncode == 0 and "18 of them generated" in whole.stdout and local.manifest["digest"] in whole.stdout, whole.stdout + whole.stderr
    script = "import s3fs, sys; s3fs.S3FileSystem().get('worlds/test/', sys.argv[1], recursive=True)"
    assert run([PYTHON, "-c", script, f"{tmp_path / 'copy'}/"], timeout=60).returncode == 0
    for entry in local.manifest["tiles"].values():
        assert (tmp_path / "copy" / entry["file"]).read_bytes() == (local.out / entry["file"]).read_bytes()
    assert {path.name for path in (tmp_path / "copy").iterdir()} == {"manifest.json", "map.png", "report.md", "models", "tiles"}
    assert run([PYTHON, "-m", "reading", "s3://worlds/test", "maps", tmp_path / "maps"], 60, env=environment()).returncode == 0
    for folder in ("s3://worlds/test", local.out):
        assert run([PYTHON, "-m", "reading", folder, "gltf", tmp_path / Path(str(folder)).name, "--project", world], 60, env=environment()).returncode == 0
    assert [file.read_bytes() for file in sorted((tmp_path / "test").iterdir())] == [file.read_bytes() for file in sorted((tmp_path / "local").glob("*.glb"))]
    missing = bake_to("s3://nothing/test")
    assert missing.returncode == 2 and "Cannot access s3://nothing/test: The specified bucket does not exist." in missing.stderr, missing.stderr
    assert "Traceback" not in missing.stderr
