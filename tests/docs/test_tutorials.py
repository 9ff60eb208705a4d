"""Tests the add-on's tutorials. Their links and images must be valid, their steps must work in the editor and over
the network, and the class reference must link to them. tests/docs/test_readme.py runs their examples."""

from __future__ import annotations

import re
import shutil
import socket
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import REPO, new_project
from helpers.editor_project import PICTURES, add_steps, check_passed, link_library, new_plain_project
from helpers.engine_output import complaints
from helpers.engine_process import processes
from PIL import Image

ADDON = REPO / "demo_project/addons/thicket"
FOLDER = ADDON / "tutorials"
PAGES = {path.name: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.md"))}
LINK = re.compile(r"(?<!!)\[[^\]]+\]\(([^)]+)\)")
PICTURE = re.compile(r"!\[[^\]]+\]\(([^)]+)\)")
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def title(page: str) -> str:
    return PAGES[page].splitlines()[0].removeprefix("# ")


# --- The content of the pages -------------------------------------------------------------------------------------------


def test_the_window_offers_every_page():
    source = (ADDON / "editor/help/tutorial_window.gd").read_text()
    offered = re.findall(r'"(\w+\.md)"', source)
    assert sorted(offered) == sorted(PAGES) and len(PAGES) == 9
    assert offered[:5] == ["first_forest.md", "your_own_tree.md", "paint_and_shapes.md", "game_that_fells.md", "server.md"]


def test_the_class_reference_links_to_every_page():
    """Checks that links are paths in the add-on with the title of the page, and that the main node links to all
    pages."""
    linked: dict[str, set[str]] = {}
    for path in (REPO / "extension/doc_classes").glob("*.xml"):
        for link in ElementTree.parse(path).getroot().iterfind("tutorials/link"):
            page = link.text.removeprefix("res://addons/thicket/tutorials/")
            assert page in PAGES and link.get("title") == title(page), (path.name, link.text)
            linked.setdefault(page, set()).add(path.stem)
    for script in (ADDON / "shaders").glob("*.gd"):
        for name, link in re.findall(r"^## @tutorial\((.+)\): (.+)$", script.read_text(), re.MULTILINE):
            assert name == title(link.removeprefix("res://addons/thicket/tutorials/")), script.name
    assert sorted(linked) == sorted(PAGES)
    assert all("TerrainScatter3D" in classes for classes in linked.values()), linked


def test_links_and_images_exist():
    used = set()
    for page, text in PAGES.items():
        for link in LINK.findall(FENCE.sub("", text)):
            assert link in PAGES, f"{page} links to {link}"
        for picture in PICTURE.findall(text):
            used.add(picture)
            with Image.open(FOLDER / picture) as image:
                assert image.format == "JPEG" and image.width == 960, picture
            assert (FOLDER / picture).stat().st_size <= 150_000, picture
    assert used == {path.name for path in FOLDER.glob("*.jpg")}, "some images are not used by any page"
    assert (FOLDER / ".gdignore").is_file(), "without it, users' projects would import the images"
    for page in ("first_forest.md", "your_own_tree.md", "paint_and_shapes.md", "game_that_fells.md", "server.md"):
        assert PICTURE.search(PAGES[page]) and "\n## Troubleshooting\n" in PAGES[page], page


def test_readmes_link_to_the_pages():
    shipped = (REPO / "tools/package/README.md").read_text(encoding="utf-8")
    readme = (REPO / "README.md").read_text(encoding="utf-8")
    index = (REPO / "docs/tutorials/index.md").read_text(encoding="utf-8")
    for page in PAGES:
        assert f"tutorials/{page}" in shipped and f"tutorials/{page})" in index, page
    for text in (shipped, readme, (REPO / "demo_project/README.md").read_text(encoding="utf-8")):
        named = re.findall(r"tutorials/(\w+\.md)", text)
        assert named and set(named) <= {*PAGES, "index.md"}, named


# --- The steps of the pages ----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def editor(godot, godot_xvfb, tmp_path_factory) -> str:
    """Returns the output of an editor in which the steps are performed, in a project with the add-on and a tree from an
    asset pack."""
    folder = new_plain_project(tmp_path_factory.mktemp("tutorials"))
    link_library(folder)
    add_steps(folder)
    shutil.copytree(REPO / "demo_project/meshes", folder / "meshes")
    made = godot(["--path", folder, "--script", "res://tests/tutorial_tree.gd"], timeout=120)
    assert "written" in made.stdout and not complaints(made.stdout + made.stderr), made.stdout + made.stderr
    shutil.rmtree(folder / "meshes")
    godot(["--path", folder, "--import"], timeout=120)
    settings = folder / "project.godot"
    settings.write_text(settings.read_text() + '[rendering]\nrenderer/rendering_method="gl_compatibility"\n')
    completed = godot_xvfb(["--editor", "--path", folder, "--", "tutorials"], timeout=580)
    return completed.stdout + completed.stderr


def test_steps_in_the_editor(editor):
    """Checks that all steps succeed. The checks themselves are in tutorials.gd."""
    check_passed(editor)


# Runs the server or a player of server.md. A player clicks on visible trees around a position, waits until the given
# number of trees has been felled, and takes a screenshot.
PLAYER = """extends SceneTree

func _initialize() -> void:
	play.call_deferred()

func play() -> void:
	var arguments := OS.get_cmdline_user_args()
	var game: Node3D = load("res://server.gd").new()
	root.add_child(game)
	if not game.forest.is_settled():
		await game.forest.settled
	if "--server" in arguments:
		print("ready")
		while not FileAccess.file_exists("res://over"):
			await process_frame
	else:
		await take_part(game, arguments[0].to_int(), Vector3(arguments[1].to_float(), 0.0, 0.0), arguments[2].to_int())
	print("digest ", game.forest.state.get_digest())
	if arguments.size() > 3:
		await load("res://view.gd").take(game, game.forest, arguments[3])
		print("taken")
	quit()

func take_part(game: Node3D, clicks: int, around: Vector3, wanted: int) -> void:
	while game.multiplayer.multiplayer_peer.get_connection_status() != MultiplayerPeer.CONNECTION_CONNECTED:
		await process_frame
	for number in clicks:
		var tree: ScatterInstance = game.forest.query_nearest(around, 20.0, [],
				func(id: int, _layer: ScatterLayer, _at: Transform3D) -> bool: return is_seen(game, id))
		var click := InputEventMouseButton.new()
		click.button_index = MOUSE_BUTTON_LEFT
		click.pressed = true
		click.position = root.get_camera_3d().unproject_position(tree.get_position() + Vector3.UP)
		root.push_input(click, true)
		while game.forest.has_instance(tree.id):
			await process_frame
	while game.forest.state.get_removed_count() < wanted:
		await process_frame

func is_seen(game: Node3D, id: int) -> bool:
	var eye := root.get_camera_3d().global_position
	var foot: Vector3 = game.forest.get_instance(id).get_position() + Vector3.UP
	var hit: ScatterInstance = game.forest.query_ray(eye, foot + eye.direction_to(foot))
	return hit != null and hit.id == id
"""


def write_game(folder: Path) -> None:
    """Writes the script of server.md, with an unused port, and the script of the player."""
    code = dict(FENCE.findall(PAGES["server.md"]))["gdscript"]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    assert code.count("const PORT := 4433\n") == 1
    (folder / "server.gd").write_text(code.replace("4433", str(port)))
    (folder / "player.gd").write_text(PLAYER)
    shutil.copy(REPO / "tests/engine/tutorial_view.gd", folder / "view.gd")


def test_a_server_and_its_players(tmp_path):
    """Checks that clicks of players fell trees on the server and for all players. A late player must receive all
    changes, and all must end with the same digest."""
    folder = new_project(tmp_path, '[rendering]\nrenderer/rendering_method="gl_compatibility"\n')
    write_game(folder)
    PICTURES.mkdir(parents=True, exist_ok=True)
    (PICTURES / ".gdignore").touch()
    arguments = ["--path", folder, "--script", "res://player.gd", "--"]
    digests = set()
    with processes() as start:
        server = start(*arguments, "--server")
        server.wait_for("^ready$")
        one = start(*arguments, "12", "-7", "24", PICTURES / "tutorial_server_one.png", screen="--xvfb")
        other = start(*arguments, "12", "7", "24")
        digests |= {process.wait_for(r"^digest (-?\d+)$").group(1) for process in (one, other)}
        late = start(*arguments, "0", "0", "24", PICTURES / "tutorial_server_late.png", screen="--xvfb")
        digests.add(late.wait_for(r"^digest (-?\d+)$").group(1))
        for process in (one, late):
            process.wait_for("^taken$")
        (folder / "over").touch()
        digests.add(server.wait_for(r"^digest (-?\d+)$").group(1))
        other.end()
        server.end()
    assert len(digests) == 1
    views = [np.asarray(Image.open(PICTURES / f"tutorial_server_{who}.png").convert("L"), np.int16) for who in ("one", "late")]
    assert views[0].std() > 20 and np.abs(views[0] - views[1]).mean() < 1.0, "both players see the same trees"
