"""Tests that the add-on reports a wrong folder, beside the engine's errors about paths that do not exist. The editor lists plugins
only in the folder addons, so the plugin cannot report other folders."""

from __future__ import annotations

import re
import shutil

import pytest
from conftest import REPO


@pytest.mark.parametrize("folder", ["thicket", "addons/thicket-0.3.0", "addons/addons/thicket"])
def test_a_wrong_folder_is_reported(godot, tmp_path, folder):
    text = 'config_version=5\n[application]\nconfig/name="Misplaced"\n[editor_plugins]\n'
    (tmp_path / "project.godot").write_text(f'{text}enabled=PackedStringArray("res://{folder}/plugin.cfg")\n')
    shutil.copytree(REPO / "demo_project/addons/thicket", tmp_path / folder)
    completed = godot(["--path", tmp_path, "--editor", "--quit-after", "100"], timeout=120)
    printed = completed.stdout + completed.stderr
    assert f"Thicket must be in the folder res://addons/thicket/, but it is in res://{folder}/. Close the editor, move the folder" in printed, printed
    assert not re.search(r"plugin\.gd.*(Parse|Compile) Error|Unable to load addon script", printed), printed
