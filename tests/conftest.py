"""Fixtures for all tests. They run what the build made; `bash tests/run.sh` builds first, then calls pytest."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from analysis.point_sets import PointsTool

REPO = Path(__file__).resolve().parent.parent
ARCH = {"amd64": "x86_64", "aarch64": "arm64"}.get(platform.machine().lower(), platform.machine().lower())
BUILD_DIR = REPO / "build" / f"{platform.system().lower()}.template_debug.{ARCH}"


def run(command: list[str | Path], timeout: float, **options) -> subprocess.CompletedProcess[str]:
    """Runs a command to its end; text in and out, no standard input. A command that takes longer than timeout seconds
    is ended and fails the test, with what it had printed."""
    options = {"capture_output": True, "text": True, "errors": "replace", "stdin": subprocess.DEVNULL, **options}
    try:
        return subprocess.run([str(part) for part in command], timeout=timeout, check=False, **options)
    except subprocess.TimeoutExpired as expired:
        printed = b"".join(text for text in (expired.stdout, expired.stderr) if text).decode(errors="replace")
        pytest.fail(f"{command[0]} ran longer than {timeout} s; it had printed:\n{printed[-4000:]}", pytrace=False)


@pytest.fixture(scope="session")
def repo() -> Path:
    """The repository's root."""
    return REPO


@pytest.fixture(scope="session")
def build_dir() -> Path:
    """The folder of the template_debug build that all tests use: build/<platform>.template_debug.<arch>."""
    if not BUILD_DIR.is_dir():
        pytest.fail(f"{BUILD_DIR} is not there: run scons, or bash tests/run.sh", pytrace=False)
    return BUILD_DIR


@pytest.fixture(scope="session")
def core_tool(build_dir: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """core_tool(name, *args, timeout=300): runs a program that the build made, named by its path in the build folder
    ("core_tests", "bench/sampler", "analysis/spectrum")."""

    def call(name: str, *args: str | Path, timeout: float = 300, **options) -> subprocess.CompletedProcess[str]:
        program = build_dir / name
        assert program.is_file(), f"{program} is not built: its source belongs at tests/{name}.cpp, with a main"
        return run([program, *args], timeout, **options)

    return call


@pytest.fixture(scope="session")
def tool(build_dir: Path) -> PointsTool:
    """Point sets for the statistics."""
    return PointsTool(build_dir / "analysis" / "points")


@pytest.fixture(scope="session")
def imported_demo(repo: Path) -> Path:
    """The demo project, with its resources imported and its extension known to the engine."""
    project = repo / "demo_project"
    done = run([repo / "tools/godot", "--headless", "--path", project, "--import"], timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return project


@pytest.fixture(scope="session")
def godot(repo: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """godot(args, timeout=300): runs Godot with --headless; args are its arguments, as a list."""

    def call(args: list[str | Path], timeout: float = 300, **options) -> subprocess.CompletedProcess[str]:
        return run([repo / "tools/godot", "--headless", *args], timeout, **options)

    return call


@pytest.fixture(scope="session")
def godot_xvfb(repo: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """godot_xvfb(args, timeout=600): runs Godot with a window on a display that nobody sees, drawn in software by the
    Compatibility renderer."""

    def call(args: list[str | Path], timeout: float = 600, **options) -> subprocess.CompletedProcess[str]:
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        return run([repo / "tools/godot", "--xvfb", *args], timeout, **{"env": environment, **options})

    return call
