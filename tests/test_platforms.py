"""The core's tests once more on other platforms, as they are built for those: for 64-bit ARM in an emulator of its processor, for
Windows in wine. Half an hour each; what they say besides the digests of test_golden.py is that nothing else fails there."""

from __future__ import annotations

import platform

import pytest
from conftest import REPO, build, run
from golden import emulators
from golden.matrix import NATIVE, ZIG

# Each platform's options, program, emulator, and what this has to be told besides.
PLATFORMS = {
    "aarch64": (["platform=linux", "arch=arm64"], "linux.template_debug.arm64.zig/core_tests", "qemu", ["-L", "/usr/aarch64-linux-gnu"]),
    "Windows": (["platform=windows", "arch=x86_64"], "windows.template_debug.x86_64.zig/core_tests.exe", "wine", []),
}


@pytest.mark.full
@pytest.mark.parametrize("name", PLATFORMS)
def test_no_case_fails_on_another_platform(name):
    options, program, emulator, more = PLATFORMS[name]
    why = emulators.absence(emulator, name, NATIVE)
    if name == NATIVE or platform.system() != "Linux":
        pytest.skip("this is no other platform, or not one that has emulators")
    if why or not ZIG.is_file():
        pytest.skip(why or "zig is not installed")
    # A clang as new as zig's warns of what doctest's macros do.
    build("use_zig=yes", "werror=no", *options, f"build/{program}", timeout=3600)
    command = [*emulators.command(emulator, name, NATIVE), *more, REPO / "build" / program, "--no-intro"]
    done = run(command, timeout=3 * 3600, cwd=REPO, env=emulators.environment(emulator))
    assert done.returncode == 0, (done.stdout + done.stderr)[-8000:]
    assert " 0 failed" in done.stdout
