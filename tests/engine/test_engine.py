"""Runs the scripts in tests/engine with the real engine and checks its output and exit code."""

from __future__ import annotations

import re
import resource
import textwrap
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import REPO, new_project
from helpers.height_files import write_height_files
from tested_platforms import engine_of

ENGINE = REPO / "tests/engine"
PASSED = re.compile(r"^thicket engine tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)
COMPLAINT = re.compile(r"^(?:SCRIPT |USER )?(?:ERROR|WARNING)\b.*", re.MULTILINE)

SCENE = """[gd_scene format=3]

[ext_resource type="Script" path="res://in_editor.gd" id="1"]

[sub_resource type="ScatterGroundFlat" id="ground"]

[sub_resource type="BoxMesh" id="box"]

[sub_resource type="ScatterLayer" id="layer"]
radius = 1.0
tile_size = 32.0
view_distance = 100.0
meshes = Array[Mesh]([SubResource("box")])

[node name="Root" type="Node3D"]

[node name="Scatter" type="TerrainScatter3D" parent="."]
ground = SubResource("ground")
layers = Array[ScatterLayer]([SubResource("layer")])

[node name="Glade" type="ScatterRegion3D" parent="Scatter"]
shape = 1
exclude = true
radius = 20.0

[node name="Watcher" type="Node" parent="."]
script = ExtResource("1")
"""

# Floor for the scene above. Only ray casts can find it.
FLOOR_SHAPE = """[sub_resource type="BoxShape3D" id="floor"]
size = Vector3(150, 2, 90)

"""
FLOOR = """[node name="Floor" type="StaticBody3D" parent="."]

[node name="Shape" type="CollisionShape3D" parent="Floor"]
shape = SubResource("floor")

"""
COLLIDER_SCENE = SCENE.replace("ScatterGroundFlat", "ScatterGroundColliders")
for before, added in ('[node name="Root"', FLOOR_SHAPE), ('[node name="Watcher"', FLOOR):
    COLLIDER_SCENE = COLLIDER_SCENE.replace(before, added + before)

# Runs each example as a user would: adds nodes to a scene and calls _run() of editor scripts.
EXAMPLES = """extends SceneTree

func _initialize() -> void:
	for number in 3:
		var made: Object = load("res://example_%d.gd" % number).new()
		if made is Node:
			root.add_child(made)
			await create_timer(0.3).timeout
			made.queue_free()
			await made.tree_exited  # Not free(): the engine refuses it while a thread runs one of the node's methods.
		else:
			made.call("_run")
	print("examples: done")
	quit()
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    """Returns a new project that contains only the add-on."""
    return new_project(tmp_path_factory.mktemp("engine"))


@pytest.fixture(scope="module")
def jolt_project(tmp_path_factory) -> Path:
    """Returns a new project that uses Jolt Physics instead of Godot Physics."""
    return new_project(tmp_path_factory.mktemp("jolt"), '[physics]\n3d/physics_engine="Jolt Physics"\n')


def without_load_tokens(printed: str) -> str:
    """Returns the output of an engine with `--verbose`. Removes its leak report if that lists only tokens of threaded loads. The engine
    sometimes leaks such a token, a RefCounted without references: https://github.com/godotengine/godot/issues/120661."""
    listed = re.findall(r"^Leaked instance: (.*)$", printed, re.MULTILINE)
    if not listed or not all(re.fullmatch(r"RefCounted:\d+ - Reference count: 0", each) for each in listed):
        return printed
    return re.sub(r"^(Leaked instance|Hint: Leaked instances|WARNING: ObjectDB instances leaked).*\n", "", printed, flags=re.MULTILINE)


def assert_passed(done, loads_on_threads=False):
    printed = done.stdout + done.stderr
    if loads_on_threads:
        printed = without_load_tokens(printed)
    assert done.returncode == 0 and PASSED.search(done.stdout), printed
    assert "leaked" not in printed, printed


@pytest.mark.parametrize(
    "script",
    [
        "test_streaming",
        "test_bad_input",
        "test_problems",
        "test_changes",
        "test_queries",
        "test_threads",
        "test_snapshots",
        "test_explain",
        "test_navigation",
        "test_import_instances",
        "test_import_tables",
        "test_bake_models",
        "test_scene_digest",
        "test_tile_grid",
        "test_scenes",
        "test_scenes_misuse",
        "test_lifetime",
        "test_domain",
        "test_sample_surface",
        "test_domain_calls",
        "test_domain_cancel",
        "test_layer_inspector",
        "test_layer_arguments",
        "test_layer_list",
        "test_layer_properties",
        "test_layer_snapshot",
        "test_mask",
        "test_models",
        "test_model_materials",
        "test_model_fit", "test_model_parts",
        "test_model_layers",
        "test_stripped",
        "test_viewers",
        "test_world_offset",
        "test_terrains",
        "test_terrain_objects",
        "test_terrain_likes",
        "test_terrain3d",
        "test_terrain3d_changes",
        "test_hterrain",
        "test_hterrain_changes",
        "test_plugins",
        "test_terrabrush",
        "test_voxels",
        "test_terrain_calls",
        "test_ground_needs",
        "test_ground_recheck",
        "test_ground_meshes",
        "test_ground_shapes",
        "test_local_coords",
        "test_surface_layers",
        "test_planets",
        "test_planet_changes",
        "test_planet_masks",
        "test_planet_painting",
        "test_planet_regions",
        "test_layers_on_models",
        "test_ground_combined",
        "test_ground_combined_reports",
        "test_ground_heightmaps",
        "test_heightmaps",
        "test_expression_inputs",
        "test_layer_rules",
        "test_density_rules",
        "test_layer_placement",
        "test_regions",
        "test_rows",
        "test_saves",
        "test_former_names",
        "test_state",
        "test_callbacks",
        "test_state_async",
        "test_state_bulk",
        "test_state_handlers",
        "test_state_peers",
        "test_edits",
        "test_filled_layers",
        "test_neighbors",
        "test_biomes",
        "test_water",
        "test_sources",
        "test_build_rect",
        "test_kept_points",
        "test_presets",
        "test_debug_overlay",
        "test_impostors",
        "test_response",
    ],
)
def test_script(godot, project, script, record_property):
    done = godot(["--verbose", "--path", project, "--script", ENGINE / f"{script}.gd"], timeout=600)
    assert_passed(done)
    record_property("engine", engine_of(done.stdout))


@pytest.fixture(scope="module")
def threadless_project(tmp_path_factory) -> Path:
    """Returns a new project without worker threads, as in most web builds of the engine."""
    return new_project(tmp_path_factory.mktemp("threadless"), "[threading]\nworker_pool/max_threads=0\n")


@pytest.mark.parametrize("script", ["test_streaming", "test_terrain_calls", "test_state", "test_state_async", "test_ground_follows"])
def test_without_threads(godot, threadless_project, script):
    """Without worker threads, the main thread generates a few tiles per frame. The results are the same."""
    assert_passed(godot(["--verbose", "--path", threadless_project, "--script", ENGINE / f"{script}.gd"], timeout=600))


def test_lack_of_memory_is_reported_and_the_engine_continues(godot, project):
    """Limits the address space to 3 GB. The engine needs less than 1 GB."""

    def with_little_memory():
        resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))

    script = ENGINE / "test_out_of_memory.gd"
    assert_passed(godot(["--verbose", "--path", project, "--script", script], preexec_fn=with_little_memory))


