"""Tests the film of README.md and of the documentation, and the command that makes it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import REPO, run
from PIL import Image

PICTURES = REPO / "demo_project/pictures"
FPS = 12


def seconds_of_mp4(path: Path) -> float:
    """Returns the duration that the header of an MP4 file states (ISO/IEC 14496-12, mvhd, version 0)."""
    data = path.read_bytes()
    at = data.index(b"mvhd") + 4
    assert data[at] == 0
    scale, duration = (int.from_bytes(data[at + offset : at + offset + 4], "big") for offset in (12, 16))
    return duration / scale


def frames_of(path: Path) -> tuple[list[np.ndarray], float]:
    """Returns the frames of a WebP file, small and in shades of gray, and its duration in seconds."""
    frames, milliseconds = [], 0
    with Image.open(path) as film:
        assert film.format == "WEBP"
        for number in range(film.n_frames):
            film.seek(number)
            film.load()
            milliseconds += film.info["duration"]
            frames.append(np.asarray(film.convert("L").resize((160, 90)), np.float64))
    return frames, milliseconds / 1000.0


def test_the_film_of_the_readme():
    """Checks that the film is the first image of the page, is small and has the promised length, and that no frame is blank."""
    text = (REPO / "README.md").read_text(encoding="utf-8")
    film = PICTURES / "film.webp"
    assert re.search(r"!\[[^\]]+\]\((.+?)\)", text).group(1) == film.relative_to(REPO).as_posix()
    assert film.stat().st_size < 4_000_000
    frames, seconds = frames_of(film)
    assert 20.0 <= seconds <= 30.0
    assert min(frame.std() for frame in frames) > 10.0
    moving = sum(np.abs(after - before).mean() > 0.2 for before, after in zip(frames, frames[1:], strict=False))
    assert moving > 0.5 * 20 * FPS, "most frames differ from the previous one"


def test_the_film_of_the_documentation():
    """Checks that the front page shows the film, which must start before it is loaded completely."""
    page = (REPO / "docs/index.md").read_text(encoding="utf-8")
    film = PICTURES / "film.mp4"
    assert 'src="_static/film.mp4"' in page and 'poster="_static/film.jpg"' in page
    assert film.stat().st_size < 8_000_000 and 20.0 <= seconds_of_mp4(film) <= 30.0
    data = film.read_bytes()
    assert b"avc1" in data and data.index(b"moov") < data.index(b"mdat")
    with Image.open(PICTURES / "film.jpg") as poster:
        assert poster.size == (960, 540)


@pytest.mark.full
def test_the_command_makes_a_film(imported_demo, tmp_path):
    """Makes a film of two frames per flight."""
    if not shutil.which("ffmpeg"):
        pytest.skip("no ffmpeg to encode the film: run tests/run.sh --full, which installs it")
    completed = run(["bash", "tools/film.sh", "--built", "--short", tmp_path], timeout=600, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    frames, seconds = frames_of(tmp_path / "film.webp")
    flights = [path for path in (tmp_path / "frames").iterdir() if path.is_dir()]
    assert len(flights) == 4 and all(len(list(flight.glob("*.png"))) == 2 for flight in flights)
    assert seconds == pytest.approx(seconds_of_mp4(tmp_path / "film.mp4"), abs=0.1) and min(frame.std() for frame in frames) > 10.0
