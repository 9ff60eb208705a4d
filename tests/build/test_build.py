"""Tests the rules of the build and the source tree. A room (a folder of sources) may include only rooms above it in the table of
rooms, and the core must not depend on the engine. Warnings must be errors, and the manifest must list the existing binaries."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from conftest import BUILD_DIR, REPO, run

# These modules are in tools/scons, which conftest adds to sys.path.
import installed
import manifest
import rooms
import scu
from rooms import ROOMS

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
SOURCES = sorted(
    path.relative_to(REPO / "extension").as_posix()
    for path in (REPO / "extension").rglob("*")
    if path.suffix in (".hpp", ".cpp", ".h", ".inl")
)


def includes(source: str) -> list[tuple[bool, str]]:
    """Returns a pair for each include of a file in extension/: whether the path is quoted, and the path."""
    text = (REPO / "extension" / source).read_text(encoding="utf-8")
    return [(match.group(1) == '"', match.group(2)) for match in INCLUDE.finditer(text)]


def room_of(path: str) -> str | None:
    return next((room for room in ROOMS if path.startswith(room + "/")), None)


@pytest.mark.parametrize("source", SOURCES)
def test_room_order(source):
    """Checks that a source includes only its own room and the rooms that the table permits."""
    room = room_of(source)
    assert room, f"{source} is not in a room of {list(ROOMS)}"
    for quoted, included in includes(source):
        if not quoted or "/" not in included:
            continue
        allowed = [room, *ROOMS[room]]
        assert any(included.startswith(one + "/") for one in allowed), f"{source} includes {included}"


def test_the_table_of_rooms_is_in_order():
    """Checks that each room lists only rooms above it, so that the table has no cycle, and that every folder is a
    room."""
    before: list[str] = []
    for room, allowed in ROOMS.items():
        assert all(one in before or any(known.startswith(one + "/") for known in before) for one in allowed), room
        before.append(room)
    folders = {path.relative_to(REPO / "extension").as_posix() for part in ("core", "nodes") for path in (REPO / "extension" / part).iterdir() if path.is_dir()}
    assert folders == {room for room in ROOMS if "/" in room}


@pytest.mark.parametrize("room", ROOMS)
def test_every_permitted_include_is_used(room):
    included = {name for source in SOURCES if room_of(source) == room for quoted, name in includes(source) if quoted}
    unused = [other for other in ROOMS[room] if not any(name.startswith(other + "/") for name in included)]
    assert not unused, f"{room} does not include {unused}: remove these from its row in tools/scons/rooms.py"


def test_the_documents_list_every_room():
    """Checks that CONTRIBUTING.md lists the rooms in the order of the table, and that ARCHITECTURE.md has a line for each."""
    contributing = (REPO / "CONTRIBUTING.md").read_text(encoding="utf-8")
    architecture = (REPO / "ARCHITECTURE.md").read_text(encoding="utf-8")
    tree = architecture[architecture.index("\nextension/core/") : architecture.index("\nextension/bindings/")]
    for part in ("core", "nodes"):
        expected = [room.removeprefix(part + "/") for room in ROOMS if room.startswith(part + "/")]
        row = re.search(rf"^\| `extension/{part}` \| .*: (`.*`) \|$", contributing, re.MULTILINE)
        assert row and re.findall(r"`(\w+)`", row.group(1)) == expected
        lines = tree[tree.index(f"\nextension/{part}/") :].split("\nextension/")[1]
        assert re.findall(r"^  (\w+) ", lines, re.MULTILINE) == expected


def test_includes_have_no_cycle():
    """Checks that no header includes itself indirectly. Repeatedly removes headers that include none of the remaining headers
    until none is left."""
    left = {source: {name for quoted, name in includes(source) if quoted and name in SOURCES} for source in SOURCES}
    while leaves := [source for source, included in left.items() if not included & left.keys()]:
        for source in leaves:
            del left[source]
    assert not left, f"these include each other: {sorted(left)}"


@pytest.mark.parametrize("source", [source for source in SOURCES if source.startswith("core/")])
def test_core_includes_no_engine(source):
    engine = [name for _, name in includes(source) if re.search(r"godot|gdextension", name, re.IGNORECASE)]
    assert not engine, f"{source} includes {engine}"


@pytest.mark.parametrize("source", [source for source in SOURCES if source.endswith((".hpp", ".h"))])
def test_headers_are_included_once_and_open_no_namespace(source):
    text = (REPO / "extension" / source).read_text(encoding="utf-8")
    if not source.endswith("-inl.hpp"):
        assert "#pragma once" in text
    assert not re.search(r"^\s*using\s+namespace\s", text, re.MULTILINE), f"{source} opens a namespace in every file that includes it"


def test_core_compiles_separately(tmp_path):
    """Checks that every header of the core compiles as the first include, with a C++20 compiler that finds no engine
    headers."""
    headers = [source for source in SOURCES if source.startswith("core/") and source.endswith(".hpp")]
    headers = [header for header in headers if not header.endswith("-inl.hpp")]
    assert headers

    def complaint(number: int) -> str:
        unit = f"unit_{number}.cpp"
        (tmp_path / unit).write_text(f'#include "{headers[number]}"\n')
        # Compiler caches store a compilation only if the path of the object is relative.
        completed = run(["g++", "-std=c++20", "-c", f"-I{REPO}/extension", unit], timeout=120, cwd=tmp_path)
        return f"{headers[number]}:\n{completed.stderr[:2000]}" if completed.returncode else ""

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        failures = [text for text in pool.map(complaint, range(len(headers))) if text]
    assert not failures, "\n".join(failures)


# Functions of the C library whose inexact results differ between machines. Functions that IEEE 754 requires to be
# correctly rounded (sqrt), or that do not round (floor, ldexp, ilogb, nextafter), are the same everywhere.
INEXACT = """acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf erfc exp exp10 exp2 expm1 hypot j0 j1 jn lgamma log log10
    log1p log2 logb pow sin sincos sinh tan tanh tgamma y0 y1 yn""".split()


def test_core_calls_no_inexact_math_function(build_dir):
    """Checks that the core does not call functions whose results differ between C libraries in the last bit."""
    listed = run(["nm", "-u", build_dir / "libthicket_core.a"], timeout=60)
    assert listed.returncode == 0, listed.stderr
    wanted = {words[1] for words in map(str.split, listed.stdout.splitlines()) if len(words) == 2 and words[0] == "U"}
    assert "sqrt" in wanted, "the archive must list functions of the C library"
    inexact = {prefix + name + suffix for name in INEXACT for prefix in ("", "__") for suffix in ("", "f", "l", "_finite")}
    assert not wanted & inexact, f"the core calls {sorted(wanted & inexact)}"


def test_every_test_of_the_core_belongs_to_one_room():
    """Checks that each test of the core belongs to exactly one room, for which `bash tests/room.sh ROOM` runs it. Tests of a
    benchmark are an exception, because they include no room."""
    programs = {room: set(rooms.tests_of(REPO, rooms.PREFIX + room.removeprefix("core/"))[0]) for room in rooms.TESTED}
    everywhere = set.intersection(*programs.values())
    tests = [path.relative_to(REPO).as_posix() for path in sorted((REPO / "tests/core").glob("test_*.cpp"))]
    belongs = {test: [room for room, files in programs.items() if test in files] for test in tests}
    assert all(len(found) <= 1 for found in belongs.values()), belongs
    assert all("baselines" in test for test, found in belongs.items() if not found), belongs
    assert "tests/core/main.cpp" in everywhere and not everywhere & set(tests)
    assert all(any(test in files for test in tests) for files in programs.values()), "a room has no test"
    assert belongs["tests/core/test_rules.cpp"] == ["core/rules"]


def test_a_room_can_be_tested_alone():
    """Checks that room.sh runs the test cases of a room, passes arguments to doctest, and rejects unknown rooms."""
    completed = run(["bash", "tests/room.sh", "base", "*", "--no-skipped-summary"], timeout=900, cwd=REPO)
    assert completed.returncode == 0 and re.search(r"test cases: +[1-9]\d* \|", completed.stdout), completed.stdout + completed.stderr
    wrong = run(["bash", "tests/room.sh", "cellar"], timeout=120, cwd=REPO)
    assert wrong.returncode != 0 and "no such room; the rooms are base, sampling" in wrong.stderr, wrong.stderr


@pytest.fixture(scope="module")
def commands() -> list[dict]:
    """Returns the compile commands of all sources, from compile_commands.json."""
    completed = run(["scons", "-Q", "compiledb"], timeout=300, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    again = run(["scons", "-Q", "-q", "compiledb"], timeout=300, cwd=REPO)
    assert again.returncode == 0, "it would be rewritten although nothing has changed"
    return json.loads((REPO / "compile_commands.json").read_text(encoding="utf-8"))


def test_compile_flags(commands):
    """Checks that our code is compiled with all warnings as errors, and with flags that make floating-point results
    identical everywhere."""
    assert any("extension/core/" in entry["file"] for entry in commands)
    for entry in commands:
        for flag in ("-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off"):
            assert flag in entry["command"].split(), f"{entry['file']} is compiled without {flag}"
        assert "-ffast-math" not in entry["command"]
        assert "-march=native" not in entry["command"]


def test_every_source_has_its_command(commands):
    """Checks that compile_commands.json, which editors and clang-tidy use, contains each source of the tree once."""
    named = [entry["file"] for entry in commands if not entry["file"].startswith("build/")]
    sources = [path for room in ("extension", "tests") for path in (REPO / room).rglob("*.cpp")]
    # These sources are compiled only for other systems, by the tests that run them there, or in a separate build
    # (count_steps=yes).
    elsewhere = [REPO / "tests/golden/no_exceptions.cpp", REPO / "tests/web/runtime.cpp", *(REPO / "tests/loader").glob("*.cpp"), *(REPO / "tests/cost").glob("*.cpp")]
    sources = [path for path in sources if path not in elsewhere]
    assert sorted(named) == sorted(path.relative_to(REPO).as_posix() for path in sources)


def test_debugger_build():
    """Checks that dev_build=yes compiles with -Og -g3 into a separate folder."""
    completed = run(["scons", "-Q", "-n", "dev_build=yes", "core"], timeout=300, cwd=REPO)
    assert completed.returncode == 0 and f"{BUILD_DIR.name}.dev/libthicket_core.a" in completed.stdout, completed.stdout + completed.stderr
    compiled = f"build/{BUILD_DIR.name}.dev/obj/extension/core/base/orientation.o"
    built = run(["scons", "-Q", "dev_build=yes", compiled], timeout=300, cwd=REPO)
    assert built.returncode == 0, built.stdout + built.stderr
    flags = run(["readelf", "--debug-dump=info", "--dwarf-depth=1", compiled], timeout=60, cwd=REPO).stdout
    assert " -Og" in flags and " -g3" in flags and " -O2" not in flags, flags


@pytest.mark.parametrize("room", list(ROOMS))
def test_sources_that_compile_together(room):
    """Checks that scu_build=yes compiles every source of a room once. Sources that Highway compiles several times must
    be compiled alone."""
    sources = rooms.sources(str(REPO), room)
    groups = scu.groups(str(REPO), sources)
    assert sorted(path for group in groups for path in group) == sources
    for group in groups:
        repeated = [path for path in group if "foreach_target.h" in (REPO / path).read_text(encoding="utf-8")]
        assert len(group) == 1 if repeated else 0 < len(group) <= 16


def test_second_build_has_nothing_to_do():
    """Checks that a second build finds everything up to date."""
    first = run(["scons", "-Q", "-j2"], timeout=1800, cwd=REPO)
    assert first.returncode == 0, first.stdout + first.stderr
    second = run(["scons", "-Q", "-q"], timeout=120, cwd=REPO)
    assert second.returncode == 0, f"still to do:\n{run(['scons', '-Q', '-n'], timeout=120, cwd=REPO).stdout}"


def test_core_needs_no_godot(tmp_path):
    """Checks that the core, the tests and the benchmarks can be built without Godot."""
    bare = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "THICKET_CACHE": str(tmp_path), "GODOT": "/nowhere/godot"}
    sources = ["highway=%s" % installed.highway_folder(), "lodepng=%s" % installed.lodepng_folder()]
    completed = run(["scons", "-Q", "-n", *sources, "core", "tests", "bench"], timeout=120, cwd=REPO, env=bare)
    assert completed.returncode == 0, completed.stdout + completed.stderr


@pytest.mark.parametrize(
    "option",
    [
        "target=fastest",
        "sanitize=memory",
        "godot_cpp=/nowhere",
        "color=green",
        "werror=perhaps",
        "dev_build=7",
        "platform=amiga",
        "arch=m68k",
        "precision=half",
        "threads=no",
        "highway=/nowhere",
        "lodepng=/nowhere",
    ],
)
def test_wrong_option_is_rejected(option):
    completed = run(["scons", "-Q", "-n", option, "core"], timeout=120, cwd=REPO)
    assert completed.returncode != 0
    assert option.split("=")[0] in completed.stdout + completed.stderr


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["platform=macos", "arch=universal", "use_zig=yes"], "one architecture at a time"),
        (["platform=android", "arch=arm64", "use_zig=yes"], "set CXX to a compiler that can"),
        (["platform=windows", "arch=rv64"], "the architectures of platform=windows"),
        (["use_zig=yes", "zig=/nowhere/zig"], "no zig at /nowhere/zig"),
        (["coverage=yes", "CXX=g++"], "coverage=yes needs clang"),
    ],
)
def test_impossible_builds_are_rejected_with_a_message(options, sentence):
    completed = run(["scons", "-Q", "-n", *options, "core"], timeout=120, cwd=REPO)
    assert completed.returncode != 0 and sentence in completed.stderr, completed.stdout + completed.stderr


def test_builds_for_other_systems_use_separate_folders():
    """Checks that a build for another system uses a separate folder and writes nothing into the demo's add-on. Builds
    with single and with double precision share the objects of the core."""
    compiler = ["zig=/bin/true", "use_zig=yes"]
    for options, folder in (
        (["platform=windows", "arch=arm64"], "windows.template_debug.arm64.zig"),
        (["platform=macos", "arch=arm64", "precision=double"], "macos.template_debug.arm64.double.zig"),
        (["platform=linux", "arch=x86_64", "ship=yes"], "linux.ship.x86_64.zig"),
    ):
        completed = run(["scons", "-Q", "-n", *compiler, *options, "core", "extension"], timeout=300, cwd=REPO)
        assert completed.returncode == 0, completed.stdout + completed.stderr
        made = set(re.findall(r"^(?:compile|archive|link) +(\S+)", completed.stdout, re.MULTILINE)) - {"extension"}
        linked = [path for path in made if "libthicket." in path]
        assert linked and all(path.startswith(f"build/{folder}/") for path in linked), linked
        assert f"build/{folder.replace('.double', '')}/libthicket_core.a" in made, made
        assert "demo_project/addons/thicket/bin" not in completed.stdout


def test_godot_cpp_without_a_library_is_rejected(tmp_path):
    """Checks that the error for a folder without a built godot-cpp names the missing library."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/libgodot-cpp.linux.template_release.wasm32.a").touch()
    completed = run(["scons", "-Q", "-n", f"godot_cpp={tmp_path}", "extension"], timeout=120, cwd=REPO)
    assert completed.returncode != 0
    assert "template_debug" in completed.stderr and "wasm32" in completed.stderr, completed.stderr