@pytest.mark.parametrize("script", ["test_collision", "test_collision_contacts", "test_collision_reuse", "test_ground_follows",
                                    "test_removal_budget"])
@pytest.mark.parametrize("physics", ["project", "jolt_project"])
def test_bodies(godot, request, physics, script):
    folder = request.getfixturevalue(physics)
    assert_passed(godot(["--verbose", "--path", folder, "--script", ENGINE / f"{script}.gd"], timeout=600))


def test_a_model_from_an_asset_pack(godot, tmp_path):
    """The first process writes a file, the editor imports it, and a third process draws the model."""
    project = new_project(tmp_path)
    script = ENGINE / "test_imported_model.gd"
    assert_passed(godot(["--path", project, "--script", script, "--", "make"]))
    imported = godot(["--path", project, "--import"], timeout=120)
    assert imported.returncode == 0, imported.stdout + imported.stderr
    assert_passed(godot(["--verbose", "--path", project, "--script", script]))


def test_height_files_of_other_programs(godot, project, tmp_path):
    write_height_files(tmp_path)
    assert_passed(godot(["--verbose", "--path", project, "--script", ENGINE / "test_height_files.gd", "--", tmp_path]))


def test_felled_trees_stay_felled_in_the_next_engine(godot, project, tmp_path):
    script = ENGINE / "state_across_starts.gd"
    for part in ("test_save", "test_load"):
        assert_passed(godot(["--verbose", "--path", project, "--script", script, "--", part, tmp_path]))


