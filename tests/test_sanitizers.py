"""The core's tests once more, with every memory access and every undefined operation checked."""

from __future__ import annotations

import os

from conftest import BUILD_DIR, REPO, run

CHECKED = BUILD_DIR.with_name(BUILD_DIR.name + ".address.undefined")

# Cases that do the same as others on many more points: minutes of checked code for nothing new.
LONG = ["*million*", "oracle: the sampler*", "lattice: every level*", "domain: ten thousand*", "domain: as wide*"]


def test_no_case_trips_a_sanitizer():
    runner = CHECKED / "core_tests"
    built = run(
        ["scons", "-Q", "-j2", "sanitize=address,undefined", runner.relative_to(REPO)], timeout=1800, cwd=REPO
    )
    assert built.returncode == 0, built.stdout + built.stderr
    environment = {**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1", "ASAN_OPTIONS": "detect_leaks=1"}
    done = run([runner, "--no-intro", "--test-case-exclude=" + ",".join(LONG)], timeout=900, env=environment)
    assert done.returncode == 0, (done.stdout + done.stderr)[-8000:]
    assert "0 failed" in done.stdout
