"""Three quarters of a minute of everything at once; tests/bench/soak.gd runs longer by hand."""

from __future__ import annotations

import re

from conftest import REPO
from test_demo import complaints


def test_nothing_grows(godot, imported_demo):
    script = REPO / "tests/bench/soak.gd"
    done = godot(["--verbose", "--path", imported_demo, "--script", script, "--", "45", "5"], timeout=400)
    printed = done.stdout + done.stderr
    assert done.returncode == 0 and "soak: passed" in done.stdout, printed[-4000:]
    assert not complaints(printed), complaints(printed)
    assert "leaked" not in printed, printed[-4000:]
    counts = re.findall(r"^soak: .* (\d+) felled, (\d+) planted, (\d+) answers, (\d+) loads", done.stdout, re.MULTILINE)
    assert all(int(count) > least for count, least in zip(counts[-1], (1_000, 100, 100, 4), strict=True)), done.stdout
