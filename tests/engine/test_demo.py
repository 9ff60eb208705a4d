"""Tests the demo's main scene and the screenshots that it takes on a virtual display."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from conftest import REPO
from helpers.engine_output import complaints
from PIL import Image

DEMO = REPO / "demo_project"
TERRAIN = DEMO / "terrain"
PICTURES = REPO / "build/demo"


def test_scene_contains_only_settings():
    scene = DEMO / "demo.tscn"
    text = scene.read_text()
    assert scene.stat().st_size < 100_000
    assert not re.search(r"MultiMesh|PackedByteArray|_surfaces|transform_array|buffer =", text)


def test_scene_and_description_have_the_same_ground():
    description = json.loads((TERRAIN / "jacksboro.json").read_text())
    text = (DEMO / "demo.tscn").read_text()
    rect = [float(part) for part in re.search(r"^rect = Rect2\((.*)\)$", text, re.MULTILINE).group(1).split(",")]
    size = [description["size_x"], description["size_z"]]
    assert rect == [-size[0] / 2, -size[1] / 2, *size]
    for name in ("min_height", "max_height"):
        written = re.search(rf"heightmap_path = [^\[]*^{name} = (.*)$", text, re.MULTILINE).group(1)
        assert float(written) == description[name]
    assert f"post_count = Vector2i({description['columns']}, {description['rows']})" in text


def test_demo_runs_without_a_renderer(godot, imported_demo):
    """The demo's fixed path, headless: no warnings, no leaks, and more than 10^5 instances at each stop."""
    completed = godot(["--verbose", "--path", imported_demo, "--", "--screenshots"], timeout=300)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    assert "leaked" not in printed
    instances = re.findall(r"^demo: \w+: \d+ tiles, (\d+) instances", completed.stdout, re.MULTILINE)
    assert len(instances) >= 5 and min(map(int, instances)) > 100_000
    assert re.search(r"^demo: main thread: median \d+ µs, p99 \d+ µs", completed.stdout, re.MULTILINE)


def test_plants_are_the_same_on_every_run(godot, imported_demo, tmp_path):
    """Two processes build bit-identical meshes. A saved mesh contains only its settings."""
    script = tmp_path / "plants.gd"
    script.write_text(PLANTS.replace("OUT", str(tmp_path)))
    runs = [godot(["--path", imported_demo, "--script", script], timeout=120) for _ in range(2)]
    digests = [re.findall(r"^plant .*$", completed.stdout, re.MULTILINE) for completed in runs]
    assert digests[0] == digests[1]
    assert len(digests[0]) == len(set(digests[0])) == 48, runs[0].stdout + runs[0].stderr
    assert not complaints(runs[0].stdout + runs[0].stderr)
    for line in digests[0]:
        triangles = [int(count) for count in re.search(r"triangles (.*)$", line).group(1).split()]
        assert triangles == sorted(triangles, reverse=True) and 0 < triangles[-1] <= 120, line
    saved = (tmp_path / "plant.tres").read_text()
    assert "variant = 1" in saved and "_surfaces" not in saved and len(saved) < 1000


def test_models_of_the_presets_are_those_of_the_scripts(godot, imported_demo, tmp_path):
    """The add-on's models match those that demo_project/meshes builds. To fix a difference, run bash
    demo_project/meshes/save_models.sh."""
    made = tmp_path / "models"
    completed = godot(["--headless", "--path", imported_demo, "--script", "res://meshes/save_models.gd", "--", f"--out={made}"], timeout=240)
    assert "models saved" in completed.stdout, completed.stdout + completed.stderr
    script = tmp_path / "compare.gd"
    script.write_text(COMPARE.replace("MADE", str(made)))
    completed = godot(["--headless", "--path", imported_demo, "--script", script], timeout=240)
    assert "models: 0 differ" in completed.stdout, completed.stdout + completed.stderr


