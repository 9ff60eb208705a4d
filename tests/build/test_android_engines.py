"""Searches Godot's official libraries for Android for the interface functions that the extension looks up when it is loaded.
An engine that lacks one of them refuses to load the extension."""

from __future__ import annotations

import re
import zipfile

import pytest
from conftest import CACHE, REPO

ABIS = ["arm64-v8a", "armeabi-v7a", "x86", "x86_64"]


def looked_up(build_dir) -> list[str]:
    """Returns the names of the functions that the extension looks up."""
    generated = (build_dir / "gen/src/gdextension_interface_loader.cpp").read_text(encoding="utf-8")
    names = re.findall(r'gdextension_interface::\w+, "(\w+)"', generated)
    assert len(names) > 50, "the form of the generated file has changed"
    return names


def missing(version: str, abi: str, names: list[str]) -> list[str]:
    """Returns the names that do not occur, as whole strings, in the engine's library."""
    archive = CACHE / f"maven/org/godotengine/godot/{version}.stable/godot-{version}.stable.aar"
    if not archive.is_file():
        pytest.skip(f"{archive} does not exist: tools/setup_full.sh downloads it with Maven")
    with zipfile.ZipFile(archive) as opened:
        library = opened.read(f"jni/{abi}/libgodot_android.so")
    return [name for name in names if b"\0" + name.encode() + b"\0" not in library]


@pytest.mark.full
@pytest.mark.parametrize("abi", ABIS)
@pytest.mark.parametrize("version", ["4.6.1", "4.6.2", "4.6.3"])
def test_an_android_engine_has_all_functions_that_the_extension_looks_up(version, abi, build_dir):
    assert missing(version, abi, looked_up(build_dir)) == []


@pytest.mark.full
def test_an_android_engine_that_is_too_old_lacks_some_of_them(build_dir):
    """Godot 4.3 is older than the oldest supported engine. If it had all functions, the search would prove nothing."""
    assert "classdb_register_extension_class4" in missing("4.3.0", "arm64-v8a", looked_up(build_dir))
