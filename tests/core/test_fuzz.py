"""Runs each fuzz target with random input for a few seconds, under the address and undefined-behavior sanitizers. This
is a smoke test of the targets in tests/fuzz, which can run for hours (see tests/fuzz/fuzz_main.hpp). Inputs come from
fixed seeds, so failures are reproducible. The number of inputs depends on the speed of the machine."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from conftest import BUILD_DIR, REPO, build, run

SECONDS = 7
FULL_SECONDS = 180
FULL_SEED = 1_000_003  # The inputs differ from those of the short run.
TARGETS = ["fuzz_sampler", "fuzz_domain", "fuzz_tile", "fuzz_streamer", "fuzz_mask", "fuzz_shapes", "fuzz_state", "fuzz_heightmap"]


@pytest.fixture(scope="session")
def sanitized() -> Path:
    """Returns the build folder that contains the fuzz targets with both sanitizers."""
    folder = BUILD_DIR.with_name(BUILD_DIR.name + ".address.undefined.scu")
    programs = [(folder / "fuzz" / target).relative_to(REPO) for target in TARGETS]
    build("sanitize=address,undefined", "scu_build=yes", *programs, timeout=1800)
    return folder


def fuzz(program: Path, seconds: int, *seed: str):
    # If memory runs out, an allocation must fail instead of aborting the program, so that the call can return an error.
    environment = {**os.environ, "ASAN_OPTIONS": "allocator_may_return_null=1"}
    result = run([program, str(seconds), *seed], timeout=seconds + 120, env=environment)
    assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-4000:]
    inputs = re.search(r"(\d+) inputs", result.stdout)
    assert inputs and int(inputs[1]) >= 100, result.stdout


@pytest.mark.parametrize("target", TARGETS)
def test_random_input(sanitized, target):
    fuzz(sanitized / "fuzz" / target, SECONDS)


@pytest.mark.full
@pytest.mark.parametrize("target", TARGETS)
def test_random_input_for_longer(sanitized, target):
    fuzz(sanitized / "fuzz" / target, FULL_SECONDS, str(FULL_SEED))