COMPARE = """extends SceneTree

const SAVED := "res://addons/thicket/presets/plants/"


func _init() -> void:
	var differing := PackedStringArray()
	var names := Array(DirAccess.get_files_at(SAVED)).filter(func(file: String) -> bool: return file != "atlas.res")
	if names != Array(DirAccess.get_files_at("MADE")):
		differing.append("the files")
	for file: String in DirAccess.get_files_at("MADE"):
		if not is_same_model(load("MADE/" + file), load(SAVED + file)):
			differing.append(file)
	print("models: %d differ %s" % [differing.size(), differing])
	quit()


func is_same_model(a: ScatterModel, b: ScatterModel) -> bool:
	if b == null or a.lods.size() != b.lods.size() or a.shapes.size() != b.shapes.size():
		return false
	for index in a.lods.size():
		var one := a.lods[index].mesh.surface_get_arrays(0)
		var other := b.lods[index].mesh.surface_get_arrays(0)
		var material := a.lods[index].mesh.surface_get_material(0)
		if a.lods[index].distance != b.lods[index].distance or material != b.lods[index].mesh.surface_get_material(0):
			return false
		if one[Mesh.ARRAY_INDEX] != other[Mesh.ARRAY_INDEX] or one[Mesh.ARRAY_VERTEX].size() != other[Mesh.ARRAY_VERTEX].size():
			return false
		for at: int in one[Mesh.ARRAY_VERTEX].size(): # Processors may round sines differently.
			if not one[Mesh.ARRAY_VERTEX][at].is_equal_approx(other[Mesh.ARRAY_VERTEX][at]):
				return false
	return true
"""


PLANTS = """extends SceneTree


func _init() -> void:
	var plant_mesh: GDScript = load("res://meshes/plant_mesh.gd")
	for species: String in load("res://meshes/species.gd").SCRIPTS:
		for variant in 2:
			var mesh: ArrayMesh = plant_mesh.new()
			mesh.set(&"species", species)
			mesh.set(&"variant", variant)
			mesh.call(&"_build")
			var arrays := mesh.surface_get_arrays(0)
			var levels := [arrays[Mesh.ARRAY_INDEX].size() / 3]
			for level: Dictionary in RenderingServer.mesh_get_surface(mesh.get_rid(), 0).get("lods", []):
				levels.append(level.index_data.size() / (2 if arrays[Mesh.ARRAY_VERTEX].size() < 65536 else 4) / 3)
			var digest := var_to_bytes(arrays).hex_encode().md5_text()
			print("plant %s %d %s triangles %s" % [species, variant, digest, " ".join(levels)])
			if species == "oak" and variant == 1:
				ResourceSaver.save(mesh, "OUT/plant.tres")
	quit()
"""


def test_keys(godot, imported_demo, tmp_path):
    """Presses the keys that the overlay's help lists: seeds, density, walking, tiles, help. The drawn ground equals the plants' ground."""
    script = tmp_path / "keys.gd"
    script.write_text(KEYS)
    completed = godot(["--path", imported_demo, "--script", script], timeout=240)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "keys: 0 failed" in completed.stdout, printed
    assert not complaints(printed), complaints(printed)


