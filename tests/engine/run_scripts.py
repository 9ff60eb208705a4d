"""Runs scripts of tests/engine with an add-on in a new project, on any system with Python and Godot, without other packages. Workflows test
the libraries of Windows and macOS with it.

python3 tests/engine/run_scripts.py --godot GODOT --addon addons/thicket
python3 tests/engine/run_scripts.py --godot GODOT --addon addons/thicket test_state test_saves
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ENGINE = Path(__file__).resolve().parent
# Scripts for points, tiles, rules, surfaces, threads, files and states. They need no window and measure no time.
SCRIPTS = [
    "test_build_rect", "test_domain", "test_sample_surface", "test_layer_rules", "test_regions", "test_streaming", "test_queries", "test_threads",
    "test_surface_layers", "test_planets", "test_planet_regions", "test_heightmaps", "test_state", "test_saves",
]  # fmt: skip
PASSED = re.compile(r"^thicket engine tests: [1-9]\d* checks, 0 failed\r?$", re.MULTILINE)


def make_project(folder: Path, addon: Path):
    """Copies the add-on into a new project, and registers the extension without starting the editor."""
    shutil.copytree(addon, folder / "addons/thicket")
    (folder / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Thicket tests"\n')
    (folder / ".godot").mkdir()
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")


def failure(godot: str, project: Path, script: str) -> str | None:
    """Runs a script. Returns the end of its output if it failed, otherwise None."""
    command = [godot, "--headless", "--path", str(project), "--script", str(ENGINE / (script + ".gd"))]
    try:
        completed = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=1200, check=False)
    except subprocess.TimeoutExpired:
        return "it ran longer than 1200 s"
    return None if completed.returncode == 0 and PASSED.search(completed.stdout) else completed.stdout[-4000:] + completed.stderr[-4000:]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scripts", nargs="*", default=SCRIPTS, help="names of scripts, without .gd")
    parser.add_argument("--godot", required=True, help="the path of Godot 4.4 or newer")
    parser.add_argument("--addon", required=True, type=Path, help="the folder addons/thicket of a zip or of a project")
    options = parser.parse_args()
    failed = []
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        project = Path(folder) / "project"
        make_project(project, options.addon)
        for script in options.scripts:
            printed = failure(options.godot, project, script)
            print(script + (": passed" if printed is None else ": failed\n" + printed), flush=True)
            failed += [script] if printed is not None else []
    print("%d of %d scripts passed" % (len(options.scripts) - len(failed), len(options.scripts)))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
