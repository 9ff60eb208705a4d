"""Runs the core's tests on other platforms, except for the slow ones: for 64-bit ARM in an emulator, and for Windows in
wine. test_golden.py compares digests on these platforms; these tests verify that nothing else fails there."""

from __future__ import annotations

import platform

import pytest
from conftest import LONG_CASES, REPO, build, run
from golden import emulators
from golden.matrix import NATIVE, ZIG

# For each platform: the build options, the program, the emulator, and the emulator's arguments.
PLATFORMS = {
    "aarch64": (["platform=linux", "arch=arm64"], "linux.template_debug.arm64.zig.scu/core_tests", "qemu", ["-L", "/usr/aarch64-linux-gnu"]),
    "Windows": (["platform=windows", "arch=x86_64"], "windows.template_debug.x86_64.zig.scu/core_tests.exe", "wine", []),
}


@pytest.mark.full
@pytest.mark.parametrize("name", PLATFORMS)
def test_no_case_fails_on_other_platforms(name):
    options, program, emulator, more = PLATFORMS[name]
    why = emulators.absence(emulator, name, NATIVE)
    if name == NATIVE or platform.system() != "Linux":
        pytest.skip("this is the platform of this machine, or there are no emulators here")
    if why or not ZIG.is_file():
        pytest.skip(why or "zig is not installed")
    # The compiler is newer than ours and warns about doctest's macros, so warnings are not errors.
    build("use_zig=yes", "scu_build=yes", "werror=no", *options, f"build/{program}", timeout=3600)
    command = [*emulators.command(emulator, name, NATIVE), *more, REPO / "build" / program, "--no-intro", f"--test-case-exclude={LONG_CASES}"]
    completed = run(command, timeout=3 * 3600, cwd=REPO, env=emulators.environment(emulator))
    assert completed.returncode == 0, (completed.stdout + completed.stderr)[-8000:]
    assert " 0 failed" in completed.stdout
