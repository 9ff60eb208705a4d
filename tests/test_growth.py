"""The cost of the core's states, masks, regions and meshes grows no faster than their input, whatever the input: tests/cost
counts steps instead of seconds, so a busy machine changes nothing."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
from conftest import BUILD_DIR, REPO, build, run

ROUNDS = 6
FULL_ROUNDS = 300
FULL_SEED = 1_000_003  # Other inputs than those of the short run.


@pytest.fixture(scope="session")
def growth() -> Path:
    """The program that compares the steps for inputs of two sizes."""
    if not sys.platform.startswith("linux") or shutil.which("g++") is None:
        pytest.skip("steps are counted by g++ on Linux")
    program = BUILD_DIR.with_name(BUILD_DIR.name + ".steps") / "cost" / "growth"
    build("count_steps=yes", "CXX=g++", program.relative_to(REPO), timeout=1800)
    return program


def check(program: Path, rounds: int, seed: int, timeout: float):
    done = run([program, str(rounds), str(seed)], timeout=timeout)
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert f" {rounds} rounds, 0 failed" in done.stdout


def test_four_times_the_input_is_no_more_than_six_times_the_steps(growth):
    check(growth, ROUNDS, 1, timeout=300)


@pytest.mark.full
def test_of_many_inputs_none_costs_too_much(growth):
    check(growth, FULL_ROUNDS, FULL_SEED, timeout=3600)
