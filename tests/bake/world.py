"""Provides the small world for the tests of the baker, and functions that bake it and inspect the results."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil
import pyarrow.parquet as pq
import pytest
from conftest import REPO, new_project, run

BAKES = REPO / "tests/bake"
TOOLS = REPO / "tools/bake"
RECT = (-70.0, -50.0, 130.0, 100.0)
# The default area of a bake: 5 by 4 tiles that coincide with the tiles of the trees.
USUAL = ["--rect", ",".join(map(str, RECT)), "--tile-size", "32"]
PLACED_BY_HAND = 2


def make_world(folder: Path) -> Path:
    """Creates a project with the scene that tests/bake/make_world.gd writes."""
    folder.mkdir()
    new_project(folder, f'config/use_custom_user_dir=true\nconfig/custom_user_dir_name="{user_folder_name(folder)}"\n')
    for script in ("hills.gd", "make_world.gd", "game.gd"):
        shutil.copy(BAKES / script, folder)
    completed = run([REPO / "tools/godot", "--headless", "--path", folder, "--script", "make_world.gd"], timeout=60)
    assert completed.returncode == 0 and (folder / "world.tscn").is_file(), completed.stdout + completed.stderr
    return folder


def user_folder_name(project: Path) -> str:
    """Returns the name of the user:// folder of a test project."""
    return "thicket_tests_" + re.sub(r"\W", "_", str(project))


@contextlib.contextmanager
def ground(project: Path, manner: str) -> Iterator[None]:
    """Makes the ground "bad" or "slow" within the `with` block; see tests/bake/hills.gd."""
    flag = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local/share") / user_folder_name(project) / "ground"
    flag.parent.mkdir(parents=True, exist_ok=True)
    flag.write_text(manner)
    try:
        yield
    finally:
        shutil.rmtree(flag.parent)


def command(project: Path, out: Path, *options: str) -> list[str]:
    """Returns the command that bakes the test world."""
    return [sys.executable, "-m", "baking", str(project / "world.tscn"), str(out), *USUAL, *options]


def environment() -> dict[str, str]:
    """Returns the environment variables that the command needs."""
    return {**os.environ, "PYTHONPATH": str(TOOLS)}


@dataclass
class Baked:
    """The exit code, the output and the folder of a bake."""

    code: int
    output: str
    out: Path

    @property
    def manifest(self) -> dict:
        return json.loads((self.out / "manifest.json").read_text(encoding="utf-8"))

    def file(self, tile: str) -> Path:
        """Returns the path of the file of a tile. `tile` is the tile's key in the manifest."""
        return self.out / self.manifest["tiles"][tile]["file"]

    def rows(self) -> dict[tuple, tuple]:
        """Returns all rows of all tiles, keyed by layer and ID."""
        found: dict[tuple, tuple] = {}
        for entry in self.manifest["tiles"].values():
            table = pq.read_table(self.out / entry["file"])
            for row in zip(*(table[name].to_pylist() for name in table.schema.names), strict=True):
                assert (row[1], row[0]) not in found, "an instance is in two tiles"
                found[row[1], row[0]] = row
        return found


def bake(project: Path, out: Path, *options: str, timeout: float = 120, **further) -> Baked:
    """Bakes the test world with the command-line program, and waits until it exits."""
    completed = run(command(project, out, *options), timeout, env=environment(), **further)
    return Baked(completed.returncode, completed.stdout + completed.stderr, out)


def begin(project: Path, out: Path, *options: str) -> subprocess.Popen:
    """Starts a bake in a separate process group, with the default handler for SIGINT. Without that handler, a bake
    would ignore Ctrl-C if the tests run in the background with `&`."""
    return subprocess.Popen(
        command(project, out, *options), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        start_new_session=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip


def workers_of(driver: subprocess.Popen) -> list[psutil.Process]:
    """Returns the worker processes of a driver."""
    return [each for each in processes_below(driver, recursive=False) if is_worker(each)]


def processes_below(driver: subprocess.Popen, recursive: bool = True) -> list[psutil.Process]:
    """Returns the child processes of a driver, or an empty list if the driver has exited."""
    try:
        return psutil.Process(driver.pid).children(recursive)
    except psutil.NoSuchProcess:
        return []


def is_worker(process: psutil.Process) -> bool:
    """Returns true if a process is a worker of a driver."""
    try:
        words = " ".join(process.cmdline())
    except psutil.Error:
        return False
    return "multiprocessing.spawn" in words and "resource_tracker" not in words


def engines_below(process: psutil.Process) -> list[psutil.Process]:
    """Returns the engine processes that a process has started."""
    try:
        return [each for each in process.children(recursive=True) if each.name().startswith("godot")]
    except psutil.Error:
        return []


def is_engine_of(process: psutil.Process, project: Path) -> bool:
    """Returns true if a process is an engine that runs the project."""
    try:
        return process.name().startswith("godot") and str(project) in process.cmdline()
    except psutil.Error:
        return False


def has_ended(process: psutil.Process) -> bool:
    """Returns true if a process has exited, even if its exit code has not been collected."""
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.Error:
        return True


def kill(pid: int) -> None:
    """Sends SIGKILL to a process that may already have ended."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def wait_for(condition: Callable[[], object], what: str, timeout: float = 60.0) -> None:
    """Waits until the condition is true. Fails the test after `timeout` seconds."""
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline, f"not true within {timeout} s: {what}"
        time.sleep(0.02)


@pytest.fixture(scope="module")
def world(tmp_path_factory) -> Path:
    return make_world(tmp_path_factory.mktemp("bake") / "project")


@pytest.fixture(scope="module")
def baked(world, tmp_path_factory) -> Baked:
    """Returns the world, baked by two workers."""
    completed = bake(world, tmp_path_factory.mktemp("baked"), "--workers", "2")
    assert completed.code == 0, completed.output
    return completed
