"""Flies slowly ahead from some of the demo's stops and checks frame by frame that nothing pops. Writes the films to
build/film."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import REPO
from PIL import Image

PICTURES = 20
# The camera's movement between two frames. It moves the nearest objects in the images by a few pixels.
METERS = {"overview": 1.0, "forest": 0.25, "ridge": 0.1, "tiles": 0.5}
BLOCK = 8  # The edge length of a block in pixels.
# The maximum change in a block's mean brightness (0 to 1) between two frames. The movement alone changes it by up to 0.11,
# because nearby leaves enter and leave a block.
MOST = 0.16


def blocks(path) -> np.ndarray:
    image = np.asarray(Image.open(path).convert("L"), np.float64) / 255.0
    rows, columns = (size // BLOCK for size in image.shape)
    return image[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK).mean(axis=(1, 3))


@pytest.mark.full
@pytest.mark.parametrize("stop", METERS)
def test_nothing_pops(godot_xvfb, imported_demo, tmp_path, stop):
    script = REPO / "tests/bench/film.gd"
    arguments = ["--path", imported_demo, "--script", script, "--", tmp_path, stop, str(PICTURES), str(METERS[stop])]
    completed = godot_xvfb(arguments, timeout=600)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    paths = sorted(tmp_path.glob("*.png"))
    assert len(paths) == PICTURES
    film = [Image.open(path).convert("RGB") for path in paths]
    folder = REPO / "build/film"
    folder.mkdir(parents=True, exist_ok=True)
    film[0].save(folder / f"{stop}.webp", save_all=True, append_images=film[1:], duration=80, loop=0)
    seen = [blocks(path) for path in paths]
    changes = [np.abs(after - before).max() for before, after in zip(seen, seen[1:], strict=False)]
    assert max(changes) > 0.001, "it moves"
    assert max(changes) < MOST, [f"{change:.3f}" for change in changes]
