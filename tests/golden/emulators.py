"""How programs for other platforms run on this machine."""

from __future__ import annotations

import atexit
import os
import platform as host
import shutil
import tempfile
from functools import cache
from pathlib import Path

# Processors that run the programs of another, as well as their own.
RUNS_TOO = {("x86_64", "i386")}


def command(emulator: str, platform: str, native: str) -> list[str | Path]:
    """What stands before the program; nothing for one that this machine runs itself."""
    if platform == native or (native, platform) in RUNS_TOO:
        return []
    if emulator == "node":
        # The threads on which Node 20 compiles crash it now and then, at the latest when the program has ended.
        return ["node", "--no-warnings", "--single-threaded", Path(__file__).with_name("wasi.mjs")]
    return [find_wine() or "wine"] if emulator == "wine" else [f"qemu-{platform}"]


def absence(emulator: str, platform: str, native: str) -> str:
    """Why programs for that platform cannot run here; nothing if they can."""
    if emulator == "qemu" and host.system() != "Linux":
        return "programs for Linux do not run here"
    if emulator == "wine" and native != "x86_64":
        return "wine runs programs for this machine's processor only"
    words = command(emulator, platform, native)
    return "" if not words or shutil.which(words[0]) else f"{words[0]} is not installed"


def find_wine() -> str | None:
    """Debian's package of the 64-bit one puts no program on the PATH."""
    return next((found for name in ("wine64", "wine", "/usr/lib/wine/wine64") if (found := shutil.which(name))), None)


def environment(emulator: str) -> dict[str, str]:
    return {**os.environ, **(wine_environment() if emulator == "wine" else {})}


@cache
def wine_environment() -> dict[str, str]:
    """With a registry and a C: of its own, which go when this program ends."""
    folder = tempfile.mkdtemp(prefix="thicket-wine-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    # Without the parts that offer to download more.
    return {"WINEPREFIX": folder, "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
