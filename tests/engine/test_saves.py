"""Tests saved games: the tutorial's code, and full disks."""

from __future__ import annotations

import re
import resource
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import REPO, new_project
from test_engine import COMPLAINT, assert_passed

ENGINE = REPO / "tests/engine"
ADDON = REPO / "demo_project/addons/thicket"
TUTORIAL = ADDON / "tutorials/game_that_fells.md"

# Saves, loads, continues playing and loads again, with the functions in the tutorial's script.
TWICE = """extends SceneTree

func _initialize() -> void:
	var game: Node3D = load("res://tutorial.gd").new()
	root.add_child(game)
	await process_frame
	game.forest.remove_in_sphere(Vector3.ZERO, 10.0)
	var saved: int = game.forest.state.get_removed_count()
	game.save_game()
	game.load_game()
	print("loaded: ", game.forest.state.get_removed_count() == saved)
	game.forest.remove_in_sphere(Vector3.ZERO, 40.0)
	print("played on: ", game.forest.state.get_removed_count() > saved)
	game.load_game()
	print("loaded again: ", game.forest.state.get_removed_count() == saved)
	quit()
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    return new_project(tmp_path_factory.mktemp("saves"))


def test_the_tutorials_save_can_be_loaded_twice(godot, project):
    """A player saves, loads, continues playing and loads again. Each load restores the saved state."""
    (project / "tutorial.gd").write_text(re.search(r"^```gdscript\n(.*?)^```", TUTORIAL.read_text(), re.MULTILINE | re.DOTALL).group(1))
    (project / "twice.gd").write_text(TWICE)
    completed = godot(["--path", project, "--script", "twice.gd"], timeout=60)
    printed = completed.stdout + completed.stderr
    for line in ("loaded: true", "played on: true", "loaded again: true"):
        assert f"\n{line}\n" in printed, printed
    assert completed.returncode == 0 and not COMPLAINT.search(printed), printed


def test_scripts_replace_files_through_one_helper():
    """The add-on's scripts write files through whole_file.gd, which checks for errors that the engine ignores. Only
    bake_to_folder.gd has separate checks."""
    writing = re.compile(r"^[^#\n]*(ResourceSaver\.save\(|FileAccess\.WRITE|\.save_(png|exr|jpg|webp)\()", re.MULTILINE)
    scripts = {path.name for path in ADDON.rglob("*.gd") if writing.search(path.read_text(encoding="utf-8"))}
    assert scripts == {"whole_file.gd", "bake_to_folder.gd"}


@pytest.fixture
def small_disk(tmp_path) -> Path:
    """Mounts a disk of 1 MB and yields its folder. Skips the test where mounting is not permitted."""
    folder = tmp_path / "disk"
    folder.mkdir()
    if not shutil.which("mount") or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", folder], capture_output=True).returncode != 0:
        pytest.skip("mounting a disk is not permitted here")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_a_full_disk_keeps_the_old_files(godot, project, small_disk):
    """Covers states, masks, impostors and the files that the editor's tools write."""
    script = ENGINE / "full_disk.gd"
    assert_passed(godot(["--path", project, "--script", script, "--", f"folder={small_disk}", "fill"], timeout=120))


def test_a_limit_of_file_sizes_keeps_the_old_files(godot, project, tmp_path):
    """If the system limits file sizes to 96 KiB, saving fails and keeps the old files."""

    def with_small_files():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (96 << 10, 96 << 10))

    folder = tmp_path / "limited"
    folder.mkdir()
    arguments = ["--path", project, "--script", ENGINE / "full_disk.gd", "--", f"folder={folder}"]
    assert_passed(godot(arguments, timeout=120, preexec_fn=with_small_files))
