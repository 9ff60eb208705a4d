"""Builds wheels that run on any Linux since 2014, for build.sh --manylinux: zig compiles for x86-64 and for 64-bit ARM, with glibc 2.17. auditwheel
checks that they need nothing newer, and writes this into their names."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

REPO = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPO / "tools/scons"))
import installed  # noqa: E402 (only on the path above)
from platforms import ZIG_TARGETS  # noqa: E402

# Python's names of the processors, by ours.
PROCESSORS = {"x86_64": "x86_64", "arm64": "aarch64"}


def command(path: Path, command_line: str) -> Path:
    """Writes a program that runs another one with more arguments, because CMake expects compilers without arguments."""
    path.write_text(f'#!/bin/sh\nexec {command_line} "$@"\n')
    path.chmod(0o755)
    return path


def build(arch: str, stub: Path, folder: Path) -> Path:
    """Returns the path of the wheel for a processor."""
    zig, processor = installed.zig_program(), PROCESSORS[arch]
    tools = folder / "tools"
    tools.mkdir(parents=True)
    flags = f"-target {ZIG_TARGETS['linux', arch]} -fno-sanitize=undefined -ffile-prefix-map={REPO}=."
    settings = {
        "CMAKE_CXX_COMPILER": command(tools / "c++", f"{zig} c++ {flags}"),
        "CMAKE_AR": command(tools / "ar", f"{zig} ar"),
        "CMAKE_RANLIB": command(tools / "ranlib", f"{zig} ranlib"),
        "CMAKE_SYSTEM_NAME": "Linux",
        "CMAKE_SYSTEM_PROCESSOR": processor,
        "THICKET_HIGHWAY": Path(installed.cache_folder()) / f"highway-{installed.version('highway')}",
        "POISSONTILES_STUB": stub,
    }
    environment = {**os.environ, **installed.zig_environment(zig), "_PYTHON_HOST_PLATFORM": f"linux-{processor}"}
    environment["PATH"] = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    subprocess.run(
        [
            sys.executable, "-m", "pip", "wheel", REPO / "python", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-build-isolation",
            "--wheel-dir", folder, f"--config-settings=build-dir={folder / 'build'}",
            *(f"--config-settings=cmake.define.{name}={value}" for name, value in settings.items()),
        ],
        check=True, env=environment,
    )  # fmt: skip
    (wheel,) = folder.glob("*.whl")
    # For another processor, auditwheel accepts no name of a platform, so it determines the oldest one itself.
    subprocess.run([sys.executable, "-m", "auditwheel", "repair", "--plat", "auto", "--wheel-dir", folder / "checked", wheel], check=True, env=environment)
    (repaired,) = (folder / "checked").glob("*.whl")
    glibc = ZIG_TARGETS["linux", arch].rpartition("gnu.")[2].replace(".", "_")
    if f"manylinux_{glibc}_{processor}" not in repaired.name:
        sys.exit(f"{repaired.name} must be a wheel for glibc {glibc}: run auditwheel show to see which symbols are newer")
    return repaired


def main(native: Path, out: Path) -> None:
    """Writes the wheels into a folder and prints their paths. The type stubs come from the wheel `native` of this machine, because a module for
    another processor cannot print them."""
    with tempfile.TemporaryDirectory(dir=out, prefix="partial.") as temporary:
        stub = Path(temporary, "_core.pyi")
        with zipfile.ZipFile(native) as files:
            stub.write_bytes(files.read("poissontiles/_core.pyi"))
        for arch in PROCESSORS:
            wheel = build(arch, stub, Path(temporary, arch))
            print(wheel.replace(out / wheel.name))


if __name__ == "__main__":
    if sys.version_info < (3, 12):
        sys.exit("manylinux wheels need Python 3.12 or newer, whose modules work in all later versions: set PYTHON, for example PYTHON=python3.12")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
