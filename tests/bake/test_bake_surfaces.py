"""Tests bakes of layers that grow on all surfaces of the ground."""

from __future__ import annotations

import json
import shutil

from bake.world import BAKES, bake
from conftest import REPO, new_project, run


def test_a_bake_contains_every_level(tmp_path):
    """Checks that a bake has the instances of the running scene on floor, bridge and wall, for two sizes of tiles."""
    project = tmp_path / "project"
    project.mkdir()
    new_project(project, "")
    shutil.copy(BAKES / "make_levels.gd", project)
    made = run([REPO / "tools/godot", "--headless", "--path", project, "--script", "make_levels.gd"], timeout=60)
    assert made.returncode == 0, made.stdout + made.stderr
    line = next(line for line in made.stdout.splitlines() if line.startswith("instances "))
    expected = {int(id): position for id, position in json.loads(line.removeprefix("instances ")).items()}
    heights = [position[1] for position in expected.values()]
    assert sum(height < 1.0 for height in heights) > 2000
    assert sum(height > 9.0 for height in heights) > 400
    assert sum(1.0 < height < 8.0 for height in heights) > 200, "the wall has instances"

    for size in ("16", "32"):
        # The options that come later replace the rectangle and tile size of the other tests.
        baked = bake(project, tmp_path / size, "--rect", "-32,-32,64,64", "--tile-size", size)
        assert baked.code == 0, baked.output
        rows = baked.rows()
        assert {id for _, id in rows} == set(expected)
        for (_, id), row in rows.items():
            at = [value for value in row if isinstance(value, float)][:3]
            assert all(abs(a - b) < 1e-3 for a, b in zip(at, expected[id], strict=True)), (at, expected[id])
