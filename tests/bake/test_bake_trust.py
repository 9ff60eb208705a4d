"""Tests damaged and untrusted bakes. Each changed bit of a tile must be detected, and any invalid manifest must result in an
error message."""

from __future__ import annotations

import copy
import json
import os
import random
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from bake import make_bake
from conftest import REPO

sys.path.insert(0, str(REPO / "tools/bake"))
from baking import driver, files, report, rows, schedule, tile, tile_folder  # noqa: E402 (only on the path above)
from baking.format import MANIFEST, BakeError  # noqa: E402
from baking.tile_engine import Source  # noqa: E402
from reading import verify  # noqa: E402
from reading.__main__ import main  # noqa: E402
from reading.bake import groups_of, open_bake, read_tile  # noqa: E402

TILE = "60000,-20002"
DEEP: list = []
for _ in range(60):
    DEEP = [DEEP]
HOSTILE = [
    None, True, "", "x", "\0", "\ud800", "x" * 5000, "../../x", "res://x", 0, -1, 1, 2, 0.5, 1e-300, -1e300, 1e300, 2**31, 2**64, -(2**63), 10**400,
    float("nan"), float("inf"), -float("inf"), [], {}, [1], [None], {"x": 1}, [[[]]], [1, 2, 3, 4], [0, 0, 0, 0, 0, 0], [float("nan")] * 4, DEEP,
]  # fmt: skip


@pytest.fixture(scope="module")
def tiny(tmp_path_factory) -> Path:
    """Returns a bake of one tile with few instances and with recorded costs."""
    folder = tmp_path_factory.mktemp("tiny") / "bake"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(make_bake, "COLUMNS", 1)
        patch.setattr(make_bake, "ROWS", 1)
        patch.setattr(make_bake, "RECT", [3_000_000.0, -1_000_100.0, 50.0, 50.0])
        patch.setattr(make_bake, "PER_TILE", {0: 4, 2: 8})
        patch.setattr(sys, "argv", ["make_bake.py", str(folder)])
        make_bake.main()
    manifest = json.loads((folder / MANIFEST).read_text())
    manifest["costs"] = {"start_seconds": 1.0, "driver_seconds": 0.01, "bytes": 1000}
    manifest["scene_parts"] = {"the seed": "1"}
    manifest["digest"] = driver.world_digest(manifest["tiles"])
    manifest["tiles"][TILE] |= {"seconds": 1.0, "core_seconds": 1.0, "sheared": 0}
    (folder / MANIFEST).write_text(json.dumps(manifest))
    return folder


@pytest.fixture
def bake(tiny, tmp_path) -> Path:
    """Returns a copy of the tiny bake, for tests that damage it."""
    return Path(shutil.copytree(tiny, tmp_path / "bake"))


# Tiles


def flips(content: bytes, count: int) -> Iterator[bytes]:
    chance = random.Random(1)
    for _ in range(count):
        changed = bytearray(content)
        changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
        yield bytes(changed)


def read(folder: Path, **options: bool):
    bake = open_bake(folder, **options)
    instances = read_tile(bake.tiles[0])
    list(groups_of(bake, bake.tiles[0], instances))
    return instances


def test_each_changed_bit_of_a_tile_is_detected(bake):
    """Checks that the error names the tile, the file, the expected digest and the option that bakes the tile again."""
    read(bake)
    file = bake / "tiles/tile_60000_-20002.parquet"
    wanted = json.loads((bake / MANIFEST).read_text())["tiles"][TILE]["sha256"]
    for changed in flips(file.read_bytes(), 400):
        file.write_bytes(changed)
        with pytest.raises(BakeError) as refused:
            read(bake)
        output = str(refused.value)
        assert f"tile {TILE} is damaged" in output and str(file) in output and wanted in output and f"--tiles {TILE}" in output and "--no-verify" in output


