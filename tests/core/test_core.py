"""Runs every doctest case of tests/core as a separate pytest test."""

import subprocess

import pytest
from conftest import BUILD_DIR

RUNNER = BUILD_DIR / "core_tests"


def cases() -> list[str]:
    """Returns the names of all test cases in the runner. The list is empty if the runner is not built, which test_runner_is_built reports."""
    if not RUNNER.is_file():
        return []
    listed = subprocess.run([RUNNER, "--list-test-cases"], capture_output=True, text=True, timeout=60, check=True)
    return [line for line in listed.stdout.splitlines() if line and not line.startswith(("[doctest]", "==="))]


def only(case: str) -> str:
    """Returns the doctest option that selects a case. A comma would end the pattern, and a star would match more cases. Both are therefore
    replaced by "?", which matches any character."""
    return "--test-case=" + case.replace(",", "?").replace("*", "?").replace("\\", "?")


def test_runner_is_built():
    assert RUNNER.is_file(), f"{RUNNER} does not exist: run scons tests"
    assert cases(), "the runner has no cases"


@pytest.mark.parametrize("case", cases())
def test_case(core_tool, case):
    result = core_tool("core_tests", only(case), "--no-intro", timeout=900)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "test cases: 0 " not in result.stdout, f"the filter matched no case:\n{result.stdout}"
