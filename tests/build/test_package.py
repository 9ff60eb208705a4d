"""Tests the release files. The zips of tools/package.sh must have the right content and no traces of the build machine,
and their libraries must load on the oldest supported systems."""

from __future__ import annotations

import hashlib
import os
import plistlib
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from conftest import CACHE, REPO, check_engine_tests, in_godots_root, run
from golden import emulators
from golden.matrix import ZIG
from test_packing import check_signature
from tested_platforms import engine_of

sys.path.insert(0, str(REPO / "tools/package"))
import binaries  # noqa: E402 (only on the path above)
import contents  # noqa: E402

DIST = REPO / "build/dist_test"
# The oldest version of glibc that the libraries must support, as README.md states. It was released in 2012.
OLDEST_GLIBC = (2, 17)
# Matches paths of build machines and addresses of registries.
OF_THE_MACHINE = re.compile(rb"/(?:home|root|work|tmp|build|usr/include|usr/lib)/(?!dyld|libSystem|libstdc)[\w.-]|ziglang|\.cache/|https?://(?!github\.com/|[\w-]+\.github\.io/|www\.w3\.org/|www\.apple\.com/DTDs)[\w.]+\.[a-z]")


# --- The zips -----------------------------------------------------------------------------------------------------------


def pack(names: list[str], out: Path) -> dict[str, Path]:
    """Runs tools/package.sh for these builds, or for all builds if `names` is empty. Returns the path of each zip by
    its name."""
    # Each of the fourteen builds takes 2.5 minutes on two cores, or 8 minutes while two other workers are running.
    completed = run(["bash", "tools/package.sh", "--out", out, *names], timeout=3 * 3600, cwd=REPO)
    assert completed.returncode == 0, completed.stdout[-4000:] + completed.stderr[-4000:]
    sums = dict(reversed(line.split()) for line in (out / "SHA256SUMS").read_text().splitlines())
    zips = {path.name: path for path in out.glob("*.zip")}
    assert sums == {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in zips.items()}
    return {re.sub(r"-\d.*", "", name): path for name, path in zips.items()}


@pytest.fixture(scope="module")
def zips() -> dict[str, Path]:
    """Returns the release zips, with all platforms in both precisions."""
    return pack([], DIST)


@pytest.fixture(scope="module")
def addon(zips, tmp_path_factory) -> Path:
    """Returns the folder of the add-on, unpacked from the zip as a user would unpack it."""
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(zips["thicket"]) as file:
        file.extractall(folder)
    assert sorted(path.name for path in folder.iterdir()) == ["addons", "thicket_readme.txt"]
    return folder / "addons/thicket"


def libraries(addon: Path) -> list[Path]:
    """Returns all libraries of an add-on, including those in frameworks."""
    found = [path for path in (addon / "bin").rglob("*") if path.is_file() and path.suffix in (".so", ".dll", ".wasm")]
    return found + [path / path.stem for path in (addon / "bin").glob("*.framework")]


@pytest.mark.full
def test_content_of_the_zip(addon):
    """Checks that the zip contains all files that users need, and no build files."""
    names = {path.relative_to(addon).as_posix() for path in addon.rglob("*") if path.is_file()}
    for needed in ("plugin.cfg", "thicket.gdextension", "LICENSE", "THIRD_PARTY.txt", "README.md", "CHANGELOG.md", "plugin.gd",
        "editor/.gdignore", "editor/workspace.gd"):
        assert needed in names, needed
    assert any(name.startswith("csharp/") for name in names) and any(name.startswith("tutorials/") for name in names)
    assert not [name for name in names if re.search(r"\.(py|cpp|hpp|o|a|lib|pdb|import\.tmp)$|SConstruct|__pycache__|~$", name)]
    notices = (addon / "THIRD_PARTY.txt").read_text(encoding="utf-8")
    assert all(word in notices for word in ("Highway", "LodePNG", "GLM", "libc++", "Apache License", "MIT"))
    listed = set(re.findall(r'= "(bin/[^"]+)"', (addon / "thicket.gdextension").read_text(encoding="utf-8")))
    assert listed == {f"bin/{path.name}" for path in (addon / "bin").iterdir()}


