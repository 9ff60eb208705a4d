"""Runs programs for other platforms on this machine."""

from __future__ import annotations

import atexit
import os
import platform as host
import shutil
import tempfile
from functools import cache
from pathlib import Path

# Processors that also run the programs of a second one.
RUNS_TOO = {("x86_64", "i386")}


def command(emulator: str, platform: str, native: str) -> list[str | Path]:
    """The command in front of the program. Empty if this machine runs it directly."""
    if platform == native or (native, platform) in RUNS_TOO:
        return []
    if emulator == "node":
        # Threads that compile in Node 20 crash it occasionally, at the latest when the program has ended.
        return ["node", "--no-warnings", "--single-threaded", Path(__file__).with_name("wasi.mjs")]
    return [find_wine() or "wine"] if emulator == "wine" else [f"qemu-{platform}"]


def absence(emulator: str, platform: str, native: str) -> str:
    """Why programs for that platform cannot run here. Empty if they can."""
    if emulator == "qemu" and host.system() != "Linux":
        return "programs for Linux do not run here"
    if emulator == "wine" and native != "x86_64":
        return "wine runs programs for this machine's processor only"
    words = command(emulator, platform, native)
    return "" if not words or shutil.which(words[0]) else f"{words[0]} is not installed"


def find_wine() -> str | None:
    """Debian's package of 64-bit wine puts no program on the PATH."""
    return next((found for name in ("wine64", "wine", "/usr/lib/wine/wine64") if (found := shutil.which(name))), None)


def environment(emulator: str) -> dict[str, str]:
    return {**os.environ, **(wine_environment() if emulator == "wine" else {})}


@cache
def wine_environment() -> dict[str, str]:
    """An environment with a registry and a C: drive that are deleted when this program ends."""
    folder = tempfile.mkdtemp(prefix="thicket-wine-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    # Without the components that offer further downloads.
    return {"WINEPREFIX": folder, "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
