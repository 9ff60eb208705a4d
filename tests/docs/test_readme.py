"""Tests that the examples in README.md, in the documentation and in the tutorials run unchanged, and that the commands,
links and folders in these pages exist."""

from __future__ import annotations

import fnmatch
import re
import subprocess
from pathlib import Path

import pytest
from conftest import REPO, new_project

TEXT = (REPO / "README.md").read_text(encoding="utf-8")
PAGES = sorted(path for path in (REPO / "docs").rglob("*.md") if "classes" not in path.parts)
TUTORIALS = sorted((REPO / "demo_project/addons/thicket/tutorials").glob("*.md"))
EXAMPLES = [
    example
    for text in [TEXT, *(page.read_text(encoding="utf-8") for page in [*PAGES, *TUTORIALS])]
    for example in re.findall(r"^```gdscript\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
]

# Runs each example as if a user had pasted it into a new project. Nodes are added to a scene with a camera, and grounds
# are queried for a height.
RUNNER = """extends SceneTree

func _initialize() -> void:
	root.add_child(Camera3D.new())
	for example in %d:
		var script: GDScript = load("res://example_%%d.gd" %% example)
		assert(script != null and script.can_instantiate())
		var made: Object = script.new()
		if made is Node:
			root.add_child(made)
			await process_frame
			for scatter in made.find_children("*", "TerrainScatter3D", true, false):
				if not scatter.is_settled(): # It may have settled while another one was awaited.
					await scatter.settled
				var ids := 0
				for tile in scatter.get_shown_tiles(scatter.get_all_layers()[0]):
					var shown: ScatterTile = scatter.get_tile(scatter.get_all_layers()[0], tile)
					for mesh in shown.get_mesh_count():
						ids += shown.get_ids(mesh).size()
				print("example ", example, " shows ", ids)
			made.queue_free()
		elif made is ScatterGround:
			print("example ", example, " height ", made.get_height(Vector3(10, 0, 0)))
	await process_frame
	print("examples: ran %d")
	quit()
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    """Creates a new project that contains the add-on and the examples."""
    folder = new_project(tmp_path_factory.mktemp("readme"))
    for number, example in enumerate(EXAMPLES):
        (folder / f"example_{number}.gd").write_text(example)
    (folder / "runner.gd").write_text(RUNNER % (len(EXAMPLES), len(EXAMPLES)))
    return folder


def test_examples_run(godot, project):
    assert len(EXAMPLES) >= 10
    completed = godot(["--path", project, "--script", "runner.gd"], timeout=120)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0, printed
    assert f"examples: ran {len(EXAMPLES)}" in completed.stdout, printed
    assert not re.search(r"^(SCRIPT )?(ERROR|WARNING)", printed, re.MULTILINE), printed
    shown = re.search(r"example 0 shows (\d+)", completed.stdout)
    assert shown and int(shown.group(1)) > 1000, f"the example of README.md: {printed}"
    assert all(int(count) > 100 for count in re.findall(r"example \d+ shows (\d+)", completed.stdout)), printed
    assert re.search(r"example \d+ height 1\.91", completed.stdout), printed  # 4 sin(0.5) = 1.9177
    assert re.search(r"\d{3,} points; the first is \d+ at", completed.stdout), printed
    assert re.search(r"^\d{3,} oaks; the first is at \(", completed.stdout, re.MULTILINE), printed
    assert re.search(r"^the ray hits \d+ after \d+\.\d+ m$", completed.stdout, re.MULTILINE), printed
    assert "\nthe same forest: true\n" in completed.stdout, printed
    assert re.search(r"^\d{3,} oaks there$", completed.stdout, re.MULTILINE), printed
    assert re.search(r"^felled \d+$", completed.stdout, re.MULTILINE) and "\nstill felled: true\n" in completed.stdout, printed


def test_the_readme_is_short():
    """Checks that a newcomer can read the page within a few minutes, and that its example has at most ten lines."""
    assert len(TEXT.splitlines()) <= 150 and len(TEXT.split()) <= 1200
    assert len(EXAMPLES[0].splitlines()) <= 10


def test_the_links_of_the_readme_exist():
    """Checks that each link is a file of the repository, or a page of the forge beside it. Therefore, the page needs no address."""
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", TEXT)
    assert len(links) > 20
    assert not [link for link in links if not (REPO / link).is_file() and link not in ("../../issues", "../../releases/latest")]
    assert {"CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "docs/index.md", "docs/tutorials/index.md"} <= set(links)


def test_the_changelog_is_one_that_users_can_scan():
    """Checks the sections, that each change is one line, and that links lead to files of the repository or to pages of the
    forge."""
    text = (REPO / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    links = dict(re.findall(r"^(\[[\d.]+\]): (\S+)$", text, re.MULTILINE))
    assert len(versions) == len(links) >= 3
    for version in versions:
        heading, *lines = version.splitlines()
        found = re.fullmatch(r"(\[[\d.]+\]) - (Unreleased|\d{4}-\d\d-\d\d)", heading)
        assert found and links[found.group(1)].startswith("../../"), heading
        sections = [line for line in lines if line.startswith("#")]
        assert sections and set(sections) <= {"### Added", "### Changed", "### Deprecated", "### Removed", "### Fixed", "### Security"}, heading
        assert sorted(set(sections), key=sections.index) == sections, heading
        changes = [line for line in lines if line and not line.startswith(("#", "["))]
        assert all(line.startswith("- ") and len(line) <= 170 for line in changes), [line for line in changes if not line.startswith("- ") or len(line) > 170]
    for link in re.findall(r"\]\((?!https:)([^)#]+)", text):
        assert (REPO / link).is_file(), link


def test_folders_and_commands_exist():
    contributing = (REPO / "CONTRIBUTING.md").read_text(encoding="utf-8")
    folders = re.findall(r"^\| `([\w/]+)` \|", contributing.split("## Where things are")[1].split("\n## ")[0], re.MULTILINE)
    assert len(folders) > 7 and not [folder for folder in folders if not (REPO / folder).is_dir()]
    for text in (TEXT, contributing, *(page.read_text(encoding="utf-8") for page in PAGES)):
        for script in re.findall(r"\bbash ([\w/]+\.sh)", text):
            assert (REPO / script).is_file(), script


@pytest.mark.parametrize("page", ["ARCHITECTURE.md", "CONTRIBUTING.md"])
def test_pages_for_engineers_have_valid_paths(page):
    """Checks that every path on the pages exists, except patterns and generated files."""
    text = (REPO / page).read_text(encoding="utf-8")
    paths = re.findall(r"(?<![\w/.])((?:extension|tests|tools|demo_project)/[\w/.-]*\w)(?![\w*])", text)
    paths = [path for path in paths if not re.search(r"_$|test_$|addons/thicket/(bin|csharp)|/CLASS|-$", path)]
    assert len(paths) > 10
    missing = [path for path in paths if not (REPO / path).exists()]
    assert not missing, missing


def test_every_part_of_the_addon_is_described():
    """Checks that ARCHITECTURE.md describes each folder of the add-on, each folder of its editor, and each script next to
    them."""
    text = (REPO / "ARCHITECTURE.md").read_text(encoding="utf-8")
    block = text[text.index("## The add-on") :].split("```")[1]
    listed = re.findall(r"^ *(\w+)/? ", block, re.MULTILINE) + re.findall(r"[\w*]+\.gd", block)
    addon = REPO / "demo_project/addons/thicket"
    tracked = subprocess.run(["git", "ls-files"], cwd=addon, capture_output=True, text=True, check=True).stdout.split()
    parts = {path.split("/")[0] for path in tracked} | {path.split("/")[1] for path in tracked if path.startswith("editor/")}
    parts = {part for part in parts if part.endswith(".gd") or "." not in part}
    assert len(parts) > 30
    missing = [part for part in sorted(parts) if not any(fnmatch.fnmatch(part, pattern) for pattern in listed)]
    assert not missing, missing


def test_the_table_of_renames_has_every_former_name_in_files():
    """Checks that the table in docs/migration.md lists exactly the former names that the library still reads."""
    text = (REPO / "docs/migration.md").read_text(encoding="utf-8")
    table = text[text.index("## From 0.2 to 0.3") : text.index("## From 0.1 to 0.2")]
    rows = set(re.findall(r"^\| `([\w.]+)` \| `([\w.]+)` \|$", table, re.MULTILINE))
    properties = re.findall(r'\{"(\w+)", "(\w+)", "(\w+)"\}', (REPO / "extension/nodes/common/renames.cpp").read_text(encoding="utf-8"))
    grounds = re.findall(r"m_each\((\w+), (\w+)\)", (REPO / "extension/nodes/ground/former_grounds.cpp").read_text(encoding="utf-8"))
    assert len(properties) >= 4 and len(grounds) == 7
    expected = {(f"{owner}.{former}", f"{owner}.{current}") for owner, former, current in properties} | set(grounds)
    assert expected <= rows
    in_scripts = {"FoliageWorld", "ImpostorBaker"}  # Scenes refer to the scripts of these classes by path, so files contain no former name.
    assert {former for former, _ in rows - expected} == in_scripts