def test_examples_of_the_class_reference_run(godot, project):
    """Runs PoissonSampler's examples: a window, a seamless pattern, and a large domain that is canceled."""
    text = ElementTree.parse(REPO / "extension/doc_classes/PoissonSampler.xml").getroot().findtext("description")
    examples = [textwrap.dedent(block) for block in re.findall(r"\[codeblock\]\n(.*?)\[/codeblock\]", text, re.DOTALL)]
    assert len(examples) == 3
    examples[0] = "extends Node\nfunc _ready() -> void:\n" + textwrap.indent(examples[0], "    ")
    examples[1] = examples[1].replace("extends EditorScript", "extends RefCounted")  # Only an editor can instantiate EditorScript.
    for number, example in enumerate(examples):
        (project / f"example_{number}.gd").write_text(example)
    (project / "examples.gd").write_text(EXAMPLES)
    done = godot(["--path", project, "--script", "examples.gd"], timeout=60)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and not COMPLAINT.search(printed), printed
    assert len(re.findall(r"^\(-?\d\S*, -?\d\S*\)$", printed, re.MULTILINE)) > 100, printed
    assert re.search(r"^\d+ %, \d+ points$", printed, re.MULTILINE), printed
    assert "\n0 points\n" in printed and "examples: done" in printed, printed
    assert (project / "dots.png").is_file()


def test_pixels(godot_xvfb, project):
    assert_passed(godot_xvfb(["--path", project, "--script", ENGINE / "test_pixels.gd"]))


def test_ground_rendered(godot_xvfb, project):
    assert_passed(godot_xvfb(["--path", project, "--script", ENGINE / "test_ground_rendered.gd"]))


def test_look(godot_xvfb, project):
    """Checks the instances that the renderer draws for each tile. Needs a real renderer, because the dummy renderer stores nothing."""
    assert_passed(godot_xvfb(["--path", project, "--script", ENGINE / "test_look.gd"]))


RENDERERS = {
    "compatibility": [],
    "forward_plus": ["--rendering-method", "forward_plus", "--rendering-driver", "vulkan"],
    "mobile": ["--rendering-method", "mobile", "--rendering-driver", "vulkan"],
}


@pytest.mark.parametrize("renderer", RENDERERS)
def test_screenshots_of_models(godot_xvfb, project, renderer):
    """Draws the models with each renderer, in software."""
    arguments = [*RENDERERS[renderer], "--path", project, "--script", ENGINE / "test_model_pictures.gd"]
    assert_passed(godot_xvfb(arguments))


@pytest.mark.parametrize("renderer", RENDERERS)
def test_foliage(godot_xvfb, project, renderer):
    """The add-on's material compiles, fades, sways, bends, tints and casts shadows in each renderer."""
    script = ENGINE / "test_foliage.gd"
    assert_passed(godot_xvfb([*RENDERERS[renderer], "--path", project, "--script", script], timeout=120))


@pytest.mark.parametrize("renderer", RENDERERS)
def test_cross_fade(godot_xvfb, project, renderer):
    """LODs cross-fade, and instances fade out at the view distance."""
    script = ENGINE / "test_cross_fade.gd"
    assert_passed(godot_xvfb([*RENDERERS[renderer], "--path", project, "--script", script], timeout=240))


@pytest.mark.parametrize("renderer", RENDERERS)
def test_high_cameras(godot_xvfb, project, renderer):
    """Instances are visible to high cameras, to orthogonal cameras, and to cameras that are not viewers."""
    script = ENGINE / "test_high_cameras.gd"
    assert_passed(godot_xvfb([*RENDERERS[renderer], "--path", project, "--script", script], timeout=240))


FOLIAGE_SCENE = """[gd_scene format=3]

[ext_resource type="Script" path="res://addons/thicket/shaders/foliage_world.gd" id="1"]

[ext_resource type="Script" path="res://foliage_in_editor.gd" id="2"]

[ext_resource type="Shader" path="res://addons/thicket/shaders/foliage.gdshader" id="3"]

[sub_resource type="ShaderMaterial" id="found"]
shader = ExtResource("3")

[sub_resource type="ShaderMaterial" id="listed"]
shader = ExtResource("3")
shader_parameter/wind_strength = 0.75

[sub_resource type="BoxMesh" id="box"]

[sub_resource type="ScatterLayer" id="layer"]
meshes = [SubResource("box")]
material_override = SubResource("found")

[node name="Root" type="Node3D"]

[node name="Scatter" type="TerrainScatter3D" parent="."]
layers = Array[ScatterLayer]([SubResource("layer")])

[node name="World" type="Node3D" parent="."]
script = ExtResource("1")
materials = Array[ShaderMaterial]([SubResource("listed")])
wind_strength = 0.5

[node name="Watcher" type="Node" parent="."]
script = ExtResource("2")
"""


def test_foliage_in_the_editor(godot_xvfb, tmp_path):
    """The editor shows wind without changing any material."""
    project = new_project(tmp_path)  # A separate project, because the editor reopens the scene at the next start.
    (project / "foliage_in_editor.gd").write_text((ENGINE / "foliage_in_editor.gd").read_text())
    (project / "foliage.tscn").write_text(FOLIAGE_SCENE)
    done = godot_xvfb(["--editor", "--path", project, "foliage.tscn", "--quit-after", "20000"], timeout=120)
    printed = done.stdout + done.stderr
    assert "shown: [0.5, 0.5]\n" in printed, printed
    assert re.search(r"^kept: \[(1.0|<null>), 0.75\]$", printed, re.MULTILINE), printed  # 1.0 is the shader's default.
    assert re.search(r"^without the world: \[(1.0|<null>), 0.75\]$", printed, re.MULTILINE), printed
    assert done.returncode == 0, printed


