"""Runs the core's tests under the address and undefined-behavior sanitizers. Builds and runs take longer than all other tests of a
run without --full, which has the fuzzers under the same sanitizers (test_fuzz.py)."""

from __future__ import annotations

import os

import pytest
from conftest import BUILD_DIR, LONG_CASES, REPO, build, run

pytestmark = pytest.mark.full

CHECKED = BUILD_DIR.with_name(BUILD_DIR.name + ".address.undefined.scu")


def check(selection: str, timeout: float):
    runner = CHECKED / "core_tests"
    build("sanitize=address,undefined", "scu_build=yes", runner.relative_to(REPO), timeout=1800)
    environment = {**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1", "ASAN_OPTIONS": "detect_leaks=1"}
    result = run([runner, "--no-intro", f"--{selection}={LONG_CASES}"], timeout=timeout, env=environment)
    assert result.returncode == 0, (result.stdout + result.stderr)[-8000:]
    assert "0 failed" in result.stdout


def test_no_case_triggers_a_sanitizer():
    check("test-case-exclude", timeout=900)


def test_no_long_case_triggers_a_sanitizer():
    check("test-case", timeout=7200)
