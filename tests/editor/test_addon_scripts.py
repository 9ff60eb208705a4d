"""The add-on's scripts match the library: all of them compile with it, and a renamed member of the library is found before a user
meets it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from conftest import REPO
from helpers.editor_project import link_library, new_plain_project
from helpers.engine_output import complaints

# In scripts that know the library's types, using a member that the declared type of a variable lacks is an error.
STRICT = """
[debug]
gdscript/warnings/directory_rules={"res://": 0, "res://addons/thicket/editor": 1, "res://addons/thicket/baking": 1}
gdscript/warnings/unsafe_property_access=2
gdscript/warnings/unsafe_method_access=2
"""
# Faulty scripts, and the parts of the check that find their faults.
FAULTS = {
    "by_name": ("func f(layer: ScatterLayer) -> float:\n\treturn layer.get(&\"radius\")\n", {"names"}),
    "undo": ("func f(layer: ScatterLayer, undo: UndoRedo) -> void:\n\tundo.add_do_property(layer, &\"radios\", 1.0)\n", {"names"}),
    "listed": ("const FITTED: Array[StringName] = [&\"radios\"]\n", {"names"}),
    "constant": ("func f() -> int:\n\treturn ClassDB.class_get_integer_constant(&\"ScatterImpostorBaker\", &\"CULL_BAG\")\n", {"names"}),
    "class_name": ("func f(node: Node) -> bool:\n\treturn node.is_class(\"ScatterLayr\")\n", {"names"}),
    "renamed": ("func f(layer: ScatterLayer) -> float:\n\treturn layer.radios\n", {"compile"}),
    "supertype": ("func f(layer: Resource) -> float:\n\treturn layer.radius\n", {"compile"}),
    "untyped": ("func f(layers: Array) -> float:\n\treturn layers[0].radius\n", {"renamed"}),
    "sound": ("func f(layers: Array[ScatterLayer]) -> float:\n\treturn layers[0].radius\n", set()),
}


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    folder = new_plain_project(tmp_path_factory.mktemp("addon_scripts"))
    link_library(folder)
    settings = folder / "project.godot"
    settings.write_text(settings.read_text() + STRICT)
    return folder


def check(godot, project: Path, part: str) -> tuple[list[str], int, str]:
    """The faults, the number of checked items, and the output."""
    done = godot(["--path", project, "--script", REPO / "tests/engine/addon_scripts.gd", "--", part], timeout=300)
    printed = done.stdout + done.stderr
    last = re.search(r"^addon scripts: (\d+) looked at, (\d+) wrong$", printed, re.MULTILINE)
    wrong = re.findall(r"^WRONG (.*)$", printed, re.MULTILINE)
    assert last and len(wrong) == int(last.group(2)), printed[-4000:]
    return wrong, int(last.group(1)), printed


def test_every_script_compiles(godot, project):
    wrong, looked, printed = check(godot, project, "compile")
    assert not wrong and not complaints(printed), printed[-8000:]
    assert looked == len(list((project / "addons/thicket").rglob("*.gd")))


def test_members_are_not_reached_by_name(godot, project):
    """Names that must be strings, for undo and for lists of properties, are names of existing members."""
    wrong, _, printed = check(godot, project, "names")
    assert not wrong and not complaints(printed), wrong


def test_a_renamed_member_fails_to_compile(godot, project):
    """If a member of the library's classes is renamed, each use of it fails to compile."""
    wrong, looked, _ = check(godot, project, "renamed")
    assert not wrong and looked > 500, wrong


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_are_found(godot, tmp_path, fault):
    """The checks above find each kind of fault, and none in a correct script."""
    source, finders = FAULTS[fault]
    addon = tmp_path / "addons/thicket"
    (addon / "editor").mkdir(parents=True)
    (tmp_path / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Fault"\n' + STRICT)
    link_library(tmp_path)
    (addon / "editor/.gdignore").touch()
    shutil.copytree(REPO / "demo_project/addons/thicket/baking", addon / "baking")
    for shared in ("library_gate.gd", "whole_file.gd"):
        shutil.copy(REPO / "demo_project/addons/thicket" / shared, addon)
    (addon / "editor/faulty.gd").write_text("extends RefCounted\n\n\n" + source)
    found = {part for part in ("compile", "names", "renamed") if check(godot, tmp_path, part)[0]}
    assert found & finders == finders and bool(found) == bool(finders), found
