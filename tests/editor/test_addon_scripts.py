"""Tests that the add-on's scripts match the library. All scripts must compile with it. If a member of the library is renamed, these tests
must fail for every script that still uses the old name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import REPO
from helpers.editor_project import link_library, new_plain_project
from helpers.engine_output import complaints

# In scripts that use the library's types, accessing a member that a variable's declared type lacks is an error.
STRICT = """
[debug]
gdscript/warnings/directory_rules={"res://": 0, "res://addons/thicket/editor": 1, "res://addons/thicket/baking": 1}
gdscript/warnings/unsafe_property_access=2
gdscript/warnings/unsafe_method_access=2
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    folder = new_plain_project(tmp_path_factory.mktemp("addon_scripts"))
    link_library(folder)
    settings = folder / "project.godot"
    settings.write_text(settings.read_text() + STRICT)
    return folder


def check(godot, project: Path, part: str) -> tuple[list[str], int, str]:
    """Runs a part of addon_scripts.gd. Returns its errors, the number of checked items, and its output."""
    completed = godot(["--path", project, "--script", REPO / "tests/engine/addon_scripts.gd", "--", part], timeout=300)
    printed = completed.stdout + completed.stderr
    last = re.search(r"^addon scripts: (\d+) looked at, (\d+) wrong$", printed, re.MULTILINE)
    wrong = re.findall(r"^WRONG (.*)$", printed, re.MULTILINE)
    assert last and len(wrong) == int(last.group(2)), printed[-4000:]
    return wrong, int(last.group(1)), printed


def test_every_script_compiles(godot, project):
    wrong, looked, printed = check(godot, project, "compile")
    assert not wrong and not complaints(printed), printed[-8000:]
    assert looked == len(list((project / "addons/thicket").rglob("*.gd")))


def test_members_are_not_reached_by_name(godot, project):
    """Checks that member names in strings exist. Undo actions and lists of properties require names as strings."""
    wrong, _, printed = check(godot, project, "names")
    assert not wrong and not complaints(printed), wrong


def test_a_renamed_member_fails_to_compile(godot, project):
    """Checks that, in typed scripts, every use of a member fails to compile after the member was renamed in the
    library's classes."""
    wrong, looked, _ = check(godot, project, "renamed")
    assert not wrong and looked > 500, wrong
