"""Tests that impostors look like their models from all sides and react to the scene's light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import REPO, new_project
from PIL import Image
from scipy.ndimage import gaussian_filter

PICTURES = REPO / "tests/engine/impostor_pictures.gd"
DIRECTIONS = 16
SUNS = 2
# Half of the width, in pixels, of the square around the model's bounding sphere when the impostor replaces the model. The
# square then covers 128 atlas pixels, at 1.75 per screen pixel.
HALF = round(128 / 1.75 / 2)


def structural_similarity(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Returns the similarity of each pixel, computed from brightness values of 0 to 255: Wang, Bovik, Sheikh and Simoncelli, Image Quality Assessment: From
    Error Visibility to Structural Similarity, 2004, section III."""

    def mean(image):
        return gaussian_filter(image, 1.5, truncate=3.5)

    c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    m1, m2 = mean(one), mean(other)
    v1, v2, both = mean(one * one) - m1 * m1, mean(other * other) - m2 * m2, mean(one * other) - m1 * m2
    return (2 * m1 * m2 + c1) * (2 * both + c2) / ((m1 * m1 + m2 * m2 + c1) * (v1 + v2 + c2))


def brightness(path: Path) -> np.ndarray:
    image = np.asarray(Image.open(path).convert("RGB"), np.float64) @ [0.299, 0.587, 0.114]
    middle = image.shape[0] // 2
    return image[middle - HALF : middle + HALF, middle - HALF : middle + HALF]


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    return new_project(tmp_path_factory.mktemp("impostors"))


def take(godot_xvfb, project: Path, folder: Path, *options: str) -> Path:
    folder.mkdir()
    completed = godot_xvfb([*options, "--path", project, "--script", PICTURES, "--", folder], timeout=900)
    printed = completed.stdout + completed.stderr
    assert completed.returncode == 0 and "ERROR" not in printed, printed
    assert len(list(folder.iterdir())) == 2 * 2 * SUNS * DIRECTIONS
    return folder


@pytest.fixture(scope="module")
def pictures(godot_xvfb, project) -> Path:
    return take(godot_xvfb, project, project / "pictures")


def similarities(folder: Path, model: str) -> np.ndarray:
    """Returns the mean similarity for each sun and direction."""
    return np.array([
        [
            structural_similarity(
                brightness(folder / f"{model}_s{sun}_d{at:02d}_model.png"),
                brightness(folder / f"{model}_s{sun}_d{at:02d}_impostor.png"),
            ).mean()
            for at in range(DIRECTIONS)
        ]
        for sun in range(SUNS)
    ])  # fmt: skip


@pytest.mark.parametrize("model", ["tree", "stone"])
def test_an_impostor_looks_like_its_model(pictures, model):
    found = similarities(pictures, model)
    assert found.min() >= 0.9, found.round(3)


@pytest.mark.parametrize("model", ["tree", "stone"])
def test_an_impostor_is_lit_by_the_sun(pictures, model):
    """Moving the sun changes model and impostor strongly and in the same way. An impostor with baked light would not change."""
    for at in range(DIRECTIONS):
        change = {}
        for what in ("model", "impostor"):
            one, other = (brightness(pictures / f"{model}_s{sun}_d{at:02d}_{what}.png") for sun in range(SUNS))
            change[what] = other - one
        assert np.abs(change["model"]).mean() > 2.0, at
        together = np.corrcoef(gaussian_filter(change["model"], 2).ravel(), gaussian_filter(change["impostor"], 2).ravel())
        assert together[0, 1] > 0.8, (at, together)


@pytest.mark.full
@pytest.mark.parametrize("method", ["forward_plus", "mobile"])
def test_an_impostor_looks_like_its_model_with_vulkan(godot_xvfb, project, method):
    folder = take(godot_xvfb, project, project / method, "--rendering-method", method, "--rendering-driver", "vulkan")
    for model in ("tree", "stone"):
        found = similarities(folder, model)
        assert found.min() >= 0.88 and found.mean() >= 0.9, found.round(3)