def test_draw_cells(godot_xvfb, project):
    """Checks the instances that are drawn for tiles with cells. Screenshots must not reveal the division into cells."""
    assert_passed(godot_xvfb(["--verbose", "--path", project, "--script", ENGINE / "test_draw_cells.gd"]))


def test_the_harness_can_fail(godot, project):
    done = godot(["--path", project, "--script", ENGINE / "failing.gd"])
    assert done.returncode == 1
    assert len(re.findall(r"^FAILED test_", done.stdout, re.MULTILINE)) == 4, done.stdout
    assert not PASSED.search(done.stdout)


@pytest.mark.parametrize("frames", [0, 1, 2, 5, 20, 80])
def test_quitting_during_generation(godot, project, frames):
    arguments = ["--verbose", "--path", project, "--script", ENGINE / "quit_midway.gd", "--", str(frames)]
    done = godot(arguments, timeout=60)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and "thicket quits in mid-generation" in done.stdout, printed
    assert "leaked" not in printed, printed
    assert not COMPLAINT.search(printed), printed


def test_loading_in_the_background(godot, project):
    """The main thread waits for loading threads, so a setter that waited for the main thread would cause a deadlock."""
    done = godot(["--verbose", "--path", project, "--script", ENGINE / "background_load.gd"], timeout=60)
    assert_passed(done, loads_on_threads=True)


@pytest.mark.parametrize("frames", [0, 2, 5, 10])
def test_quitting_while_a_scene_loads(godot, project, frames):
    """The engine waits for its loader on exit. The loaded scene may leak, because no code has retrieved it."""
    done = godot(["--path", project, "--script", ENGINE / "quit_loading.gd", "--", str(frames)], timeout=60)
    assert done.returncode == 0 and "thicket quits while it loads" in done.stdout, done.stdout + done.stderr


def test_demo(godot, core_tool, imported_demo, tmp_path):
    """Streams the demo's forest and checks it. Then the core alone must generate bit-identical tiles."""
    listed = tmp_path / "tiles.txt"
    script = ENGINE / "test_demo.gd"
    assert_passed(godot(["--verbose", "--path", imported_demo, "--script", script, "--", f"out={listed}"], timeout=600))

    made = core_tool("analysis/tile_digests", listed)
    counted = re.search(r"^tile_digests: (\d+) tiles, (\d+) instances, 0 differ$", made.stdout, re.MULTILINE)
    assert made.returncode == 0 and counted, made.stdout + made.stderr
    assert int(counted.group(1)) > 1000 and int(counted.group(2)) >= 100_000

    lines = listed.read_text().splitlines()
    first_tile = next(number for number, line in enumerate(lines) if line.startswith("tile "))
    last = lines[first_tile][-1]
    lines[first_tile] = lines[first_tile][:-1] + ("2" if last == "1" else "1")
    tampered = tmp_path / "tampered.txt"
    tampered.write_text("\n".join(lines))
    assert core_tool("analysis/tile_digests", tampered).returncode == 1, "a wrong digest must be detected"


@pytest.mark.parametrize(("scene", "least"), [(SCENE, 10_000), (COLLIDER_SCENE, 5_000)], ids=["flat", "colliders"])
def test_editor_shows_and_reloads(scene, least, godot, project):
    """In the editor, tiles stream around the editor's camera, and continue to do so after the extension is reloaded."""
    (project / "in_editor.gd").write_text((ENGINE / "in_editor.gd").read_text())
    (project / "scene.tscn").write_text(scene)
    done = godot(["--editor", "--path", project, "scene.tscn", "--quit-after", "20000"], timeout=120)
    printed = done.stdout + done.stderr
    shown = re.search(r"in the editor: (\d+) tiles, (\d+) instances", printed)
    assert shown and int(shown.group(2)) > least, printed
    assert "children of the scatter: 1\n" in printed
    limited = [int(count) for count in re.findall(r"limited preview: (\d+) instances", printed)]
    assert len(limited) == 2 and limited[0] <= 1000 and 500 < limited[1], printed
    assert "heightmap: (5, 5), 3.0 to 9.0 m\n" in printed, printed
    assert "reload: 0" in printed, printed
    assert f"after reloading: {shown.group(1)} tiles, {shown.group(2)} instances" in printed, printed
    complaints = [line for line in COMPLAINT.findall(printed) if "X509" not in line]
    assert done.returncode == 0 and not complaints, printed
