"""Provides fixtures for all tests. They use the existing build: `bash tests/run.sh` builds first and then runs pytest
with several workers. This file also defines the order of the tests and their distribution to the workers."""

from __future__ import annotations

import os
import platform
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import ModuleType
from zipfile import ZipFile

import pytest
import tested_platforms
from analysis.point_sets import References

try:
    import fcntl
except ImportError:  # Windows does not have this module.
    fcntl = None

REPO = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPO / "tools/scons"))
import installed  # noqa: E402 (only on the path above)

# The folder into which tools/setup.sh installs.
CACHE = Path(installed.cache_folder())
# The add-on that test projects use: the add-on that was built here, or the one at the path in THICKET_ADDON.
ADDON = Path(os.environ.get("THICKET_ADDON") or REPO / "demo_project/addons/thicket")
ARCH = {"amd64": "x86_64", "aarch64": "arm64"}.get(platform.machine().lower(), platform.machine().lower())
# A virtual environment that contains only the sampler's Python package and its dependencies.
WHEEL_VENV = REPO / "build/python/venv"
BUILD_DIR = REPO / "build" / f"{platform.system().lower()}.template_debug.{ARCH}"

# The names of the core's slow test cases, as the value of a doctest option.
LONG_CASES = ",".join(
    line for line in (REPO / "tests/core/long_cases.txt").read_text(encoding="utf-8").splitlines() if line[:1] not in ("", "#")
)

# Files whose tests are distributed to all workers. The tests of any other file run in the same worker, because they
# share fixtures.
SPREAD = ["test_core", "test_engine"]
# The slowest files, which run first. Files whose tests are distributed run last, so that all workers finish at about the
# same time.
LONG = [
    "test_package", "test_web", "test_platforms", "test_sanitizers", "test_engine_sanitizers", "test_coverage", "test_fuzz", "test_growth", "test_build",
    "test_editor", "test_demo", "test_figures", "test_python_package", "test_lint", "test_golden", "test_analysis", "test_bake_world",
    "test_tutorials", "test_domain_statistics",
]  # fmt: skip
# Files whose tests run in the same worker. Only one build may run in this tree at a time, and a test that waits for a
# build could time out. test_peers checks a result of the setup of test_figures.
BUILDS = ("test_package", "test_web", "test_sanitizers", "test_engine_sanitizers", "test_fuzz", "test_growth", "test_build", "test_platforms")
TOGETHER = {name: "builds" for name in BUILDS} | {"test_peers": "test_figures"}


def group(item: pytest.Item) -> str | None:
    """Returns the name of the group of tests that must run in the same worker, or None if any worker may run the
    test."""
    if alone(item):
        return "alone"
    if "imported_demo" in getattr(item, "fixturenames", ()):
        return "demo"  # Importing writes files into the project.
    return None if item.path.stem in SPREAD else TOGETHER.get(item.path.stem, item.path.stem)


def pytest_addoption(parser: pytest.Parser):
    parser.addoption("--full", action="store_true", help="also run slow tests, with the marker full")
    parser.addoption("--record-platforms", action="store_true", help="record platforms whose tests pass, for README.md (tests/tested_platforms.py)")


def pytest_configure(config: pytest.Config):
    """Assigns each worker its own cache folder for Godot. In a shared folder, one editor could read the documentation
    while another writes it."""
    os.environ["THICKET_CACHE"] = str(CACHE)
    os.environ["XDG_CACHE_HOME"] = str(CACHE / "engine" / os.environ.get("PYTEST_XDIST_WORKER", "alone"))
    os.makedirs(os.environ["XDG_CACHE_HOME"], exist_ok=True)
    if config.getoption("--record-platforms") and not is_worker(config):
        config.pluginmanager.register(tested_platforms.Recorder())


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]):
    """Deselects tests with the marker `full` unless --full is given. Sorts the tests for several workers: first the
    files that run in one worker each, then the distributed tests. Tests with the marker `alone` come last. While one of
    them waits, no other test starts, so no slow test should be running at that time."""

    def rank(item: pytest.Item) -> int:
        stem = item.path.stem
        return LONG.index(stem) if stem in LONG else len(LONG) + int(stem in SPREAD) + 2 * int(alone(item))

    if not config.getoption("--full"):
        longer = [item for item in items if item.get_closest_marker("full")]
        items[:] = [item for item in items if item not in longer]
        config.hook.pytest_deselected(items=longer)
    if not is_worker(config):
        return
    items.sort(key=rank)
    for item in items:
        if name := group(item):
            item.add_marker(pytest.mark.xdist_group(name))


def alone(item: pytest.Item) -> bool:
    return item.get_closest_marker("alone") is not None


