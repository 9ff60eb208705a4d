"""Several workers share these tests by groups (see conftest.py): builds in one tree must not meet, and what takes long comes first."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import SimpleNamespace

import conftest
from conftest import REPO, run

GROUPED = """import pytest

@pytest.mark.xdist_group("long")
def test_first():
    pass

@pytest.mark.xdist_group("one")
@pytest.mark.parametrize("number", range(8))
def test_number(number):
    pass
"""


def took(workers: int, tmp_path: Path) -> list[tuple[str, str]]:
    """(worker, test) of GROUPED in the order of their ends, with the options of tests/run.sh."""
    (tmp_path / "test_grouped.py").write_text(GROUPED)
    options = re.search(r"--dist .*?(?= \")", (REPO / "tests/run.sh").read_text())[0].split()
    done = run([sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "-n", str(workers), *options, tmp_path], timeout=120)
    assert done.returncode == 0, done.stdout
    return re.findall(r"^\[(gw\d)\].* PASSED \S+::(\w+)", done.stdout, re.MULTILINE)


def test_a_group_goes_to_one_worker(tmp_path):
    """What pytest calls a test and what its plugin for workers does with that have not always fitted together."""
    numbers = [worker for worker, name in took(2, tmp_path) if name == "test_number"]
    assert len(numbers) == 8 and len(set(numbers)) == 1


def test_the_order_is_kept(tmp_path):
    """The plugin would begin with the groups of most tests, unless it is told otherwise."""
    assert [name for _, name in took(1, tmp_path)] == ["test_first"] + 8 * ["test_number"]


def test_a_run_within_a_test_waits_for_nobody(tmp_path, monkeypatch):
    """It would wait for the test that has begun it, which waits for its end."""
    monkeypatch.setattr(conftest, "REPO", tmp_path)
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "gw0")
    with conftest.turn(SimpleNamespace(), True):
        assert not list(tmp_path.iterdir())
    with conftest.turn(SimpleNamespace(workerinput={}), True):
        assert (tmp_path / "build/.tests_room").exists()
