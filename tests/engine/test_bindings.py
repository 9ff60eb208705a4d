"""Tests the bindings. The extension loads, unloads and reloads cleanly, in a game and in the editor. Scripts see our classes as declared.
Engine code compiles with godot-cpp and with our replacement for it, the stand-in."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import BUILD_DIR, CACHE, REPO, check_engine_tests, run

ADDON = REPO / "demo_project/addons/thicket"
BINDINGS = REPO / "extension/bindings"
NODES = [path for path in sorted((REPO / "extension/nodes").rglob("*")) if path.suffix in (".hpp", ".cpp")]
SCRIPTS = REPO / "tests/engine/bindings"
CLASSES = sorted(path.stem for path in (REPO / "extension/doc_classes").glob("*.xml"))

PROJECT = """config_version=5

[application]

config/name="Bindings"

[editor_plugins]

enabled=PackedStringArray("res://addons/steps/plugin.cfg")
"""
SCENE = """[gd_scene format=3]

[node name="Scatter" type="TerrainScatter3D"]
"""
KINDS = (".py", ".hpp", ".inc", ".cpp")
# Errors, warnings and leak reports in an engine's output.
COMPLAINTS = re.compile(r"ERROR|WARNING|[Ll]eak|Orphan|unclaimed|still in use|RID allocations|crashed|corrupted")


def make_project(folder: Path, extension: bool) -> Path:
    """Creates a project with an editor plugin that runs a test's steps, with or without the extension."""
    folder.mkdir()
    (folder / "project.godot").write_text(PROJECT)
    shutil.copytree(SCRIPTS, folder / "addons/steps", ignore=shutil.ignore_patterns("test_*"))
    if extension:
        shutil.copytree(ADDON, folder / "addons/thicket")
        (folder / "scatter.tscn").write_text(SCENE)
        (folder / ".godot").mkdir()
        (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    return folder


@pytest.fixture
def project(tmp_path) -> Path:
    return make_project(tmp_path / "project", extension=True)


def complaints(output: str) -> list[str]:
    """Returns the complaints in an engine's output, without the V-Sync warning that a virtual display causes."""
    return [line for line in output.splitlines() if COMPLAINTS.search(line) and "V-Sync" not in line]


@pytest.mark.parametrize("display", ["godot", "godot_xvfb"])
def test_scripts_access_our_classes_and_nothing_leaks(display, project, request):
    """Runs a game that covers all uses from scripts. On exit, the engine must report no leaks in verbose mode. Also runs with a
    renderer, because only a real one counts its resources."""
    play = request.getfixturevalue(display)
    completed = play(["--verbose", "--path", project, "--script", SCRIPTS / "test_language.gd"])
    assert completed.returncode == 0, completed.stdout[-6000:] + completed.stderr[-2000:]
    assert re.search(r"thicket engine tests: \d{3,} checks, 0 failed", completed.stdout)
    caused = "from _get_heights()", "'PoissonSampler::sample_domain': Cannot convert argument 1"
    unexpected = [line for line in complaints(completed.stdout + completed.stderr) if not any(part in line for part in caused)]
    assert not unexpected, "\n".join(unexpected)


def test_a_leak_is_detected(godot_xvfb, project):
    """An engine with a leak prints the lines that the test above searches for."""
    script = project / "leak.gd"
    leaks = "TerrainScatter3D.new()", "RenderingServer.multimesh_create()", "quit()"
    script.write_text("extends SceneTree\nfunc _init():\n\t" + "\n\t".join(leaks) + "\n")
    completed = godot_xvfb(["--verbose", "--path", project, "--script", script])
    seen = "\n".join(complaints(completed.stdout + completed.stderr))
    assert "Leaked instance" in seen and "1 RID allocations" in seen and "Orphan StringName" in seen


def editor(godot, project: Path, *steps: str) -> str:
    # Each project has its own user folders, because the editor stores the class reference and its open tabs there.
    environment = {
        **os.environ,
        "THICKET_CACHE": str(CACHE),
        "XDG_CACHE_HOME": str(project / "cache"),
        "XDG_CONFIG_HOME": str(project / "config"),
        "XDG_DATA_HOME": str(project / "data"),
    }
    completed = godot(["--verbose", "--editor", "--path", project, "--", *steps], timeout=600, env=environment)
    output = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "\ndone\n" in output, output[-6000:]
    return output


@pytest.fixture(scope="module")
def plain_editor(godot, tmp_path_factory) -> set[str]:
    """Returns the complaints of an editor without the extension."""
    project = make_project(tmp_path_factory.mktemp("plain") / "project", extension=False)
    return set(complaints(editor(godot, project)))


@pytest.fixture(scope="module")
def whole_editor(godot, tmp_path_factory) -> str:
    """Returns the output of an editor that reloads the library under a live node, and opens our help pages and scenes."""
    project = make_project(tmp_path_factory.mktemp("whole") / "project", extension=True)
    return editor(godot, project, "reload", "help", "preview", "warnings")


def test_editor_loads_and_unloads_without_a_complaint(plain_editor, whole_editor):
    ours = [line for line in complaints(whole_editor) if line not in plain_editor]
    assert not ours, "\n".join(ours)


def test_reload_keeps_live_nodes(whole_editor):
    rounds = re.findall(r"^round \d: (.*)$", whole_editor, re.MULTILINE)
    assert len(rounds) == 3
    assert set(rounds) == {"seed 42, terrain true at 7.0, radius 3.5, 1 mesh, rules true"}
    assert whole_editor.count("instances: true") == 3


def test_class_reference_is_displayed_in_the_editor(whole_editor):
    pages = dict(re.findall(r"^help (\w+): (.*)$", whole_editor, re.MULTILINE))
    assert sorted(pages) == CLASSES
    for name, page in pages.items():
        root = ElementTree.parse(REPO / f"extension/doc_classes/{name}.xml").getroot()
        brief = re.sub(r"\[(?:\w+ )?([\w.]+)\]", r"\1", root.findtext("brief_description").strip())
        assert brief in page
        assert "no description" not in page and "There is currently" not in page, page


def test_the_inspector_offers_no_former_class(whole_editor):
    offered = re.search(r"^grounds: (.*)$", whole_editor, re.MULTILINE).group(1).split(", ")
    assert "ScatterGroundFlat" in offered and not [name for name in offered if name.startswith("ScatterTerrain")], offered


def test_editor_shows_configuration_warnings(whole_editor):
    """The engine calls our override of one of its virtual methods."""
    assert re.search(r"^button of Scatter: .*No ground", whole_editor, re.MULTILINE | re.IGNORECASE)


def test_preview_draws_at_most_preview_instances(whole_editor):
    """The editor draws at most preview_instances, and at least 65 % of this number if there are enough instances. Changing the limit uploads nothing."""
    figure = r"^preview of (\d+): (\d+) drawn of (\d+), at most (\d+), (\d+) uploads$"
    rows = [[int(number) for number in row] for row in re.findall(figure, whole_editor, re.MULTILINE)]
    assert [row[0] for row in rows] == [5000, 800, 0, 20000, 10**9]
    for limit, drawn, standing, most, uploads in rows:
        assert standing > 50_000 and standing == rows[0][2] and uploads == rows[0][4]
        assert most <= limit and 0.65 * min(limit, standing) <= drawn <= min(limit, standing)
    assert rows[-1][1] == rows[-1][2]


def described(path: Path) -> dict[str, str]:
    """Returns {member with its types: description} for a page of the class reference."""
    root = ElementTree.parse(path).getroot()
    found = {f"class {root.get('name')} of {root.get('inherits')}": root.findtext("description")}
    for item in root.iterfind("*/*[@name]"):
        types = [(part.get("name"), part.get("type")) for part in item.iterfind("param")]
        result = item.find("return").get("type") if item.find("return") is not None else item.get("type")
        text = item.text if item.tag in ("member", "constant") else item.findtext("description")
        found[f"{item.tag} {item.get('name')}{types} {result} {item.get('qualifiers')}"] = text
    return found


def defaults(path: Path) -> dict[str, str]:
    """Returns {property: default} for a page of the class reference, without empty defaults, because the engine's pages omit some of them."""
    members = {item.get("name"): item.get("default") for item in ElementTree.parse(path).getroot().iterfind("members/member")}
    return {name: default for name, default in members.items() if default and default != "<null>" and not default.endswith("()")}


def test_class_reference_is_complete(godot, project):
    """The engine lists the same members, arguments, types and defaults as our pages, and every member has a description."""
    pages = project / "reference"
    (pages / "doc_classes").mkdir(parents=True)
    completed = godot(["--path", project, "--doctool", pages, "--gdextension-docs"])
    assert completed.returncode == 0, completed.stdout + completed.stderr
    written = {path.stem: described(path) for path in (pages / "doc_classes").glob("*.xml")}
    ours = {name: described(REPO / f"extension/doc_classes/{name}.xml") for name in CLASSES}
    assert {name: sorted(page) for name, page in ours.items()} == {name: sorted(page) for name, page in written.items()}
    listed = {name: (defaults(pages / f"doc_classes/{name}.xml"), defaults(REPO / f"extension/doc_classes/{name}.xml")) for name in CLASSES}
    listed = {name: both for name, both in listed.items() if both[0]}  # The engine does not list defaults of classes that scripts cannot instantiate.
    assert len(listed) >= 15 and not {name: both for name, both in listed.items() if both[0] != both[1]}
    texts = {f"{name}: {what}": text or "" for name, page in ours.items() for what, text in page.items()}
    assert not [what for what, text in texts.items() if not text.strip()]


# --- The generator -----------------------------------------------------------------------------------------------------


def generate(*arguments) -> subprocess.CompletedProcess[str]:
    return run([sys.executable, BINDINGS / "generate.py", *arguments], timeout=120)


def test_the_bindings_provide_only_what_is_used():
    completed = generate("--used", BINDINGS / "used_api.toml", "--unused", REPO / "extension/nodes", BINDINGS / "src",
        BINDINGS / "include")  # fmt: skip
    assert completed.returncode == 0, completed.stdout


def test_the_stand_in_stays_small():
    """The stand-in and its generator have fewer than 2600 lines, without comments, includes and blank lines. No file has more than 400 lines."""
    texts = {path: path.read_text(encoding="utf-8") for path in BINDINGS.rglob("*") if path.suffix in KINDS}
    code = sum(len(re.findall(r"^\s*(?!//|#include|#pragma)\S", text, re.MULTILINE)) for text in texts.values())
    assert code < 2600, code
    assert not [str(path) for path, text in texts.items() if text.count("\n") > 400]


# --- godot-cpp ---------------------------------------------------------------------------------------------------------


def test_engine_code_has_no_switch_between_bindings():
    assert len(NODES) > 50
    for path in NODES:
        assert not re.search(r"^\s*#\s*(if|ifdef|ifndef|elif)\b", path.read_text(encoding="utf-8"), re.MULTILINE), path


def test_every_included_header_exists_in_the_bindings():
    """Every header that engine code includes is part of the stand-in, either hand-written or generated."""
    used = tomllib.loads((BINDINGS / "used_api.toml").read_text())
    listed = generate("--used", BINDINGS / "used_api.toml", "--out", "gen", "--list").stdout
    assert used["classes"]
    for path in NODES:
        for name in re.findall(r"#include <(godot_cpp/[^>]+)>", path.read_text(encoding="utf-8")):
            offered = (BINDINGS / "include" / name).is_file() or f"include/{name}" in listed
            assert offered, f"{path.name} includes {name}"


REFUSED = {
    "a Ref's assignment has no value": "Ref<Image> keep(Ref<Image> &r_to, const Ref<Image> &p_from) { return r_to = p_from; }",
    "a Ref is not assigned from {}": "void empty(Ref<Image> &r_image) { r_image = {}; }",
    "a Ref is not assigned from a pointer": "void take(Ref<Image> &r_image, Image *p_image) { r_image = p_image; }",
    "a Ref is not assigned from null": "void clear(Ref<Image> &r_image) { r_image = nullptr; }",
    "a String is not assigned from {}": "void empty(String &r_text) { r_text = {}; }",
    "a const String and a text are not added": 'String add(const String &p_text) { return p_text + "text"; }',
    "a CharString is not created from a std::string": "CharString text() { return CharString(std::string()); }",
    "algorithms do not search packed arrays": "auto find(const PackedFloat32Array &p_array) { return std::ranges::find(p_array, 1.0F); }",
    "algorithms do not copy packed arrays": "void copy(const PackedFloat32Array &p_from, float *r_to) { std::ranges::copy(p_from, r_to); }",
    "a packed array is no span": "std::span<const float> all(const PackedFloat32Array &p_array) { return p_array; }",
    "iterators of packed arrays have no sum": "float second(const PackedFloat32Array &p_array) { return *(p_array.begin() + 1); }",
    "a Vector2i is not created from GLM": "Vector2i from(glm::ivec2 p_vector) { return p_vector; }",
    "a Vector2 is not created from GLM": "Vector2 from(glm::vec2 p_vector) { return p_vector; }",
    "a Vector3 is not created from GLM": "Vector3 from(glm::vec3 p_vector) { return p_vector; }",
    "a Vector3 is not converted to GLM": "glm::vec3 to(const Vector3 &p_vector) { return p_vector; }",
    "a Vector3 has no color components": "float red(const Vector3 &p_vector) { return p_vector.r; }",
    "a Vector3 is no constant expression": "constexpr Vector3 up(0, 1, 0);",
    "a Color has no two components": "Color two() { return {1.0F, 2.0F}; }",
    "a Color has no designated components": "Color named() { return Color{.r = 1.0F}; }",
    "a Variant is not converted to an enumeration": "PropertyHint hint(const Variant &p_value) { return static_cast<PropertyHint>(p_value); }",
    "a Variant is not created from a scoped enumeration": "enum class Kind { a }; Variant kind(Kind p_kind) { return p_kind; }",
}
ACCEPTED = """void assign(Ref<Image> &r_to, const Ref<Image> &p_from, String &r_text) { r_to = p_from; r_text = String(); r_text = \"text\"; }
float sum(const PackedFloat32Array &p_array) { float total = 0; for (const float &number : p_array) { total += number; } return total; }
Vector3 vector(const Variant &p_value) { return p_value; }
Color color() { return {1.0F, 0.0F, 0.0F, 1.0F}; }
Variant hint() { return PROPERTY_HINT_NONE; }"""
HEADERS = ["godot_cpp/classes/image.hpp", "godot_cpp/classes/ref.hpp", "godot_cpp/variant/variant.hpp", "glm/vec2.hpp", "glm/vec3.hpp",
           "algorithm", "span", "string"]  # fmt: skip
GODOT_CPP = os.environ.get("THICKET_GODOT_CPP")


def compiles(code: str, folder: Path, godot_cpp: str | None = None) -> subprocess.CompletedProcess[str]:
    """Compiles code against a godot-cpp or, by default, against the stand-in in the build directory."""
    source = folder / "function.cpp"
    source.write_text("".join(f"#include <{header}>\n" for header in HEADERS) + f"namespace godot {{\n{code}\n}}\n")
    included = [Path(godot_cpp) / part for part in ("include", "gen/include", "gdextension")] if godot_cpp else [
        BINDINGS / "include", BUILD_DIR / "gen/include", BUILD_DIR / "gen", REPO / "build/engine"]  # fmt: skip
    return run(["g++", "-std=c++20", "-fsyntax-only", *(f"-I{folder}" for folder in included), source], timeout=120)


@pytest.mark.parametrize("godot_cpp", [None, GODOT_CPP] if GODOT_CPP else [None], ids=lambda folder: "godot-cpp" if folder else "stand-in")
def test_the_stand_in_accepts_what_godot_cpp_accepts(godot_cpp, tmp_path):
    accepted = compiles(ACCEPTED, tmp_path, godot_cpp)
    assert accepted.returncode == 0, accepted.stderr


@pytest.mark.parametrize("code", REFUSED)
def test_the_stand_in_rejects_what_godot_cpp_rejects(code, tmp_path):
    """The stand-in rejects code that godot-cpp rejects, so that code written against it also compiles with godot-cpp. If
    THICKET_GODOT_CPP is set, also checks that this godot-cpp rejects the code."""
    assert compiles(REFUSED[code], tmp_path).returncode != 0
    assert not GODOT_CPP or compiles(REFUSED[code], tmp_path, GODOT_CPP).returncode != 0


@pytest.mark.full
@pytest.mark.alone  # While this test runs, all tests would load a different extension.
@pytest.mark.skipif("THICKET_GODOT_CPP" not in os.environ, reason="set THICKET_GODOT_CPP to a built godot-cpp")
def test_the_same_sources_build_and_run_against_godot_cpp(godot, tmp_path):
    """All engine tests pass with godot-cpp. All language tests also pass, except test_wrong_values, because godot-cpp treats a
    value of the wrong type as null."""
    try:
        completed = run(["scons", "-Q", "-j2", "godot_cpp=" + os.environ["THICKET_GODOT_CPP"], "extension"], 3600, cwd=REPO)
        assert completed.returncode == 0, completed.stdout + completed.stderr
        project = make_project(tmp_path / "project", extension=True)
        shutil.copytree(ADDON, tmp_path / "addons/thicket")
    finally:
        run(["scons", "-Q", "-j2", "extension"], 3600, cwd=REPO)
    script = SCRIPTS / "test_language.gd"
    for name in set(re.findall(r"^func (test_\w+)", script.read_text(), re.MULTILINE)) - {"test_wrong_values"}:
        played = godot(["--verbose", "--path", project, "--script", script, "--", name])
        assert played.returncode == 0, played.stdout[-4000:]
        assert not [line for line in complaints(played.stdout + played.stderr) if "from _get_heights()" not in line]
    check_engine_tests(tmp_path / "addons/thicket")