def is_worker(config: pytest.Config) -> bool:
    """Returns true if this process is one of several workers. Returns false in a pytest run that a worker's test has
    started, although that run inherits the worker's environment."""
    return hasattr(config, "workerinput")


@contextmanager
def turn(config: pytest.Config, wants_to_be_alone: bool) -> Iterator[None]:
    """Waits until a test may run concurrently with the tests of other workers or, with `wants_to_be_alone`, until no other test
    is running."""
    if fcntl is None or not is_worker(config):
        yield
        return
    folder = REPO / "build"
    folder.mkdir(exist_ok=True)
    with (folder / ".tests_door").open("w") as door, (folder / ".tests_room").open("w") as room:
        # A test that waits until it is alone keeps this lock. Otherwise, new tests could keep starting.
        fcntl.flock(door, fcntl.LOCK_EX)
        fcntl.flock(room, fcntl.LOCK_EX if wants_to_be_alone else fcntl.LOCK_SH)
        fcntl.flock(door, fcntl.LOCK_UN)
        yield


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item):
    with turn(item.config, alone(item)):
        return (yield)


# The factor by which time limits are multiplied. The limits are meant only for processes that hang, and a shared
# machine can be much slower than usual for a while.
PATIENCE = 3


def run(command: list[str | Path], timeout: float, **options) -> subprocess.CompletedProcess[str]:
    """Runs a command until it exits, with text output and without standard input. `timeout` is in seconds, for an idle
    machine. A command that takes PATIENCE times as long is killed, together with the programs that it has started, and
    the test fails with its output."""
    timeout *= PATIENCE
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "errors": "replace", "stdin": subprocess.DEVNULL, **options}
    arguments = [str(part) for part in command]
    with subprocess.Popen(arguments, start_new_session=True, **options) as process:
        try:
            printed = process.communicate(timeout=timeout)
        except BaseException as failure:
            os.killpg(process.pid, signal.SIGKILL) if hasattr(os, "killpg") else process.kill()
            if not isinstance(failure, subprocess.TimeoutExpired):
                raise
            printed = "".join(text for text in process.communicate() if text)
            pytest.fail(f"{arguments[0]} ran longer than {timeout} s; its output:\n{printed[-4000:]}", pytrace=False)
    return subprocess.CompletedProcess(arguments, process.returncode, *printed)


def in_godots_root(command: list[str | Path], timeout: float) -> subprocess.CompletedProcess[str]:
    """Runs a program in the Debian root of Godot, which is in the cache folder."""
    enter = 'source tools/find.sh; enter_root "$(godot_root)"; exec "${enter[@]}" "$@"'
    return run(["bash", "-c", enter, "bash", *command], timeout, cwd=REPO)


def build(*arguments: str | Path, timeout: float, cwd: Path = REPO):
    """Builds with scons. If the build fails, the test fails with its output."""
    built = run(["scons", "-Q", f"-j{os.cpu_count()}", *arguments], timeout=timeout, cwd=cwd)
    assert built.returncode == 0, (built.stdout + built.stderr)[-8000:]


def check_engine_tests(addon: Path, *options: str, **environment: str):
    """Runs tests/engine in projects that contain only this add-on. `options` are passed to pytest."""
    completed = run([sys.executable, "-m", "pytest", "-n", "0", "-p", "no:cacheprovider", *options, "tests/engine/test_engine.py"], timeout=3600, cwd=REPO,
        env={**os.environ, "THICKET_ADDON": str(addon), **environment})  # fmt: skip
    assert completed.returncode == 0, completed.stdout[-6000:]


@pytest.fixture(scope="session")
def repo() -> Path:
    """Returns the repository's root."""
    return REPO


@pytest.fixture(scope="session")
def build_dir() -> Path:
    """Returns the folder of the template_debug build that all tests use: build/<platform>.template_debug.<arch>."""
    if not BUILD_DIR.is_dir():
        pytest.fail(f"{BUILD_DIR} does not exist: run scons, or bash tests/run.sh", pytrace=False)
    return BUILD_DIR