ADDON = REPO / "demo_project/addons/thicket"


def manifest_paths() -> dict[str, str]:
    """Returns {feature tags: file} from the manifest."""
    text = (ADDON / "thicket.gdextension").read_text(encoding="utf-8")
    section = text.split("[libraries]")[1].split("\n[")[0]
    return dict(re.findall(r'^(\S+)\s*=\s*"([^"]+)"', section, re.MULTILINE))


def test_manifest_lists_the_built_binaries():
    paths = manifest_paths()
    assert paths, "the manifest does not list a library"
    for tags, path in paths.items():
        assert (ADDON / path).is_file(), f"{tags} = {path} does not exist"
    built = {f"bin/{path.name}" for path in (ADDON / "bin").glob("libthicket.*")}
    assert set(paths.values()) == built
    text = (ADDON / "thicket.gdextension").read_text(encoding="utf-8")
    assert 'compatibility_minimum = "4.4"' in text, "the oldest engine that the bindings support"
    assert "reloadable = true" in text


def test_manifest_falls_back_to_the_existing_binary():
    """Checks that engines load a single binary for all targets, and that each engine loads the matching binary if there are
    two."""
    debug, release = "libthicket.linux.template_debug.x86_64.so", "libthicket.linux.template_release.x86_64.so"
    alone = "\n".join(manifest.write({debug, "convert.lib", "notes.txt"}, ["ScatterLayer.svg", "ScatterLayer.png"]))
    assert f'linux.release.x86_64 = "bin/{debug}"' in alone
    assert 'ScatterLayer = "icons/ScatterLayer.svg"' in alone
    assert "notes" not in alone and "convert" not in alone and "editor" not in alone
    both = "\n".join(manifest.write({debug, release}, []))
    assert f'linux.debug.x86_64 = "bin/{debug}"' in both
    assert f'linux.release.x86_64 = "bin/{release}"' in both
    assert "[dependencies]" not in both and "[icons]" not in both


