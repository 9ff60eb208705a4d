"""Runs programs for other platforms on this machine."""

from __future__ import annotations

import atexit
import os
import platform as host
import shutil
import tempfile
from functools import cache
from pathlib import Path

# Pairs of a processor and another processor whose programs it also runs.
RUNS_TOO = {("x86_64", "i386")}


def command(emulator: str, platform: str, native: str) -> list[str | Path]:
    """Returns the command that runs a program for the platform. Empty if this machine runs the program directly."""
    if platform == native or (native, platform) in RUNS_TOO:
        return []
    if emulator == "node":
        # In Node 20, the threads that compile WebAssembly crash it occasionally, even after the program has ended.
        return ["node", "--no-warnings", "--single-threaded", Path(__file__).with_name("wasi.mjs")]
    return [find_wine() or "wine"] if emulator == "wine" else [f"qemu-{platform}"]


def absence(emulator: str, platform: str, native: str) -> str:
    """Returns the reason why programs for the platform cannot run here. Empty if they can."""
    if emulator == "qemu" and host.system() != "Linux":
        return "programs for Linux do not run here"
    if emulator == "wine" and native != "x86_64":
        return "wine runs programs for this machine's processor only"
    words = command(emulator, platform, native)
    return "" if not words or shutil.which(words[0]) else f"{words[0]} is not installed"


def find_wine() -> str | None:
    """Returns the path of wine, if it is installed. Debian's package of 64-bit wine puts no program on the PATH."""
    return next((found for name in ("wine64", "wine", "/usr/lib/wine/wine64") if (found := shutil.which(name))), None)


def environment(emulator: str) -> dict[str, str]:
    return {**os.environ, **(wine_environment() if emulator == "wine" else {})}


@cache
def wine_environment() -> dict[str, str]:
    """Returns environment variables for wine, with a registry and a C: drive that are deleted when this program
    exits."""
    folder = tempfile.mkdtemp(prefix="thicket-wine-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    # The overrides disable the components of wine that would offer further downloads.
    return {"WINEPREFIX": folder, "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