KEYS = """extends SceneTree

var failed := 0
var demo: Node3D


func check(holds: bool, what: String) -> void:
	if not holds:
		failed += 1
		print("FAILED ", what)


func press(key: Key) -> void:
	var event := InputEventKey.new()
	event.keycode = key
	event.physical_keycode = key
	event.pressed = true
	root.push_input(event)


func idle() -> void:
	for frame in 5:
		await process_frame
	while not demo.scatter.is_settled():
		await process_frame


func _init() -> void:
	run.call_deferred()


func run() -> void:
	demo = (load("res://demo.tscn") as PackedScene).instantiate()
	root.add_child(demo)
	await idle()
	var scatter: Node3D = demo.scatter
	var all: int = scatter.get_stats().instances
	var tile: Vector2i = scatter.get_shown_tiles(scatter.layers[0])[0]
	var ids: PackedInt64Array = scatter.get_tile(scatter.layers[0], tile).get_ids(0)
	press(KEY_N)
	await idle()
	check(scatter.seed == 8, "N: next seed")
	check(scatter.get_tile(scatter.layers[0], tile).get_ids(0) != ids, "N: other trees")
	press(KEY_B)
	await idle()
	check(scatter.get_tile(scatter.layers[0], tile).get_ids(0) == ids, "B: the same trees again")
	for step in 5:
		press(KEY_MINUS)
	await idle()
	var half := float(scatter.get_stats().instances) / all
	check(half > 0.45 and half < 0.55, "-: half of the instances must be left, not %.3f" % half)
	for step in 10:
		press(KEY_MINUS)
	await idle()
	check(scatter.get_stats().instances == 0, "-: no instances at density 0")
	for step in 12:
		press(KEY_EQUAL)
	await idle()
	check(scatter.get_stats().instances == all, "+: all instances again")

	var camera := demo.get_node("Camera") as Camera3D
	var ground: float = scatter.ground.get_height(camera.position)
	press(KEY_F)
	check(absf(camera.position.y - ground - 1.75) < 0.01, "F: eyes 1.75 m above the ground")
	press(KEY_F)
	var borders := demo.get_node("TileBorders") as MeshInstance3D
	press(KEY_T)
	await process_frame
	await process_frame
	check(borders.visible and borders.mesh.get_surface_count() == 1, "T: borders of tiles")
	var help := demo.get_node("Overlay/Panel/Rows/Help") as Label
	press(KEY_H)
	check(not help.visible, "H: the help is hidden")

	var elevation: RefCounted = demo.get_node("Terrain").elevation
	var rng := RandomNumberGenerator.new()
	rng.seed = 5
	var worst := 0.0
	for i in 2000:
		var x := rng.randf_range(elevation.rect.position.x, elevation.rect.end.x)
		var z := rng.randf_range(elevation.rect.position.y, elevation.rect.end.y)
		worst = maxf(worst, absf(elevation.height(x, z) - scatter.ground.get_height(Vector3(x, 0.0, z))))
	check(worst < 0.01, "one ground for drawing and for plants: %.4f m apart" % worst)
	check(is_nan(elevation.height(elevation.rect.end.x + 1.0, 0.0)), "no ground outside")
	print("keys: %d failed" % failed)
	demo.queue_free()
	await process_frame
	quit(failed)
"""


def test_ground_has_no_holes(godot_xvfb, imported_demo, tmp_path):
    """Replaces the background with magenta. In views from all over the map, no magenta may be visible through the ground."""
    script = tmp_path / "holes.gd"
    script.write_text(HOLES.replace("OUT", str(tmp_path)))
    completed = godot_xvfb(["--path", imported_demo, "--resolution", "480x270", "--script", script], timeout=300)
    shots = [np.asarray(Image.open(path).convert("RGB"), np.int16) for path in sorted(tmp_path.glob("*.png"))]
    assert completed.returncode == 0 and len(shots) == 24, completed.stdout + completed.stderr
    skies = 0
    for shot in shots:
        behind = (shot[..., 0] > 200) & (shot[..., 1] < 100) & (shot[..., 2] > 200)
        below_ground = np.logical_or.accumulate(~behind, axis=0)
        assert not (behind & below_ground).any()
        assert behind.mean() < 0.8
        skies += behind.any()
    assert skies >= 6, "the horizon must be in the views, or the background color is wrong"


HOLES = """extends SceneTree


func _init() -> void:
	run.call_deferred()


func run() -> void:
	RenderingServer.render_loop_enabled = false
	var demo := (load("res://demo.tscn") as PackedScene).instantiate()
	root.add_child(demo)
	demo.show_overlay(false)
	for layer in demo.scatter.layers:
		layer.density = 0.0
	var environment := (demo.get_node("WorldEnvironment") as WorldEnvironment).environment
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color.MAGENTA
	environment.fog_enabled = false
	root.msaa_3d = Viewport.MSAA_DISABLED
	var rng := RandomNumberGenerator.new()
	rng.seed = 9
	for view in 24:
		var above: float = [2.0, 30.0, 200.0, 800.0][view % 4]
		var eye := Vector3(rng.randf_range(-12000.0, 12000.0), above, rng.randf_range(-12000.0, 12000.0))
		demo.place({"eye": eye, "heading": rng.randf() * 360.0, "pitch": [0.0, -8.0, -15.0, -30.0][view % 4]})
		await process_frame
		await process_frame
		RenderingServer.render_loop_enabled = true
		await RenderingServer.frame_post_draw
		await RenderingServer.frame_post_draw
		RenderingServer.render_loop_enabled = false
		root.get_texture().get_image().save_png("OUT/view_%02d.png" % view)
	RenderingServer.render_loop_enabled = true
	demo.queue_free()
	await process_frame
	quit()
"""


