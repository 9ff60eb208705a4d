"""Tests the files of the Python package for other machines: the source distribution, and wheels that zig builds for any Linux."""

from __future__ import annotations

import glob
import os
import re
import shutil
import struct
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from conftest import REPO, run
from golden.cases import SETS

pytestmark = pytest.mark.full

ARM64 = 183  # The number of the processor in the header of an ELF file.


def newer_python() -> str | None:
    """Returns a Python whose modules work in later versions, or None if this machine has none."""
    interpreters = [sys.executable, *(shutil.which(f"python3.{minor}") for minor in range(12, 20)), *glob.glob(f"{Path.home()}/.pyenv/versions/3.1[2-9].*/bin/python3")]
    for python in filter(None, interpreters):
        if run([python, "-c", "import sys; sys.exit(sys.version_info < (3, 12))"], timeout=20).returncode == 0:
            return python
    return None


def check_points(python: Path, folder: Path):
    one = SETS[0]
    text = f"import poissontiles; print(poissontiles.sample({one.rect}, {one.radius}, {one.seed}, levels={one.levels}, layer={one.layer}).digest())"
    assert run([python, "-c", text], timeout=60, cwd=folder).stdout.strip() == str(one.digests)


def test_wheels_for_any_linux(tmp_path):
    python = newer_python()
    if python is None:
        pytest.skip("no Python 3.12 or newer")
    result = run(["bash", "python/build.sh", "--manylinux"], timeout=1800, cwd=REPO, env={**os.environ, "PYTHON": python})
    assert result.returncode == 0, result.stdout + result.stderr
    wheels = {name.rsplit("manylinux_2_17_", 1)[1]: REPO / name for name in re.findall(r"build/python/\S*manylinux\S*\.whl", result.stderr)}
    assert set(wheels) == {"x86_64.whl", "aarch64.whl"}
    for wheel in wheels.values():
        assert "-cp312-abi3-" in wheel.name
    with ZipFile(wheels["aarch64.whl"]) as files:
        (module,) = (name for name in files.namelist() if name.endswith(".so"))
        assert struct.unpack_from("<H", files.read(module), 18) == (ARM64,)
        assert b"def sample_surface" in files.read("poissontiles/_core.pyi")
    # The wheel for this processor returns the same points as every other build.
    run([python, "-m", "venv", tmp_path / "venv"], timeout=120)
    result = run([tmp_path / "venv/bin/python", "-m", "pip", "install", "--quiet", wheels["x86_64.whl"]], timeout=300)
    assert result.returncode == 0, result.stderr
    check_points(tmp_path / "venv/bin/python", tmp_path)


def test_the_source_distribution_builds(wheel, tmp_path):
    """Builds a wheel from the source distribution alone, and compares a digest."""
    result = run(["bash", "python/build.sh", "--sdist"], timeout=300, cwd=REPO, env={**os.environ, "PYTHON": sys.executable})
    assert result.returncode == 0, result.stdout + result.stderr
    source = REPO / re.search(r"^thicket: (build/python/poissontiles-\S+\.tar\.gz)$", result.stderr, re.MULTILINE).group(1)
    venv = tmp_path / "venv"
    tools = ["ninja", "cmake"]
    for command in (
        [sys.executable, "-m", "venv", venv],
        [venv / "bin/python", "-m", "pip", "install", "--quiet", *tools],
        [venv / "bin/python", "-m", "pip", "install", "--quiet", source],
    ):
        result = run(command, timeout=1200, cwd=tmp_path)
        assert result.returncode == 0, result.stdout + result.stderr
    check_points(venv / "bin/python", tmp_path)