@pytest.mark.full
def test_no_traces_of_the_build_machine(addon):
    """Checks that no file of the add-on contains a path, a compiler or a registry of the build machine."""
    for path in (each for each in addon.rglob("*") if each.is_file() and each.name != "THIRD_PARTY.txt"):
        found = OF_THE_MACHINE.search(path.read_bytes())
        assert not found, f"{path.name}: {path.read_bytes()[max(0, found.start() - 40) : found.end() + 40]}"


@pytest.mark.full
def test_libraries_are_small_and_stripped(addon):
    for path in libraries(addon):
        if "template_release" in path.name and path.suffix in (".so", ".dll"):
            assert path.stat().st_size < 5.25 * 1024 * 1024, f"{path.name} has {path.stat().st_size} bytes"
    for path in (addon / "bin").glob("*.so"):
        sections = run(["readelf", "--sections", "--wide", path], timeout=60).stdout
        assert ".dynsym" in sections and ".symtab" not in sections and ".debug" not in sections, path.name


@pytest.mark.full
def test_libraries_for_linux_are_hardened_and_need_little(addon):
    """Checks that the libraries load with a glibc from 2012 and include the C++ library. Relocated data must be
    read-only, and the stack must not be executable."""
    assert len(list((addon / "bin").glob("*.so"))) == 8
    for path in (addon / "bin").glob("*.so"):
        text = run(["readelf", "--wide", "--dynamic", "--segments", "--version-info", path], timeout=60).stdout
        required = {tuple(map(int, version.split("."))) for version in re.findall(r"GLIBC_(\d+\.\d+)", text)}
        assert required and max(tuple(version) for version in required) <= OLDEST_GLIBC, f"{path.name} needs {max(required)}"
        needed = re.findall(r"\(NEEDED\)\s+Shared library: \[([^\]]+)\]", text)
        assert all(re.match(r"(libc|libm|libpthread|libdl|ld-linux[\w-]*)\.so", name) for name in needed), needed
        assert "GNU_RELRO" in text and re.search(r"FLAGS_1.*NOW|BIND_NOW", text), path.name
        stack = re.search(r"GNU_STACK\s.*?\s(RWE|RW)\s", text)
        assert stack and stack.group(1) == "RW", path.name
        assert "RUNPATH" not in text and "RPATH" not in text
        names = exported(["nm", "-D", "--defined-only", path])
        assert names == {"thicket_library_init"}, f"{path.name} also exports {sorted(names)[:10]}"


def exported(command: list[str | Path]) -> set[str]:
    listed = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=True)
    return {line.split()[-1].split("@")[0] for line in listed.stdout.splitlines() if line.strip()}


@pytest.mark.full
def test_libraries_for_windows_are_hardened_and_need_little(addon):
    """Checks that addresses are randomized, that data is not executable, and that the libraries import only libraries
    that every Windows 10 has."""
    for path in (addon / "bin").glob("*.dll"):
        text = run([binaries.tool("llvm-readobj"), "--file-headers", "--coff-imports", "--coff-exports", path], timeout=60).stdout
        for word in ("DYNAMIC_BASE", "HIGH_ENTROPY_VA", "NX_COMPAT"):
            assert word in text, f"{path.name}: {word}"
        required = set(re.findall(r"^Import \{\n  Name: (\S+)", text, re.MULTILINE))
        assert required and all(re.match(r"(?i)api-ms-win-crt-|kernel32\.dll|ntdll\.dll", name) for name in required), required
        assert re.findall(r"^Export \{\n(?:.*\n)*?  Name: (\S+)", text, re.MULTILINE) == ["thicket_library_init"]