def test_in_older_bakes_no_undetected_change_affects_an_instance(bake):
    """Checks that changes in older bakes are detected if they affect an instance. Manifests of these bakes contain only
    the digests of rows."""
    manifest = json.loads((bake / MANIFEST).read_text())
    del manifest["tiles"][TILE]["sha256"]
    (bake / MANIFEST).write_text(json.dumps(manifest))
    good = read(bake)
    file = bake / "tiles/tile_60000_-20002.parquet"
    detected = 0
    for changed in flips(file.read_bytes(), 400):
        file.write_bytes(changed)
        try:
            found = read(bake)
        except BakeError:
            detected += 1
            continue
        assert all(np.array_equal(getattr(good, name), getattr(found, name)) for name in good.__dataclass_fields__)
    assert detected > 200


def test_every_reader_verifies_by_default(bake, tmp_path, capsys):
    """Checks that a valid file with the right number of rows, but with other rows, is accepted only with --no-verify."""
    file = bake / "tiles/tile_60000_-20002.parquet"
    columns = rows.to_columns(files.pq.read_table(file).replace_schema_metadata(None))
    columns["x"] = columns["x"] + 1.0
    files.write_tile(file, columns, {})
    (tmp_path / "game/addons").mkdir(parents=True)
    (tmp_path / "game/project.godot").write_text("config_version=5\n")
    shutil.copytree(REPO / "demo_project/addons/thicket", tmp_path / "game/addons/thicket", ignore=shutil.ignore_patterns("bin", "*.gdextension*"))
    for name in ("oak.tres", "far.tres"):
        (tmp_path / "game" / name).write_text('[gd_resource type="BoxMesh" format=3]\n[resource]\n')
    for writer, options in (("maps", []), ("gltf", ["--stand-ins"]), ("godot", [])):
        folder = tmp_path / "game" / writer
        if writer == "godot":
            edit_layers(bake)
        assert main([str(bake), writer, str(folder), *options]) == 1
        assert f"tile {TILE} is damaged or belongs to another bake" in capsys.readouterr().err, writer
        assert main([str(bake), writer, str(folder), *options, "--no-verify"]) == 0, capsys.readouterr().err
    assert read(bake, verify=False) is not None


def edit_layers(bake: Path) -> None:
    """Replaces all models in the manifest with a mesh that exists in the project."""
    manifest = json.loads((bake / MANIFEST).read_text())
    for layer in manifest["layers"]:
        layer["models"] = [{"path": "res://oak.tres", "name": "oak"} for _ in layer["models"]]
    (bake / MANIFEST).write_text(json.dumps(manifest))


def test_a_file_is_verified_once_until_it_changes(bake, monkeypatch):
    """Checks that a file is verified again only if its time or size changes. The result for a recently written file is not
    remembered, because the file could change again within the same clock tick."""
    file = bake / "tiles/tile_60000_-20002.parquet"
    hashed = []
    digest_of = verify._bytes_digest
    monkeypatch.setattr(verify, "_bytes_digest", lambda path: hashed.append(path) or digest_of(path))
    read(bake)
    read(bake)
    assert len(hashed) == 2, "the file is new"
    monkeypatch.setattr(verify, "_SETTLED_NANOSECONDS", -(10**18))
    read(bake)
    read(bake)
    assert len(hashed) == 3
    content = bytearray(file.read_bytes())
    content[100] ^= 1
    file.write_bytes(content)
    os.utime(file, ns=(0, file.stat().st_mtime_ns + 1))
    with pytest.raises(BakeError, match="is damaged"):
        read(bake)


def test_a_continued_bake_only_keeps_files_that_match_the_manifest(bake):
    """Checks that a valid file is kept only if its rows and its bytes match the manifest."""
    file = bake / "tiles/tile_60000_-20002.parquet"
    columns = rows.to_columns(files.pq.read_table(file).replace_schema_metadata(None))
    marks = {"thicket.digest": rows.digest(columns)}
    sha256 = files.write_tile(file, columns, marks)
    entry = {"digest": marks["thicket.digest"], "sha256": sha256}
    for known in ({}, {"digest": entry["digest"]}, entry):
        assert files.read_tile(file, marks, known) is not None
    assert files.read_tile(file, marks, {**entry, "digest": "0" * 64}) is None
    assert files.read_tile(file, marks, {**entry, "sha256": "0" * 64}) is None


