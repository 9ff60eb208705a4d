"""Describes the machine and the commit on which the page's numbers were measured."""

from __future__ import annotations

import datetime
import json
import os
import platform
import re
import subprocess
from pathlib import Path

from bench.figures.tables import Row


def _output(*command: str | Path) -> str:
    """Returns the output of a command, or an empty string if the command does not exist or fails."""
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    except OSError:
        return ""
    return result.stdout.strip() if result.returncode == 0 else ""


def _first(pattern: str, path: str) -> str:
    try:
        text = Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    match = re.search(pattern, text, re.MULTILINE)
    return match.group(1).strip() if match else ""


def compile_flags(repo: Path, programs: Path) -> str:
    """Returns the compiler flags of domain_run.cpp in the folder of the programs, without folders, file names and
    warnings."""
    try:
        database = json.loads((repo / "compile_commands.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return "unknown"
    built = f"{programs.name}/obj/tests/bench/domain_run.o"
    command = next((entry["command"] for entry in database if entry["output"].endswith(built)), "")
    flags = re.findall(r"(?:^|\s)(-(?!I|o\b|c\b)\S+)", command)
    return " ".join(flag for flag in flags if not flag.startswith("-W")) or "unknown"


def describe(repo: Path, programs: Path, quick: bool) -> Row:
    """Returns a description of machine, compiler, commit and date."""
    # Files that the command itself writes are ignored, because they do not affect the measurement.
    written = [":!tests/bench/data"]
    changed_files = _output("git", "-C", repo, "status", "--porcelain", "--untracked-files=no", "--", ".", *written)
    commit = _output("git", "-C", repo, "rev-parse", "--short=12", "HEAD") or "unknown"
    memory = _first(r"^MemTotal:\s+(\d+) kB", "/proc/meminfo")
    return {
        "processor": _first(r"^model name\s*: (.*)$", "/proc/cpuinfo") or platform.machine(),
        "cores": os.cpu_count() or 0,
        "memory_gib": int(memory or 0) / 2**20,
        "system": f"{platform.system()} {platform.release()}",
        "compiler": _output(os.environ.get("CXX", "g++"), "--version").partition("\n")[0],
        "flags": compile_flags(repo, programs),
        "commit": commit + (" with changes" if changed_files else ""),
        "date": datetime.date.today().isoformat(),
        "quick": quick,
    }