def test_manifest_distinguishes_precisions():
    """Checks that each engine loads the library with the matching precision. If there is only one library, both kinds of engine
    try to load it, and it does not load into the wrong kind."""
    single, double = "libthicket.linux.template_debug.x86_64.so", "libthicket.linux.template_debug.double.x86_64.so"
    both = "\n".join(manifest.write({single, double}, []))
    for feature in ("debug", "release"):
        assert f'linux.{feature}.x86_64.single = "bin/{single}"' in both
        assert f'linux.{feature}.x86_64.double = "bin/{double}"' in both
    assert both.count("bin/") == 4
    assert f'linux.debug.x86_64 = "bin/{double}"' in "\n".join(manifest.write({double}, []))
    assert f'linux.debug.x86_64 = "bin/{single}"' in "\n".join(manifest.write({single}, []))


def test_extension_exports_only_its_entry_point(build_dir):
    """Checks that the binary exports only the function that Godot calls, so that no symbol can collide with a symbol of another
    library."""
    for binary in (ADDON / "bin").glob("libthicket.*.so"):
        listed = subprocess.run(["nm", "-D", "--defined-only", binary], capture_output=True, text=True, check=True)
        names = {line.split()[-1].split("@")[0] for line in listed.stdout.splitlines() if line.strip()}
        assert names == {"thicket_library_init"}, f"{binary.name} also exports {sorted(names)[:20]}"


def test_tracked_files_contain_no_machine_names():
    """Checks that tracked files contain no path of a build machine. They may contain only the hosts of linked pages and
    schemas, because each machine's package clients determine where packages come from."""
    if shutil.which("git") is None or not (REPO / ".git").exists():
        pytest.skip("no git, or not a git checkout")
    listed = run(["git", "ls-files", "-z"], timeout=60, cwd=REPO)
    assert listed.returncode == 0, listed.stderr
    pages = r"(?:www\.w3\.org|docs\.godotengine\.org|github\.com|raw\.githubusercontent\.com|[\w.-]+\.github\.io|[\w.-]+\.example)[/\"]"
    wrong = re.compile(r"/work/|/root/|https?://(?!%s)\w+" % pages)
    for name in filter(None, listed.stdout.split("\0")):
        path = REPO / name
        if not path.is_file() or path == Path(__file__).resolve():
            continue
        text = path.read_bytes().decode("utf-8", errors="ignore")
        assert not wrong.search(text), f"{name} names {wrong.search(text).group()}"