@pytest.mark.full
def test_frameworks_for_macos_contain_both_architectures(addon, tmp_path):
    """Checks that the part for each CPU is signed, with the framework's identifier as its name."""
    for folder in (addon / "bin").glob("*.framework"):
        listed = run([binaries.tool("llvm-lipo"), "-archs", folder / folder.stem], timeout=60)
        assert sorted(listed.stdout.split()) == ["arm64", "x86_64"], listed.stderr
        about = plistlib.loads((folder / "Resources/Info.plist").read_bytes())
        for arch in ("arm64", "x86_64"):
            part = tmp_path / arch
            run([binaries.tool("llvm-lipo"), folder / folder.stem, "-thin", arch, "-output", part], timeout=60)
            check_signature(part.read_bytes(), about["CFBundleIdentifier"])
        assert about["CFBundleExecutable"] == folder.stem and about["CFBundleVersion"] == contents.version()


@pytest.mark.full
def test_builds_are_reproducible(zips, tmp_path):
    """Checks that building a library in another folder and packing it produces identical zips."""
    copy = tmp_path / "elsewhere"
    shutil.copytree(REPO, copy, ignore=shutil.ignore_patterns("build", ".godot", "__pycache__"), symlinks=True)
    completed = run(["bash", "tools/package.sh", "--out", tmp_path / "again", "linux.x86_64"], timeout=3600, cwd=copy)
    assert completed.returncode == 0, completed.stdout[-4000:] + completed.stderr[-4000:]
    here = pack(["linux.x86_64"], tmp_path / "here")
    for name in ("thicket", "thicket-demo"):
        other = next((tmp_path / "again").glob(f"{name}-[0-9]*.zip"))
        assert other.read_bytes() == here[name].read_bytes(), name


# --- In engines ------------------------------------------------------------------------------------------------------------


def compile_loader(compiler: list[str | Path], name: str) -> Path:
    """Compiles the program of tests/loader with a compiler for another system. Returns its path."""
    program = REPO / "build/loader" / name
    program.parent.mkdir(parents=True, exist_ok=True)
    completed = run([*compiler, "-std=c++20", "-O1", "-I.", "-Ibuild/engine", *sorted((REPO / "tests/loader").glob("*.cpp")), "-o", program],
        timeout=600, cwd=REPO)  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    return program


def zig_loader(target: str, *flags: str) -> Path:
    return compile_loader([ZIG, "c++", "-target", target, *flags], target + (".exe" if "windows" in target else ""))


def registered(program: list[str | Path], library: Path, environment: dict[str, str] | None = None) -> list[str]:
    """Loads a library with the loader. Returns the lines that the loader prints, including the registered classes and
    members."""
    completed = run([*program, library, *(["double"] if ".double." in library.name else [])], timeout=300, env=environment)
    assert completed.returncode == 0, library.name + completed.stdout[-2000:] + completed.stderr[-2000:]
    lines = completed.stdout.replace("\r", "").splitlines()
    assert re.fullmatch(r"loaded and closed, \d+ classes, \d+ functions of the engine", lines[-1])
    return lines


@pytest.fixture(scope="module")
def at_home(addon) -> list[str]:
    program = zig_loader("x86_64-linux-gnu.2.28", "-ldl")
    lines = registered([program], addon / "bin/libthicket.linux.template_release.x86_64.so")
    assert len(lines) > 500 and "class TerrainScatter3D of Node3D" in lines
    for path in sorted((addon / "bin").glob("*.x86_64.so")):
        assert registered([program], path) == lines, path.name
    return lines


@pytest.mark.full
def test_the_library_for_windows_loads(addon, at_home):
    """Checks that the libraries load in wine, register the same classes as on Linux, create one object of each class,
    and unload."""
    if why := emulators.absence("wine", "Windows", "x86_64"):
        pytest.skip(why)
    program = [*emulators.command("wine", "Windows", "x86_64"), zig_loader("x86_64-windows-gnu")]
    for path in sorted((addon / "bin").glob("*.x86_64.dll")):
        assert registered(program, path, emulators.environment("wine")) == at_home, path.name


