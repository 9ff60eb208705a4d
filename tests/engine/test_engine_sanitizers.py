"""Runs the extension in the real engine, once with ThreadSanitizer and once with AddressSanitizer and UndefinedBehaviorSanitizer. The
engine itself is not instrumented, so its memory accesses are not checked."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest
from conftest import ADDON, BUILD_DIR, REPO, build, new_project, run
from test_engine import ENGINE, PASSED

pytestmark = pytest.mark.full

# For each sanitizer: the libraries to preload, the environment variable for its options, and the options.
SANITIZERS = {
    # Engine code is not instrumented, so reports about its calls to the C library are meaningless.
    "thread": (["libtsan.so"], "TSAN_OPTIONS", "ignore_noninstrumented_modules=1:report_signal_unsafe=0:history_size=4:exitcode=66"
               f":suppressions={REPO / 'tests/sanitizers/thread.supp'}"),
    # Leaks are not detected: the engine keeps memory until it exits, and frees some of it with its own functions.
    "address,undefined": (["libasan.so", "libubsan.so"], "ASAN_OPTIONS", "verify_asan_link_order=0:detect_leaks=0:exitcode=66"),
}  # fmt: skip

# Scripts that make calls from many threads, load on threads, or free objects during calls.
SCRIPTS = ["test_threads", "test_snapshots", "background_load", "test_state_async", "test_terrain_calls", "test_lifetime",
           "test_domain_calls"]  # fmt: skip


def runtime(folder: Path, names: list[str]) -> str:
    """Copies the libraries to preload into a folder that is also readable inside Godot's root directory and returns their
    paths. The shim comes first, because a sanitizer's dlopen rejects the flag that the shim removes."""
    shim = folder / "no_deepbind.so"
    completed = run(["gcc", "-shared", "-fPIC", "-O1", "-o", shim, REPO / "tests/sanitizers/no_deepbind.c"], timeout=60)
    assert completed.returncode == 0, completed.stderr
    preloaded = [shim]
    for name in names:
        found = run(["gcc", f"-print-file-name={name}"], timeout=60).stdout.strip()
        preloaded.append(Path(shutil.copy(os.path.realpath(found), folder / name)))
    return ":".join(map(str, preloaded))


@pytest.fixture(scope="module", params=SANITIZERS)
def sanitized(request, tmp_path_factory):
    """Returns a function that runs Godot in a project whose extension was built with a sanitizer."""
    libraries, variable, options = SANITIZERS[request.param]
    name = request.param.replace(",", ".")
    build(f"sanitize={request.param}", "scu_build=yes", "compiledb=no", "extension", timeout=3600)
    built = BUILD_DIR.with_name(f"{BUILD_DIR.name}.{name}.scu") / "addon"
    project = new_project(tmp_path_factory.mktemp(name))
    addon = project / "addons/thicket"
    addon.unlink()
    shutil.copytree(ADDON, addon, ignore=shutil.ignore_patterns("bin", "thicket.gdextension"))
    shutil.copytree(built / "bin", addon / "bin")
    shutil.copy(built / "thicket.gdextension", addon)
    preloaded = runtime(tmp_path_factory.mktemp("runtime"), libraries)

    def call(script: str, timeout: float):
        command = [REPO / "tools/godot", "--preload", preloaded, "--headless", "--path", project, "--script", ENGINE / f"{script}.gd"]
        return run(command, timeout, env={**os.environ, variable: options, "UBSAN_OPTIONS": "print_stacktrace=1"})

    return call


@pytest.mark.parametrize("script", SCRIPTS)
def test_no_report(sanitized, script):
    completed = sanitized(script, timeout=3600)
    printed = completed.stdout + completed.stderr
    assert not re.search(r"WARNING: ThreadSanitizer|ERROR: AddressSanitizer|runtime error:", printed), printed[-12000:]
    assert completed.returncode == 0 and PASSED.search(completed.stdout), printed[-12000:]