@pytest.fixture(scope="session")
def core_tool(build_dir: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Returns a function, core_tool(name, *args, timeout=300), that runs a program of the build. `name` is its path in
    the build folder, such as "core_tests" or "bench/sampler"."""

    def call(name: str, *args: str | Path, timeout: float = 300, **options) -> subprocess.CompletedProcess[str]:
        program = build_dir / name
        assert program.is_file(), f"{program} is not built: its source must be tests/{name}.cpp, with a main"
        return run([program, *args], timeout, **options)

    return call


@pytest.fixture(scope="session")
def references(build_dir: Path) -> References:
    """Returns reference point sets, for comparisons with the sampler's sets."""
    return References(build_dir / "analysis" / "references")


@contextmanager
def one_at_a_time(name: str) -> Iterator[None]:
    """Lets only one worker at a time enter a block with this name."""
    if fcntl is None:
        yield
        return
    (REPO / "build").mkdir(exist_ok=True)
    with (REPO / "build" / f".tests_{name}").open("w") as door:
        fcntl.flock(door, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def wheel() -> Path:
    """Builds the wheel for this Python version from the current sources with `bash python/build.sh`. Returns the path
    that the script prints."""
    with one_at_a_time("wheel"):
        completed = run(["bash", "python/build.sh"], timeout=1200, cwd=REPO, env={**os.environ, "PYTHON": sys.executable})
    assert completed.returncode == 0, completed.stdout + completed.stderr
    return REPO / re.search(r"^thicket: (build/python/poissontiles-\S+\.whl)$", completed.stderr, re.MULTILINE).group(1)


@pytest.fixture(scope="session")
def wheel_python(wheel: Path) -> Path:
    """Returns the Python interpreter of an environment with only the package and its dependencies. The environment is
    kept until the wheel changes."""
    with one_at_a_time("wheel"):
        # RECORD contains the digests of all files in the wheel. The bytes of the wheel itself are unsuitable, because
        # they include the build time.
        with ZipFile(wheel) as files:
            mark = files.read(next(name for name in files.namelist() if name.endswith(".dist-info/RECORD"))).decode()
        stamp = WHEEL_VENV / "complete"
        if not stamp.is_file() or stamp.read_text() != mark:
            shutil.rmtree(WHEEL_VENV, ignore_errors=True)
            wheels = CACHE / f"wheel-python{sys.version_info.major}.{sys.version_info.minor}/wheels"
            for command in (
                [sys.executable, "-m", "venv", WHEEL_VENV],
                [WHEEL_VENV / "bin/python", "-m", "pip", "install", "--quiet", "--no-index", "--find-links", wheels, wheel],
            ):
                completed = run(command, timeout=300)
                assert completed.returncode == 0, completed.stdout + completed.stderr
            stamp.write_text(mark)
    return WHEEL_VENV / "bin/python"


@pytest.fixture(scope="session")
def poissontiles(wheel_python: Path) -> ModuleType:
    """Returns the Python package, imported from the environment of `wheel_python`, which uses the same Python
    version."""
    completed = run([wheel_python, "-c", "import sysconfig; print(sysconfig.get_path('platlib'))"], timeout=60)
    sys.path.append(completed.stdout.strip())
    module = import_module("poissontiles")
    assert Path(module.__file__).is_relative_to(WHEEL_VENV)
    return module


def new_project(folder: Path, settings: str = "") -> Path:
    """Creates a project that contains only the add-on, in an empty folder. `settings` are additional lines for
    project.godot."""
    (folder / "project.godot").write_text(f'config_version=5\n[application]\nconfig/name="Thicket tests"\n{settings}')
    (folder / "addons").mkdir()
    (folder / "addons/thicket").symlink_to(ADDON)
    (folder / ".godot").mkdir()
    (folder / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    return folder


@pytest.fixture(scope="session")
def imported_demo(repo: Path) -> Path:
    """Returns the demo project after its resources have been imported and the engine has registered the extension."""
    project = repo / "demo_project"
    completed = run([repo / "tools/godot", "--headless", "--path", project, "--import"], timeout=600)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    return project


# The message of an editor that crashes at startup because two of its threads wait for the documentation at the same
# time. In Godot 4.6, EditorHelp::_wait_for_thread joins a thread without a lock.
ENDED_BY_DOCUMENTATION = re.compile(r"instance of 'std::system_error'\s+what\(\):\s+Invalid argument")


def run_godot(arguments: list[str | Path], timeout: float, **options) -> subprocess.CompletedProcess[str]:
    """Runs Godot. Runs an editor a second time if its documentation thread crashed it."""
    completed = run([REPO / "tools/godot", *arguments], timeout, **options)
    if "--editor" in arguments and ENDED_BY_DOCUMENTATION.search(completed.stderr):
        completed = run([REPO / "tools/godot", *arguments], timeout, **options)
    return completed


@pytest.fixture(scope="session")
def godot() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Returns a function, godot(args, timeout=300), that runs Godot with --headless and the arguments in the list
    `args`."""

    def call(args: list[str | Path], timeout: float = 300, **options) -> subprocess.CompletedProcess[str]:
        return run_godot(["--headless", *args], timeout, **options)

    return call


@pytest.fixture(scope="session")
def godot_xvfb() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Returns a function, godot_xvfb(args, timeout=600), that runs Godot with a window on a virtual display. The
    Compatibility renderer draws the window in software."""

    def call(args: list[str | Path], timeout: float = 600, **options) -> subprocess.CompletedProcess[str]:
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        return run_godot(["--xvfb", *args], timeout, **{"env": environment, **options})

    return call
