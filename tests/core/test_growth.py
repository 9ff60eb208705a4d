"""Tests that the cost of the core's states, masks, regions and meshes is not quadratic in the size of the input, for all kinds
of input. tests/cost counts steps instead of seconds, so the load of the machine has no influence."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
from conftest import BUILD_DIR, REPO, build, run

ROUNDS = 6
FULL_ROUNDS = 300
FULL_SEED = 1_000_003  # The inputs differ from those of the short run.


@pytest.fixture(scope="session")
def growth() -> Path:
    """Returns the path of the program that compares the steps for inputs of two sizes."""
    if not sys.platform.startswith("linux") or shutil.which("g++") is None:
        pytest.skip("only g++ on Linux can count steps")
    program = BUILD_DIR.with_name(BUILD_DIR.name + ".steps") / "cost" / "growth"
    build("count_steps=yes", "CXX=g++", program.relative_to(REPO), timeout=1800)
    return program


def check(program: Path, rounds: int, seed: int, timeout: float):
    result = run([program, str(rounds), str(seed)], timeout=timeout)
    assert result.returncode == 0, result.stdout[-6000:] + result.stderr[-2000:]
    assert f" {rounds} rounds, 0 failed" in result.stdout


def test_four_times_the_input_takes_at_most_six_times_the_steps(growth):
    check(growth, ROUNDS, 1, timeout=300)


@pytest.mark.full
def test_no_input_of_many_costs_too_much(growth):
    check(growth, FULL_ROUNDS, FULL_SEED, timeout=3600)
