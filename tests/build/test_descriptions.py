"""Tests the bindings' description of the engine's API. The bindings are generated from the description of the oldest
supported engine, and must not rely on anything that later engines have changed. description_4.4.json is compared with
the description of this engine, and with those of all releases, if available."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import CACHE, REPO, run

BINDINGS = REPO / "extension/bindings"
OLDEST = BINDINGS / "description_4.4.json"
USED = BINDINGS / "used_api.toml"
NODES = [path for path in sorted((REPO / "extension/nodes").rglob("*")) if path.suffix in (".hpp", ".cpp")]
DESCRIPTIONS = Path(os.environ.get("THICKET_DESCRIPTIONS") or CACHE / "descriptions")
RELEASES = ["4.4", "4.5", "4.6", "4.7"]


def script(name: str, *arguments) -> subprocess.CompletedProcess[str]:
    completed = run([sys.executable, BINDINGS / name, *arguments], timeout=120)
    assert "Traceback" not in completed.stderr, completed.stderr
    return completed


def dumped(build_dir: Path) -> Path:
    """Returns the path of the API description that this engine has written."""
    return build_dir.parent / "engine/extension_api.json"


def released(version: str) -> Path:
    path = DESCRIPTIONS / version / "extension_api.json"
    if not path.is_file():
        pytest.skip(f"{path} does not exist: tools/setup.sh downloads it, or set THICKET_DESCRIPTIONS")
    return path


def release(path: Path) -> str:
    header = json.loads(path.read_text(encoding="utf-8"))["header"]
    return f"{header['version_major']}.{header['version_minor']}"


# --- The comparison ----------------------------------------------------------------------------------------------------


def test_this_engine_has_what_the_bindings_rely_on(build_dir):
    completed = script("check.py", dumped(build_dir))
    assert completed.returncode == 0 and not completed.stdout, completed.stdout


@pytest.mark.parametrize("version", RELEASES)
def test_a_release_has_what_the_bindings_rely_on(version):
    path = released(version)
    assert release(path) == version
    completed = script("check.py", path)
    assert completed.returncode == 0 and not completed.stdout, completed.stdout


def named(items: list[dict], name: str) -> dict:
    return next(item for item in items if item["name"] == name)


def of_class(api: dict, owner: str, kind: str, name: str) -> dict:
    return named(named(api["classes"], owner)[kind], name)


def other_hash(api: dict, owner: str, name: str, compatible: bool) -> None:
    method = of_class(api, owner, "methods", name)
    method["hash_compatibility"] = [method["hash"]] if compatible else [1]
    method["hash"] += 1


def lose(items: list[dict], name: str) -> None:
    items.remove(named(items, name))


DAMAGES: dict[str, tuple[Callable[[dict], object], str]] = {
    "hash": (lambda api: other_hash(api, "Node", "add_child", False), "Node.add_child() has the hash"),
    "virtual's hash": (
        lambda api: other_hash(api, "Node", "_get_configuration_warnings", True),
        "Node._get_configuration_warnings() has the hash",
    ),
    "virtual's result": (
        lambda api: of_class(api, "Node", "methods", "_get_configuration_warnings").update(return_value={"type": "Array"}),
        "Node._get_configuration_warnings() is Array() and was PackedStringArray()",
    ),
    "static": (
        lambda api: of_class(api, "PhysicsRayQueryParameters3D", "methods", "create").update(is_static=False),
        "PhysicsRayQueryParameters3D.create(): is_static is False",
    ),
    "method": (lambda api: lose(named(api["classes"], "Mesh")["methods"], "get_aabb"), "Mesh.get_aabb() is gone"),
    "enum": (
        lambda api: named(of_class(api, "Image", "enums", "Format")["values"], "FORMAT_RF").update(value=3),
        "Image.Format.FORMAT_RF is 3 and was 8",
    ),
    "newer value": (
        lambda api: of_class(api, "Image", "enums", "Format")["values"].append({"name": "FORMAT_NEW", "value": 39}),
        "Image.Format.FORMAT_NEW is 39",
    ),
    "renumbered newer value": (
        lambda api: of_class(api, "Image", "enums", "Format")["values"].append({"name": "FORMAT_R16", "value": 40}),
        "Image.Format.FORMAT_R16 is 40",
    ),
    "global enum": (
        lambda api: lose(named(api["global_enums"], "Error")["values"], "ERR_BUSY"),
        "Error.ERR_BUSY is gone and was 44",
    ),
    "constant": (
        lambda api: of_class(api, "Node", "constants", "NOTIFICATION_ENTER_TREE").update(value=1),
        "Node.NOTIFICATION_ENTER_TREE is 1 and was 10",
    ),
    "parent": (lambda api: named(api["classes"], "Noise").update(inherits="Node"), "Noise no longer inherits Resource"),
    "counting": (lambda api: named(api["classes"], "Mesh").update(is_refcounted=False), "Mesh: is_refcounted is False"),
    "class": (lambda api: lose(api["classes"], "Curve"), "Curve is gone"),
    "singleton": (lambda api: lose(api["singletons"], "Engine"), "Engine is no longer a singleton"),
    "size": (
        lambda api: named(api["builtin_class_sizes"][2]["sizes"], "Vector3").update(size=12),
        "Vector3 takes [12, 12, 12, 24] bytes",
    ),
    "constructor": (
        lambda api: named(api["builtin_classes"], "String")["constructors"].pop(),
        "String: constructor 3 was void(NodePath)",
    ),
    "operator": (
        lambda api: named(named(api["builtin_classes"], "String")["operators"], "%").update(return_type="int"),
        "String: operator % Array was String",
    ),
    "builtin method": (
        lambda api: named(named(api["builtin_classes"], "Array")["methods"], "size").update(hash=7, hash_compatibility=[]),
        "Array.size() has the hash 7",
    ),
}


def damaged(tmp_path: Path, damage: Callable[[dict], object]) -> Path:
    api = json.loads(OLDEST.read_text(encoding="utf-8"))
    damage(api)
    path = tmp_path / "extension_api.json"
    path.write_text(json.dumps(api))
    return path


@pytest.mark.parametrize("name", DAMAGES)
def test_a_difference_is_found(name, tmp_path):
    damage, sentence = DAMAGES[name]
    completed = script("check.py", damaged(tmp_path, damage))
    assert completed.returncode != 0 and sentence in completed.stdout, completed.stdout + completed.stderr
    assert completed.stdout.count("\n") == 1, completed.stdout


def test_harmless_changes_are_ignored(tmp_path):
    """Checks that the following changes are accepted: a method with a new hash that still supports its old hash, a new
    class between two classes, and an added enum value."""

    def harmless(api: dict) -> None:
        other_hash(api, "Node", "add_child", True)
        api["classes"].append({"name": "Between", "inherits": "Resource", "is_refcounted": True})
        named(api["classes"], "Noise")["inherits"] = "Between"
        of_class(api, "Image", "enums", "Format")["values"].append({"name": "FORMAT_NEW", "value": 100})

    completed = script("check.py", damaged(tmp_path, harmless))
    assert completed.returncode == 0, completed.stdout


def test_numbers_in_engine_code_are_compared():
    """Checks that used_api.toml lists each enum value that the sources contain as a number because older headers have
    no name for it. check.py reads that list."""
    newer = tomllib.loads(USED.read_text(encoding="utf-8"))["newer"]
    known = {(owner, enum, name.lower(), value) for owner, enums in newer.items() for enum, values in enums.items()
        for name, value in values.items()}  # fmt: skip
    cast = re.compile(r"(\w+) = static_cast<(\w+)::(\w+)>\((\d+)\)")
    found = {(owner, enum, name, int(value)) for path in NODES
        for name, owner, enum, value in cast.findall(path.read_text(encoding="utf-8"))}  # fmt: skip
    assert found == known


def test_newer_values_are_those_of_this_engine(build_dir):
    """Checks the numbers of newer enum values, if this engine is new enough to have these values."""
    if tuple(map(int, release(dumped(build_dir)).split("."))) < (4, 6):
        pytest.skip("this engine is too old to have these values")
    api = json.loads(dumped(build_dir).read_text(encoding="utf-8"))
    for owner, enums in tomllib.loads(USED.read_text(encoding="utf-8"))["newer"].items():
        for enum, values in enums.items():
            there = {value["name"]: value["value"] for value in of_class(api, owner, "enums", enum)["values"]}
            assert values.items() <= there.items()


# --- The description ---------------------------------------------------------------------------------------------------


def describe(api: Path, out: Path, used: Path = USED) -> subprocess.CompletedProcess[str]:
    return script("describe.py", "--api", api, "--used", used, "--out", out)


def test_the_description_contains_only_what_is_used(tmp_path):
    """Checks that describe.py reproduces the description when it reads the description itself. This shows that nothing in it is
    missing or unused."""
    assert describe(OLDEST, tmp_path / OLDEST.name).returncode == 0
    assert (tmp_path / OLDEST.name).read_text() == OLDEST.read_text()


def test_the_description_matches_the_release(tmp_path):
    assert describe(released("4.4"), tmp_path / OLDEST.name).returncode == 0
    assert (tmp_path / OLDEST.name).read_text() == OLDEST.read_text(), "run describe.py with the 4.4 description"


def test_another_release_is_not_accepted_as_the_oldest(tmp_path, build_dir):
    version = release(dumped(build_dir))
    completed = describe(dumped(build_dir), tmp_path / "description_4.1.json")
    assert completed.returncode != 0 and version in completed.stderr and "4.1" in completed.stderr
    assert describe(dumped(build_dir), tmp_path / f"description_{version}.json").returncode == 0


@pytest.mark.parametrize(
    ("addition", "words"),
    [
        ('[classes.Time]\nmethods = ["get_tikcs"]', ["Time", "get_tikcs", "Godot Engine"]),
        ("[classes.Sprite3D]", ["Sprite3D", "SpriteBase3D", "before"]),
        ('[classes.Time]\nconstants = ["NOON"]', ["Time", "NOON"]),
        ('[classes.Input]\nmethods = ["is_key_pressed"]', ["Input", "Key"]),
        ('[classes.Skeleton3D]\nmethods = ["get_bone_pose_rotation"]', ["Quaternion"]),
        ('[classes.PhysicsServer2D]\nmethods = ["body_apply_force"]', ["body_apply_force", "double_hashes"]),
    ],
)
def test_missing_api_is_reported_by_name(addition, words, tmp_path, build_dir):
    used = tmp_path / "used.toml"
    used.write_text(USED.read_text() + "\n" + addition + "\n")
    completed = describe(dumped(build_dir), tmp_path / f"description_{release(dumped(build_dir))}.json", used)
    assert completed.returncode != 0
    for word in words:
        assert word in completed.stderr


# --- The generator -----------------------------------------------------------------------------------------------------


def generate(out: Path, build_dir: Path, used: Path = USED, interface: Path | None = None):
    interface = interface or build_dir.parent / "engine/gdextension_interface.h"
    return script("generate.py", "--used", used, "--out", out, "--api", OLDEST, "--interface", interface)


def test_generator_writes_the_listed_files_and_only_changes(tmp_path, build_dir):
    listed = script("generate.py", "--used", USED, "--out", tmp_path, "--list").stdout.split()
    assert generate(tmp_path, build_dir).returncode == 0
    written = {str(path): path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()}
    assert sorted(written) == sorted(listed)
    assert generate(tmp_path, build_dir).returncode == 0
    assert {path: Path(path).stat().st_mtime_ns for path in written} == written


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("", '[classes.Time]\nmethods = ["get_ticks_msec"]', ["Time"]),
        ('"get_faces",', '"get_faces", "generate_triangle_mesh",', ["Mesh", "generate_triangle_mesh"]),
        ('enums = ["Error",', 'enums = ["Error", "Side",', ["Side"]),
    ],
)
def test_generator_names_api_that_the_description_lacks(before, after, words, tmp_path, build_dir):
    """Checks that the error names the missing API and the command that updates the description."""
    used = tmp_path / "used.toml"
    text = USED.read_text()
    assert before in text
    used.write_text(text.replace(before, after) if before else text + "\n" + after + "\n")
    completed = generate(tmp_path / "out", build_dir, used)
    assert completed.returncode != 0
    for word in [*words, "4.4", "extension/bindings/describe.py --api"]:
        assert word in completed.stderr


def test_interface_functions_are_old_enough(tmp_path, build_dir):
    """Checks that the generator rejects a function that the oldest engine lacks. The header states the release that
    introduced each function."""
    header = (build_dir.parent / "engine/gdextension_interface.h").read_text(encoding="utf-8")
    late = tmp_path / "late.h"
    late.write_text(re.sub(r"(@name variant_call\n \* @since) [\d.]+", r"\1 4.10", header))
    assert late.read_text() != header
    completed = generate(tmp_path / "out", build_dir, interface=late)
    assert completed.returncode != 0
    assert "variant_call" in completed.stderr and "4.10" in completed.stderr and "4.4" in completed.stderr
    late.write_text(header.replace("@name variant_call\n", "@name variant_cry\n"))
    completed = generate(tmp_path / "out", build_dir, interface=late)
    assert completed.returncode != 0 and "'variant_call'" in completed.stderr