# Manifests


def paths_in(value: object, path: tuple = ()) -> Iterator[tuple]:
    """Yields the path to each value of a JSON tree."""
    if path:
        yield path
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from paths_in(inner, (*path, key))


def replaced(manifest: dict) -> Iterator[str]:
    """Yields variants of the manifest in which a value is removed, wrapped in a list, or replaced by one of HOSTILE. In
    some variants, the tile has another key instead."""
    for path in paths_in(manifest):
        for value in (*HOSTILE, "remove", "wrap", *(["rename"] if path[-1] == TILE else [])):
            changed = copy.deepcopy(manifest)
            inner = changed
            for key in path[:-1]:
                inner = inner[key]
            if value == "remove":
                del inner[path[-1]]
            elif value == "wrap":
                inner[path[-1]] = [inner[path[-1]]]
            elif value == "rename":
                for name in ("", "0", "0,0,0", "0, 0", "x,y", "1e3,0", "00,0", "99999999999,0", "\0", "9" * 5000 + ",0"):
                    yield json.dumps({**manifest, "tiles": {name: manifest["tiles"][TILE]}})
                continue
            else:
                inner[path[-1]] = value
            yield json.dumps(changed)


def spoiled(text: str) -> Iterator[bytes]:
    """Yields variants of the text: truncated, with bytes that are not UTF-8, with changed characters, deeply nested,
    with repeated fields, with huge numbers, and in other encodings."""
    chance = random.Random(2)
    content = text.encode()
    for at in range(0, len(content), 17):
        yield content[:at]
        yield content[:at] + bytes([0xFF]) + content[at:]
        yield content[:at] + bytes([chance.randrange(256)]) + content[at + 1 :]
    for opening in ("[", '{"a":'):
        yield (opening * 100_000).encode()
        yield text.replace('"models": [', f'"models": {opening * 100_000}', 1).encode()
    for name in ('"rect"', '"rows"', '"radius"', '"path"', f'"{TILE}"'):
        yield text.replace(name, f"{name}: null, {name}", 1).encode()
    yield text.replace('"seed": 7', f'"seed": {"7" * 10_000}').encode()
    yield text.replace('"rows": 12', f'"rows": {"7" * 10_000}').encode()
    yield text.encode("utf-16")
    yield b"\xef\xbb\xbf" + content


def said_of(bake: Path, out: Path, capsys) -> list[tuple[int, str]]:
    """Runs each command that reads the manifest. Returns its exit code and output."""
    found = [(main([str(bake), "maps", str(out)]), capsys.readouterr().err)]
    if found[0][0] == 0:  # If the bake cannot be opened, the same code would reject the manifest in the other commands.
        found.append((main([str(bake), "gltf", str(out), "--stand-ins"]), capsys.readouterr().err))
    found.append((schedule.main([str(bake), "--workers", "2"]), capsys.readouterr().err))
    request = driver.BakeRequest(Source(("godot",), "/nowhere", "res://world.tscn"), bake)
    tiny = json.loads((bake.parent / "good.json").read_text())
    try:
        driver._resume(request, tiny, print)
        found.append((0, capsys.readouterr().out))
    except BakeError as error:
        found.append((2, str(error)))
    return found


def check_said(bake: Path, out: Path, content: bytes | str, capsys) -> int:
    """Returns the number of commands that reject a manifest. Fails the test if a command raises an unexpected exception or its
    message is too short."""
    (bake / MANIFEST).write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass"))
    try:
        found = said_of(bake, out, capsys)
    except Exception as error:
        raise AssertionError(f"{type(error).__name__} for {content[:3000]!r}") from error
    for code, output in found:
        assert code == 0 or (code in (1, 2) and len(output) > 20 and (str(bake) in output or "tile " in output or "--" in output)), (code, output, content)
    return sum(code != 0 for code, _ in found)


