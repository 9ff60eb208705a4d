"""Plays the library for the web in Godot's official web engine, in Chromium. tests/web contains the page. Without the engine, which
setup_web_engine in tools/setup_full.sh installs, the tests are skipped."""

from __future__ import annotations

import base64
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import zipfile
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from conftest import CACHE, PATIENCE, REPO, new_project, run
from test_package import pack
from tested_platforms import engine_of

sys.path.insert(0, str(REPO / "tools/scons"))
import installed  # noqa: E402 (only on the path above)

PAGE = REPO / "tests/web"
ENGINE = CACHE / f"web-engine-{installed.version('web_engine')}" / "godot"
WORK = REPO / "build/web"
LIBRARY = "libthicket.web.template_release.wasm32.nothreads.wasm"
PROJECT = """config_version=5
[application]
config/name="Web"
run/main_scene="res://web/run.tscn"
"""
RUN = """[gd_scene format=3]
[ext_resource type="Script" path="res://web/run.gd" id="1"]
[node name="Run" type="Node"]
script = ExtResource("1")
"""
READ_BY_ENGINE = (".gd", ".gdshader", ".gdshaderinc", ".tscn", ".tres", ".cfg", ".godot")
# Scripts of tests/engine that need neither threads nor files nor the editor's scripts, which do not compile in an exported game.
SCRIPTS = [
    "test_state", "test_streaming", "test_layer_rules", "test_layer_placement", "test_surface_layers", "test_planets",
    "test_biomes", "test_regions", "test_queries", "test_edits", "test_water", "test_ground_heightmaps",
    "test_ground_meshes", "test_state_async", "test_state_peers", "test_mask", "test_models", "test_neighbors",
    "test_bad_input", "test_problems", "test_changes", "test_explain", "test_domain", "test_sample_surface",
    "test_tile_grid", "test_kept_points", "test_world_offset", "test_local_coords", "test_layer_properties", "test_sources",
    "test_planet_masks", "test_terrains", "test_terrain_calls", "test_model_parts", "test_ground_recheck", "test_state_handlers",
    "test_scene_digest", "test_collision", "test_scenes",
]  # fmt: skip
PASSED = re.compile(r"^thicket engine tests: [1-9]\d* checks, 0 failed$", re.MULTILINE)
DIGEST = re.compile(r"^digest of .*$", re.MULTILINE)


# --- The page -----------------------------------------------------------------------------------------------------------


def names_of(module: Path, kind: str) -> set[str]:
    """Returns the names of everything that a WebAssembly module imports or exports. `kind` is "imports" or "exports"."""
    code = f"WebAssembly.Module.{kind}(new WebAssembly.Module(require('fs').readFileSync(process.argv[1]))).forEach(each => console.log(each.name))"
    listed = run(["node", "--eval", code, module], timeout=120)
    assert listed.returncode == 0, listed.stderr
    return set(listed.stdout.split())


def link_runtime(library: Path, runtime: Path):
    """Links tests/web/runtime.cpp with the parts of the C and C++ libraries that our library imports. The engine has most of these functions,
    but exports only a few of them."""
    of_engine = {"memory", "malloc", "free", "__indirect_function_table", "__stack_pointer", "__memory_base", "__table_base"}
    names = names_of(library, "imports") - names_of(library, "exports") - of_engine | {"wrap_entry_point", "init_language"}
    flags = ["-O2", "-mbulk-memory", "-sSIDE_MODULE=2", "-sWASM_BIGINT", "-sEXPORTED_FUNCTIONS=" + ",".join(f"_{name}" for name in sorted(names)), "-Wl,-Bsymbolic"]
    libraries = ["-lc++-noexcept", "-lc++abi-noexcept", "-lc", "-lcompiler_rt"]
    completed = run([REPO / "tools/emscripten", "em++", *flags, PAGE / "runtime.cpp", *libraries, "-o", runtime], timeout=300, cwd=REPO)
    assert completed.returncode == 0, completed.stderr