@pytest.mark.full
def test_the_library_for_arm_loads(addon, at_home):
    """Checks that the ARM libraries register the same classes as the libraries of this machine. They run in an emulator, with
    the C library of a cross compiler."""
    if not shutil.which("qemu-aarch64"):
        pytest.skip("qemu-user is not installed")
    root = Path("/usr/aarch64-linux-gnu")
    if not (root / "lib/ld-linux-aarch64.so.1").exists():
        pytest.skip("libc6-arm64-cross is not installed")
    program = ["qemu-aarch64", "-L", root, zig_loader("aarch64-linux-gnu.2.28", "-ldl")]
    for path in sorted((addon / "bin").glob("*.arm64.so")):
        assert registered(program, path) == at_home, path.name


@pytest.mark.full
@pytest.mark.parametrize("threads", [True, False])
def test_the_library_for_the_web_loads(addon, at_home, threads):
    """Checks that the WebAssembly libraries, for both kinds of export template, register the same classes as the libraries of
    this machine. WebAssembly traps if a function is called with a wrong signature."""
    if not shutil.which("node"):
        pytest.skip("node is not installed")
    flags = ["-fwasm-exceptions", "-sSUPPORT_LONGJMP=wasm", "-sMAIN_MODULE=1", "-sWASM_BIGINT", "-sNODERAWFS", "-sINITIAL_MEMORY=256MB",
        "-sEXIT_RUNTIME", *(["-pthread"] if threads else [])]  # fmt: skip
    program = compile_loader([REPO / "tools/emscripten", "em++", *flags], "web.js" if threads else "web.nothreads.js")
    paths = [path for path in (addon / "bin").glob("*.wasm") if threads == (".nothreads." not in path.name)]
    assert len(paths) == 2
    for path in paths:
        assert registered(["node", program], path) == at_home, path.name


@pytest.mark.full
def test_the_engine_tests_pass_with_the_unpacked_add_on(addon):
    check_engine_tests(addon)


@pytest.mark.full
def test_a_users_project(addon, godot, tmp_path):
    """Checks that the editor opens and imports a new project with the add-on without errors or warnings. It must also
    open the project after the add-on has been deleted."""
    project = tmp_path / "project"
    (project / "addons").mkdir(parents=True)
    (project / "project.godot").write_text('config_version=5\n[application]\nconfig/name="A user\'s"\n[editor_plugins]\n'
        'enabled=PackedStringArray("res://addons/thicket/plugin.cfg")\n')  # fmt: skip
    shutil.copytree(addon, project / "addons/thicket")
    complaint = re.compile(r"\b(ERROR|WARNING)\b")
    # Start the editor first, as users do. An import would exit right after finding the extension for the first time,
    # and Godot then crashes with any extension (github.com/godotengine/godot/issues/111048).
    for arguments in (["--editor", "--quit-after", "200"], ["--import"], ["--import"], ["--editor", "--quit-after", "200"]):
        completed = godot(["--path", project, *arguments], timeout=600)
        wrong = [line for line in (completed.stdout + completed.stderr).splitlines() if complaint.search(line)]
        assert completed.returncode == 0 and not wrong, "\n".join(wrong)
    shutil.rmtree(project / "addons/thicket")
    (project / "project.godot").write_text('config_version=5\n[application]\nconfig/name="A user\'s"\n')
    for arguments in (["--import"], ["--editor", "--quit-after", "30"]):
        completed = godot(["--path", project, *arguments], timeout=600)
        assert completed.returncode == 0, completed.stdout + completed.stderr


GAME = """extends Node3D

func _ready() -> void:
	var oaks := ScatterLayer.new()
	oaks.radius = 3.0
	oaks.progressive_levels = 2
	oaks.meshes = [CylinderMesh.new()]
	var forest := TerrainScatter3D.new()
	forest.ground = ScatterGroundFlat.new()
	forest.layers = [oaks]
	add_child(forest)
	var digests: Array[String] = []
	for tile in 4:
		digests.append(str(forest.build_tile(forest.layers[0], Vector2i(tile, -tile)).get_digest()))
	digests.append(str(ScatterState.new().get_digest()))
	forest.remove_in_sphere(Vector3.ZERO, 20.0)
	digests.append(str(forest.state.get_digest()))
	print("digests ", digests, " ", OS.has_feature("template_release"))
	get_tree().quit()
"""
PRESETS = """[preset.0]
name="Linux"
platform="Linux"
runnable=true
export_filter="all_resources"
include_filter=""
exclude_filter=""

[preset.0.options]
custom_template/release="/usr/bin/godot-template-release"
binary_format/embed_pck=false
binary_format/architecture="x86_64"
"""