@pytest.mark.parametrize("part", range(2))
def test_a_manifest_with_any_content_results_in_a_message(bake, tmp_path, capsys, part):
    """Checks thousands of manifests in which a field is missing, of a different type, huge, negative, not a number, or
    nested."""
    good = (bake / MANIFEST).read_text()
    (tmp_path / "good.json").write_text(good)
    assert check_said(bake, tmp_path / "out", good, capsys) == 0
    contents = list(replaced(json.loads(good)))[part::2]
    refused = sum(check_said(bake, tmp_path / "out", content, capsys) > 0 for content in contents)
    assert len(contents) > 1500 and refused > 0.7 * len(contents), (refused, len(contents))


def test_a_damaged_text_results_in_a_message(bake, tmp_path, capsys):
    good = (bake / MANIFEST).read_text()
    (tmp_path / "good.json").write_text(good)
    contents = list(spoiled(good))
    refused = sum(check_said(bake, tmp_path / "out", content, capsys) > 0 for content in contents)
    assert len(contents) > 200 and refused > 0.6 * len(contents)


MADE = {
    "scene": "res://world.tscn", "scene_digest": "5ce7e", "thicket": "0.2.0", "seed": "7", "problems": [], "parts": {"the seed": "1"}, "rect": [0, 0, 64, 64],
    "tile_size": 64.0, "world_offset": [0, 0, 0], "grid": [0, 0, 1, 1], "edges": [[0, 64], [0, 64]], "columns": {"0": {"id": "<u8"}},
    "layers": [{"index": 0, "name": "Oak", "radius": 6.0, "tile_size": 64.0}], "models": [{"index": 0, "models": [{"path": "res://oak.tres"}], "material": ""}],
}  # fmt: skip


class AtOnce:
    """Replaces a Dask client and runs submitted functions immediately."""

    def __init__(self):
        self.value = None

    def submit(self, work, *arguments, **_):
        self.value = work(*arguments)
        return self

    def result(self):
        return self.value


def test_a_folder_of_tiles_with_any_content_results_in_a_message(tmp_path):
    """Checks folders such as bake_world.gd writes. Reads each folder up to its first tile."""
    made = tmp_path / "made"
    made.mkdir()
    refused = 0
    contents = [*replaced(MADE), *spoiled(json.dumps(MADE))]
    for content in (json.dumps(MADE), *contents):
        (made / tile_folder.WORLD).write_bytes(content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass"))
        out = tmp_path / "out"
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        try:
            request = driver.BakeRequest(tile_folder.made_tiles(made), out)
            plan, manifest, _ = driver._begin(request, AtOnce(), lambda output: None)
            report.Map(plan.rect, plan.pixel, manifest["layers"])
        except BakeError as error:
            assert str(made) in str(error) and "create the folder again with bake_world.gd" in str(error), (error, content)
            refused += 1
        except Exception as error:
            raise AssertionError(f"{type(error).__name__} for {content[:3000]!r}") from error
        finally:
            tile.close_engines()
    assert 0.6 * len(contents) < refused < len(contents)


def test_an_error_names_the_field_its_range_and_how_to_fix_it(bake):
    manifest = json.loads((bake / MANIFEST).read_text())
    manifest["layers"][1]["models"][0]["path"] = 5
    (bake / MANIFEST).write_text(json.dumps(manifest))
    with pytest.raises(BakeError) as refused:
        open_bake(bake)
    output = str(refused.value)
    assert output.startswith(f"{bake / MANIFEST}: layers[1].models[0].path must be a string of at most 1000 characters"), output
    assert output.endswith("got 5; restore the manifest of the bake, or bake again with --fresh"), output