@pytest.fixture(scope="module")
def pictures(godot_xvfb, imported_demo) -> dict[str, np.ndarray]:
    """Returns the screenshots of a run on a virtual display, by name: arrays of height by width by RGB, 0 to 255."""
    for old in PICTURES.glob("*.png"):
        old.unlink()
    arguments = ["--path", imported_demo, "--resolution", "1280x720", "--", f"--screenshots={PICTURES}"]
    completed = godot_xvfb(arguments, timeout=900)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    return {path.stem: np.asarray(Image.open(path).convert("RGB"), np.float64) for path in PICTURES.glob("*.png")}


def is_a_picture(image: np.ndarray, least_green: float = 0.25) -> str:
    """Returns the reason why an image does not look like a landscape with at least this fraction of green pixels; empty if it
    does."""
    gray = image.mean(axis=2)
    share, _ = np.histogram(gray, bins=64, range=(0, 256))
    share = share[share > 0] / gray.size
    entropy = -(share * np.log2(share)).sum()
    detail = np.abs(np.diff(gray, axis=1)).mean()
    red, green, blue = image[..., 0], image[..., 1], image[..., 2]
    greens = ((green > red) & (green > blue * 1.05)).mean()
    checks = {
        f"entropy {entropy:.2f} bits": entropy > 3.5,
        f"standard deviation {gray.std():.1f}": gray.std() > 20.0,
        f"neighbors differ by {detail:.2f}": 1.5 < detail < 25.0,
        f"{greens:.0%} green": greens > least_green,
        f"mean {gray.mean():.0f}": 40.0 < gray.mean() < 210.0,
        f"{(gray < 4).mean():.0%} black": (gray < 4).mean() < 0.1,
    }
    return ", ".join(what for what, good in checks.items() if not good)


def test_screenshots_show_landscapes(pictures):
    assert {"overview", "forest", "walk", "stones", "tiles"} <= pictures.keys()
    for name, image in pictures.items():
        assert image.shape == (720, 1280, 3)
        assert not is_a_picture(image), f"{name}: {is_a_picture(image)}"


def test_screenshots_have_a_sky(pictures):
    """The upper border is blue, and brighter and smoother than the lower one."""
    for name in ("overview", "forest", "walk", "stones"):
        top, bottom = pictures[name][:60], pictures[name][-160:]
        columns = top[..., 2].mean(axis=0) - top[..., 0].mean(axis=0)
        assert np.median(columns) > 15.0, f"{name}: no blue above"
        assert top.mean() > bottom.mean() + 15.0, f"{name}: the sky is not brighter than the ground"


def test_screenshots_differ(pictures):
    names = sorted(pictures)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            assert np.abs(pictures[first] - pictures[second]).mean() > 10.0, f"{first} and {second} look the same"


@pytest.mark.full
@pytest.mark.parametrize("method", ["forward_plus", "mobile"])
def test_other_renderers_draw_the_same_colors(godot_xvfb, imported_demo, pictures, tmp_path, method):
    """Forward+ and Mobile compute light in linear space. Materials, light and haze must look the same as in the Compatibility renderer."""
    stops = ["overview", "forest", "walk"]
    renderer = ["--rendering-driver", "vulkan", "--rendering-method", method, "--resolution", "640x360"]
    arguments = ["--path", imported_demo, *renderer, "--", f"--screenshots={tmp_path}", f"--stops={','.join(stops)}"]
    completed = godot_xvfb(arguments, timeout=900)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "demo: done" in completed.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)

    def coarse(image: Image.Image) -> np.ndarray:
        return np.asarray(image.convert("RGB").resize((64, 36), Image.Resampling.BOX), np.float64)

    for name in stops:
        here = coarse(Image.fromarray(pictures[name].astype(np.uint8)))
        there = Image.open(tmp_path / f"{name}.png")
        assert not is_a_picture(np.asarray(there.convert("RGB"), np.float64)), name
        apart = np.abs(coarse(there) - here).mean()
        assert apart < 20.0, f"{name}: colors differ by {apart:.1f} of 255"
