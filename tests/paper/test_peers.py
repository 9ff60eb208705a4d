"""Tests that the samplers of other projects, which the benchmarks use for comparison, are installed, called and reported
correctly."""

from __future__ import annotations

import json
import math
import os
import struct
import sys
from pathlib import Path

import numpy
import pytest
from conftest import REPO, run
from scipy.spatial import cKDTree

PEERS = REPO / "tests/bench/peers"
PYTHON_RUNNER = [sys.executable, PEERS / "run_python_peer.py"]
RUST_RUNNER = REPO / "build/peers/faster_poisson"
KEYS = {"method", "points", "seconds", "size", "maximal_claimed", "toroidal", "precision", "version"}


def shell(script: str, **environment: str):
    """Runs a shell command with the functions that install the peers and with additional environment variables."""
    changed = {**os.environ, **environment}
    return run(
        ["bash", "-euo", "pipefail", "-c", f"source tests/bench/peers/setup.sh; {script}"],
        timeout=60,
        cwd=REPO,
        env=changed,
    )


@pytest.mark.parametrize(
    ("version", "taken"),
    [
        ("cargo 1.95.0 (f2d3ce0bd 2026-03-21)", True),
        ("1.85.0+dfsg3-1~deb12u3", True),
        ("cargo 1.84.1", False),
        ("0.66.0+ds1-1", False),
        ("(none)", False),
        ("", False),
    ],
)
def test_versions_of_rust(version, taken):
    assert (shell(f"is_new_rust '{version}'").returncode == 0) == taken


def test_a_missing_rust_is_reported(tmp_path):
    """Checks a machine on which cargo is neither on the PATH nor in the package lists. The script must print one line
    and return an error, after which the caller can continue."""
    for name in ("cargo", "apt-cache"):
        (tmp_path / name).write_text("#!/bin/sh\nexit 1\n")
        (tmp_path / name).chmod(0o755)
    output = shell("setup_peers_rust || echo going on", PATH=f"{tmp_path}:/usr/bin:/bin")
    assert output.returncode == 0 and output.stdout == "going on\n"
    assert output.stderr.count("\n") == 1 and "1.85" in output.stderr


def check_line_and_set(command: list, name: str, dump: Path):
    completed = run([*command, name, "400", "3", f"dump={dump}"], timeout=120)
    assert completed.returncode == 0, completed.stderr
    line = json.loads(completed.stdout)
    assert set(line) == KEYS and line["method"] == name and line["seconds"] > 0.0
    assert line["size"] == pytest.approx(math.sqrt(400 * math.pi / 4 / 0.547070))
    raw = dump.read_bytes()
    (count,) = struct.unpack("<Q", raw[:8])
    points = numpy.frombuffer(raw[8:], "<f8").reshape(-1, 2)
    assert count == len(points) == line["points"] > 300
    assert points.min() >= 0.0 and points.max() < line["size"]
    assert cKDTree(points).query(points, k=2)[0][:, 1].min() >= 1.0 - 1e-5


def test_python_peer(tmp_path):
    check_line_and_set(PYTHON_RUNNER, "scipy_poisson_disk", tmp_path / "set")


@pytest.mark.parametrize("name", ["faster_poisson_dart", "faster_poisson_bridson", "faster_poisson_parental"])
def test_rust_peer(tmp_path, name):
    if not RUST_RUNNER.is_file():
        pytest.skip("only tests/bench/figures.sh builds faster_poisson")
    check_line_and_set([RUST_RUNNER], name, tmp_path / "set")


@pytest.mark.parametrize("arguments", [[], ["no_such_sampler", "100", "1"], ["scipy_poisson_disk", "100"]])
def test_a_wrong_call_is_rejected(arguments):
    completed = run([*PYTHON_RUNNER, *arguments], timeout=60)
    assert completed.returncode == 2 and completed.stderr.startswith("usage:")