@pytest.mark.full
def test_an_exported_game_has_the_same_digests(addon, godot, tmp_path):
    """Checks that a game that was exported with the release template prints the same digests as in the editor's
    engine."""
    if in_godots_root(["test", "-x", "/usr/bin/godot-template-release"], 60).returncode:
        pytest.skip("no export template is installed")
    project = tmp_path / "project"
    (project / "addons").mkdir(parents=True)
    (project / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Game"\nrun/main_scene="res://game.tscn"\n')
    (project / "game.gd").write_text(GAME)
    (project / "game.tscn").write_text('[gd_scene format=3]\n[ext_resource type="Script" path="res://game.gd" id="1"]\n'
        '[node name="Game" type="Node3D"]\nscript = ExtResource("1")\n')  # fmt: skip
    (project / "export_presets.cfg").write_text(PRESETS)
    shutil.copytree(addon, project / "addons/thicket")
    (tmp_path / "game").mkdir()
    for arguments in (["--editor", "--quit-after", "200"], ["--export-release", "Linux", tmp_path / "game/game.x86_64"]):
        completed = godot(["--path", project, *arguments], timeout=600)
        assert completed.returncode == 0, completed.stdout + completed.stderr
    assert {path.name for path in (tmp_path / "game").iterdir()} == {
        "game.x86_64", "game.pck", "libthicket.linux.template_release.x86_64.so"}  # fmt: skip
    played = godot(["--path", project], timeout=300)
    exported = in_godots_root([tmp_path / "game/game.x86_64", "--headless"], 300)
    digests = [re.findall(r"^digests (\[.*\]) (\w+)$", completed.stdout, re.MULTILINE) for completed in (played, exported)]
    assert digests[0] and digests[1], played.stdout + exported.stdout + exported.stderr
    # Empty tiles have digest 0. Both games would also print the same digests if their tiles were empty or nothing was removed.
    tiles_and_states = re.findall(r"-?\d+", digests[0][0][0])
    assert len(set(tiles_and_states)) == 6 and "0" not in tiles_and_states[:4], played.stdout
    assert digests[0][0][0] == digests[1][0][0] and digests[0][0][1] == "false" and digests[1][0][1] == "true"


@pytest.mark.full
def test_the_engine_for_arm_runs_the_unpacked_add_on(addon, tmp_path, record_property):
    """Runs the scripts of tests/engine for points, tiles, rules and states in an engine for ARM, under an emulator."""
    root = CACHE / "godot-root-arm64"
    if not shutil.which("qemu-aarch64") or not (root / "usr/bin/godot").exists():
        pytest.skip("no engine for ARM, or no emulator, is installed")
    project = tmp_path / "project"
    shutil.copytree(REPO / "tests/engine", project)
    shutil.copytree(addon, project / "addons/thicket")
    (project / "project.godot").write_text('config_version=5\n[application]\nconfig/name="ARM"\n')
    (project / ".godot").mkdir()
    (project / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    for script in ("test_build_rect.gd", "test_domain.gd", "test_layer_rules.gd", "test_state.gd"):
        completed = run(["qemu-aarch64", "-L", root, root / "usr/bin/godot", "--headless", "--path", project, "--script", script], timeout=1800,
            env={**os.environ, "LD_LIBRARY_PATH": ""})  # fmt: skip
        assert completed.returncode == 0 and ", 0 failed" in completed.stdout, f"{script}:\n{completed.stdout[-3000:]}{completed.stderr[-3000:]}"
    record_property("engine", engine_of(completed.stdout))
