"""Three quarters of a minute of everything at once, and with --full twenty minutes; tests/bench/soak.gd runs longer by
hand."""

from __future__ import annotations

import os
import re

import pytest
from conftest import REPO
from test_demo import complaints

# glibc has one arena and gives back at once what is free, or that would hide what is not freed: threads' own arenas keep more and more
# for a quarter of an hour, and thresholds that adapt keep up to 8 % more at one time than at another.
GIVES_BACK = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "131072", "MALLOC_TRIM_THRESHOLD_": "131072"}


@pytest.mark.parametrize("seconds", [45, pytest.param(1200, marks=pytest.mark.full)])
def test_nothing_grows(godot, imported_demo, seconds):
    script = REPO / "tests/bench/soak.gd"
    arguments = ["--verbose", "--path", imported_demo, "--script", script, "--", str(seconds), "5"]
    done = godot(arguments, timeout=2 * seconds + 310, env={**os.environ, **GIVES_BACK})
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and "soak: passed" in done.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    assert "leaked" not in printed, printed[-4000:]
    counts = re.findall(r"^soak: .* (\d+) felled, (\d+) planted, (\d+) answers, (\d+) loads", done.stdout, re.MULTILINE)
    assert all(int(count) > least for count, least in zip(counts[-1], (1_000, 100, 100, 4), strict=True)), done.stdout
