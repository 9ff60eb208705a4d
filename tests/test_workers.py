"""Several workers share these tests by groups (see conftest.py): builds in one tree must not meet."""

from __future__ import annotations

import re
import sys

from conftest import run

GROUPED = """import pytest

@pytest.mark.xdist_group("one")
@pytest.mark.parametrize("number", range(8))
def test_number(number):
    pass
"""


def test_a_group_goes_to_one_worker(tmp_path):
    """What pytest calls a test and what its plugin for workers does with that have not always fitted together."""
    (tmp_path / "test_grouped.py").write_text(GROUPED)
    workers = ["-n", "2", "--dist", "loadgroup"]
    done = run([sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", *workers, tmp_path], timeout=120)
    assert done.returncode == 0, done.stdout
    took = re.findall(r"^\[(gw\d)\].* PASSED", done.stdout, re.MULTILINE)
    assert len(took) == 8 and len(set(took)) == 1, done.stdout
