"""Tests the records of tested platforms, and that the tables in README.md and the documentation match them."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import tested_platforms
from conftest import REPO
from tested_platforms import PLATFORMS, Recorder

LINUX, ARM, WINDOWS = PLATFORMS[:3]


@pytest.mark.parametrize("page", tested_platforms.PAGES, ids=lambda page: page.name)
def test_the_tables_match_the_records(page):
    """Checks that no table was edited by hand or has become outdated."""
    text = page.read_text(encoding="utf-8")
    assert tested_platforms.put(text, tested_platforms.table(tested_platforms.read())) == text, "run python3 tests/tested_platforms.py"


def test_every_record_belongs_to_a_row():
    assert set(tested_platforms.read()) <= {each.key for each in PLATFORMS}
    assert len({each.key for each in PLATFORMS}) == len(PLATFORMS)


@pytest.mark.parametrize("platform", PLATFORMS, ids=lambda each: each.key)
def test_the_tests_of_a_row_exist(platform):
    """Checks that the tests that a row names exist, and that its options select them."""
    path, name = platform.tests.split("::")
    text = (REPO / path).read_text(encoding="utf-8")
    assert f"def {name.split('[')[0]}" in text
    words = platform.options.split()
    assert words[-1] in platform.tests
    assert ("--full" in words) == ("mark.full" in text.split(f"def {name.split('[')[0]}")[0].rsplit("\n\n\n", 1)[1])


def report(test: str, outcome: str, when: str = "call", engine: str = "") -> SimpleNamespace:
    return SimpleNamespace(nodeid=test, outcome=outcome, when=when, user_properties=[("engine", engine)] if engine else [])


def test_only_platforms_of_which_all_tests_passed_are_recorded():
    recorder = Recorder()
    for number in range(3):
        recorder.pytest_runtest_logreport(report(f"{LINUX.tests}{number}]@engine", "passed", "setup"))
        recorder.pytest_runtest_logreport(report(f"{LINUX.tests}{number}]@engine", "passed", engine="4.6.3"))
        recorder.pytest_runtest_logreport(report(f"{ARM.tests}{number}", "failed" if number == 1 else "passed"))
    recorder.pytest_runtest_logreport(report(WINDOWS.tests, "skipped", "setup"))
    assert recorder.results("2026-01-02") == {LINUX.key: {"godot": "4.6.3", "tests": 3, "date": "2026-01-02"}}


def test_the_table_has_a_row_for_every_platform():
    text = tested_platforms.table({LINUX.key: {"godot": "4.6.3", "tests": 3, "date": "2026-01-02"}})
    rows = text.splitlines()
    assert len(rows) == 2 + len(PLATFORMS)
    assert rows[2].endswith(f"| played | 4.6.3 | 3 | `{LINUX.options}` | 2026-01-02 |")
    assert all(row.endswith("| not recorded yet |") for row in rows[3:])


def test_the_version_of_an_engine():
    assert tested_platforms.engine_of("\nGodot Engine v4.6.3.stable.debian4.6.3+ds-2 - x\n") == "4.6.3"
    assert tested_platforms.engine_of("Godot Engine v4.6.stable.official.89cea1439 - x") == "4.6"
