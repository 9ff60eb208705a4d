"""Creates projects in which tests start the editor, and evaluates the results of the checks in these editors."""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from conftest import REPO
from helpers.engine_output import complaints

DEMO = REPO / "demo_project"
STEPS = REPO / "tests/editor/steps"
READ_LAST = REPO / "tests/editor/zz_read_last.gd"
PICTURES = REPO / "build/editor"
PASSED = re.compile(r"^editor tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)


def check_passed(printed: str):
    """Asserts that all checks of a script in the editor passed, without errors or warnings. The message of a failure
    lists the failed checks first."""
    failed = [line[:400] for line in printed.splitlines() if line.startswith("FAILED: ")] + complaints(printed)
    assert not failed and PASSED.search(printed), "\n".join([*failed, printed[-4000:]])


def new_plain_project(folder: Path) -> Path:
    """Creates a project that contains only the add-on, without its library."""
    text = 'config_version=5\n[application]\nconfig/name="Plain"\n[editor_plugins]\n'
    (folder / "project.godot").write_text(text + 'enabled=PackedStringArray("res://addons/thicket/plugin.cfg")\n')
    skipped = shutil.ignore_patterns("bin", "*.gdextension*")
    shutil.copytree(DEMO / "addons/thicket", folder / "addons/thicket", ignore=skipped)
    return folder


def link_library(folder: Path) -> None:
    """Links the library into a plain project, so that the engine loads it on the first start."""
    addon = folder / "addons/thicket"
    (addon / "bin").symlink_to(DEMO / "addons/thicket/bin")
    shutil.copy(DEMO / "addons/thicket/thicket.gdextension", addon)
    (folder / ".godot").mkdir()
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")


def add_steps(folder: Path, names: Sequence[str] = ()) -> None:
    """Adds the scripts of the editor tests, or only those in `names`, and enables their plugin. Their screenshots are
    saved in the build folder."""
    if names:
        (folder / "tests").mkdir()
        for name in names:
            shutil.copy(STEPS / name, folder / "tests")
    else:
        shutil.copytree(STEPS, folder / "tests")
    shutil.copy(READ_LAST, folder)
    PICTURES.mkdir(parents=True, exist_ok=True)
    (PICTURES / ".gdignore").touch()
    (folder / "pictures_of_tests").symlink_to(PICTURES)
    settings = folder / "project.godot"
    text, count = re.subn(r'^(enabled=PackedStringArray\(.*)\)$', r'\1, "res://tests/plugin.cfg")', settings.read_text(), flags=re.MULTILINE)
    assert count == 1, "the add-on's plugin must be enabled"
    settings.write_text(text)
