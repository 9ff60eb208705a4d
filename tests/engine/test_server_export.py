"""Tests a dedicated server exported with Strip Visuals. Colliders and layers that read textures must be the same as in the
project."""

from __future__ import annotations

import re
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import pytest
from conftest import REPO, in_godots_root

ADDON = REPO / "demo_project/addons/thicket"
FIXTURE = REPO / "tests/engine/server_export"
COMPLAINT = re.compile(r"^(?:SCRIPT |USER )?(?:ERROR|WARNING)\b.*", re.MULTILINE)
LAYER = re.compile(r"^layer: (.*): (\d+) instances, (\d+) hits, (\d+)$", re.MULTILINE)
PROJECT = """config_version=5
[application]
config/name="Server"
run/main_scene="res://level.tscn"
"""
PLUGIN = '[editor_plugins]\nenabled=PackedStringArray("res://addons/thicket/plugin.cfg")\n'
PRESETS = """[preset.0]
name="Server"
platform="Linux"
runnable=true
dedicated_server=true
export_filter="customized"
customized_files={"res://": "strip"}
include_filter=""
exclude_filter=""

[preset.0.options]
custom_template/release="/usr/bin/godot-template-release"
binary_format/embed_pck=false
binary_format/architecture="x86_64"
"""


def png(path: Path, color) -> None:
    """Writes an RGB image of 64 by 64 pixels. color(x, y) returns three bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(byte for x in range(64) for byte in color(x, y)) for y in range(64))
    header = struct.pack(">IIBBBBB", 64, 64, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def make_project(folder: Path, godot, settings: str) -> Path:
    folder.mkdir()
    (folder / "addons").mkdir()
    shutil.copytree(ADDON, folder / "addons/thicket")
    shutil.copy(FIXTURE / "server.gd", folder)
    (folder / "project.godot").write_text(PROJECT + settings)
    (folder / ".godot").mkdir()
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    (folder / "export_presets.cfg").write_text(PRESETS)
    png(folder / "heights.png", lambda x, y: (4 * x % 256, 0, 0))
    png(folder / "mask.png", lambda x, y: (255 * (x // 8 % 2), 0, 0))
    png(folder / "map.png", lambda x, y: (255 * (y // 8 % 2), 0, 0))
    for arguments in (["--import"], ["--script", FIXTURE / "make_project.gd"]):
        done = godot(["--path", folder, *arguments], timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


def complaints(done: subprocess.CompletedProcess[str]) -> list[str]:
    return [line for line in COMPLAINT.findall(done.stdout + done.stderr) if "X509" not in line]


@pytest.fixture(scope="module")
def template() -> None:
    if in_godots_root(["test", "-x", "/usr/bin/godot-template-release"], 60).returncode:
        pytest.skip("no export template is installed")


def export(project: Path, godot, out: Path) -> Path:
    """Exports the server, which must print no errors, and returns the path of its executable."""
    out.mkdir()
    done = godot(["--path", project, "--export-release", "Server", out / "server.x86_64"], timeout=300)
    assert done.returncode == 0 and not complaints(done), done.stdout + done.stderr
    return out / "server.x86_64"


@pytest.mark.full
def test_a_server_without_visuals_collides_as_the_project(template, godot, tmp_path):
    project = make_project(tmp_path / "project", godot, PLUGIN)
    played = godot(["--path", project], timeout=120)
    server = in_godots_root([export(project, godot, tmp_path / "server"), "--headless"], 120)
    layers = LAYER.findall(played.stdout)
    assert len(layers) == 7 and all(int(hits) > 0 for _, _, hits, _ in layers), played.stdout + played.stderr
    assert LAYER.findall(server.stdout) == layers, server.stdout + server.stderr
    assert not complaints(server) and server.stdout.count("problems: []") == 2, server.stdout + server.stderr


@pytest.mark.full
def test_an_export_without_the_plugin_warns_once_for_each_node(template, godot, tmp_path):
    """Even without the plugin, the collision shapes of models work in the export."""
    project = make_project(tmp_path / "project", godot, "")
    level = project / "level.tscn"
    scene = level.read_text()
    flat = scene.replace('type="ScatterGroundHeightmap"', 'type="ScatterGroundFlat"')
    assert flat != scene
    level.write_text(re.sub(r"^(image|rect|max_height) = .*\n", "", flat, flags=re.MULTILINE))
    played = godot(["--path", project], timeout=120)
    server = in_godots_root([export(project, godot, tmp_path / "server"), "--headless"], 120)
    models = [[layer for layer in LAYER.findall(done.stdout) if layer[0] == "Model"] for done in (played, server)]
    assert len(models[0]) == 1 and models[0] == models[1], server.stdout + server.stderr
    assert len(complaints(server)) == 2 and "was stripped from this export" in complaints(server)[0], server.stdout + server.stderr