@pytest.fixture(scope="module")
def site() -> Path:
    """Returns a folder with the page, the engine, the modules, and a project with the add-on and all test scripts."""
    if not ENGINE.is_dir():
        pytest.skip("no web engine: setup_web_engine in tools/setup_full.sh installs it")
    if not shutil.which("chromium") or not shutil.which("node"):
        pytest.skip("no Chromium or no node: run tests/run.sh --full, which installs them")
    shutil.rmtree(WORK, ignore_errors=True)
    project = WORK / "project"
    project.mkdir(parents=True)
    with zipfile.ZipFile(pack(["web.wasm32.nothreads"], REPO / "build/dist_web")["thicket"]) as file:
        file.extractall(project)
    (WORK / "library.wasm").write_bytes((project / "addons/thicket/bin" / LIBRARY).read_bytes())
    link_runtime(WORK / "library.wasm", WORK / "runtime.wasm")
    shutil.rmtree(project / "addons/thicket/bin")
    (WORK / "engine").symlink_to(ENGINE)
    for name in ("page.html", "page.js", "side_modules.js"):
        (WORK / name).symlink_to(PAGE / name)
    for folder in ("engine", "web"):
        shutil.copytree(REPO / "tests" / folder, project / folder, ignore=lambda _, names: [name for name in names if not name.endswith(".gd")])
    (project / "project.godot").write_text(PROJECT)
    (project / "web/run.tscn").write_text(RUN)
    (project / ".godot").mkdir()
    (project / ".godot/global_script_class_cache.cfg").write_text("list=[]\n")
    return WORK


class Player:
    """Opens the page in Chromium, and collects what it reports."""

    def __init__(self, site: Path, profile: Path):
        self.site, self.profile, self.address = site, profile, ""
        project = site / "project"
        self.files = sorted(path.relative_to(project).as_posix() for path in project.rglob("*") if path.suffix in READ_BY_ENGINE)
        self.reports: list[tuple[str, str]] = []
        self.ended = threading.Event()

    def take(self, path: str, text: str):
        self.reports.append((path, text))
        if path in ("exited", "failed"):
            self.ended.set()

    def play(self, script: str, *options: str, timeout: float) -> str:
        """Runs a script that extends tests/engine/harness.gd in the engine. Returns what the engine prints. Fails if the script does."""
        self.reports.clear()
        self.ended.clear()
        # Without a sound card, Chromium would refuse to play sound.
        arguments = [*options, "--audio-driver", "Dummy", "--", f"res://{script}"]
        (self.site / "run.json").write_text(json.dumps({"files": self.files, "args": arguments}))
        command = ["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-port=0",
            f"--user-data-dir={self.profile}", f"{self.address}/page.html"]  # fmt: skip
        with subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as browser:
            ended = self.ended.wait(timeout * PATIENCE)
            os.killpg(browser.pid, signal.SIGKILL)
        printed = "".join(text + "\n" for path, text in self.reports if path in ("printed", "failed"))
        assert ended, f"{script} ran longer than {timeout * PATIENCE} s; the engine printed:\n{printed[-4000:]}"
        assert ("exited", "0") in self.reports and PASSED.search(printed), printed[-4000:]
        return printed


@pytest.fixture(scope="module")
def player(site, tmp_path_factory) -> Iterator[Player]:
    """Serves the page, and yields an object that runs scripts in it."""
    player = Player(site, tmp_path_factory.mktemp("chromium"))

    class Handler(SimpleHTTPRequestHandler):
        def do_POST(self):  # noqa: N802 (the name that the base class calls)
            player.take(self.path.removeprefix("/"), self.rfile.read(int(self.headers["Content-Length"])).decode())
            self.send_response(204)
            self.end_headers()

        def end_headers(self):
            # An isolated page has a clock with a resolution of 5 microseconds instead of 100.
            self.send_header("Cross-Origin-Opener-Policy", "same-origin")
            self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
            super().end_headers()

        def log_message(self, *arguments):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=site)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        player.address = "http://%s:%d" % server.server_address[:2]
        yield player
        server.shutdown()


# --- The tests ----------------------------------------------------------------------------------------------------------


@pytest.mark.full
@pytest.mark.parametrize("script", SCRIPTS)
def test_engine_scripts_pass(player, script, record_property):
    record_property("engine", engine_of(player.play(f"engine/{script}.gd", "--headless", timeout=120)))


@pytest.mark.full
def test_digests_are_those_of_the_native_library(player, godot, tmp_path):
    """Compares digests of points, tiles, queries and states."""
    native = godot(["--path", new_project(tmp_path), "--script", PAGE / "digests.gd"])
    assert native.returncode == 0, native.stdout + native.stderr
    expected = DIGEST.findall(native.stdout)
    assert len(expected) == len(set(expected)) >= 20
    assert DIGEST.findall(player.play("web/digests.gd", "--headless", timeout=60)) == expected


@pytest.mark.full
def test_instances_are_drawn(player):
    """Draws instances with WebGL, in software. Writes the picture, which a person can check, to build/web."""
    player.play("web/picture.gd", timeout=120)
    (picture,) = [text for path, text in player.reports if path == "picture"]
    (WORK / "instances.png").write_bytes(base64.b64decode(picture))
