"""Formats and checks the C++ sources with the versions of clang-format and clang-tidy in tests/requirements.txt.

    ~/.cache/thicket/venv/bin/python tools/lint.py format     formats all sources in place (see .clang-format)
    ~/.cache/thicket/venv/bin/python tools/lint.py tidy       checks the files in extension/ that changed since the last clean check
    ~/.cache/thicket/venv/bin/python tools/lint.py tidy --all also checks tests/

The cache folder records which files are clean, for all checkouts. The key is a hash of the compile command, the source,
all our headers that it includes, and .clang-tidy. Needs compile_commands.json, which any build writes."""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

REPO = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(REPO / "tools/scons"))
import installed  # noqa: E402 (only on the path above)

INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)
CLEAN = Path(installed.cache_folder()) / "tidy"
# Flags of g++ that clang does not support.
UNKNOWN = {"-fno-gnu-unique"}


def tool(name: str) -> str:
    """Returns the path of a program that the pinned package has installed next to this Python."""
    return str(Path(sys.executable).parent / name)


def sources(*suffixes: str) -> list[Path]:
    paths = [path for folder in ("extension", "tests", "python") for path in (REPO / folder).rglob("*") if path.suffix in suffixes]
    return sorted(path for path in paths if "node_modules" not in path.parts)


def format_sources(check: bool) -> str:
    """Formats the sources. With `check`, leaves them unchanged and returns the lines that formatting would change. Returns ""
    if there is nothing to report."""
    command = [tool("clang-format"), *(["--dry-run", "--Werror"] if check else ["-i"])]
    process = subprocess.run([*command, *sources(".c", ".cpp", ".h", ".hpp")], capture_output=True, text=True, cwd=REPO, check=False)
    return process.stderr


@cache
def text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def with_headers(path: Path, seen: set[Path]) -> set[Path]:
    """Returns a source and all files of this repository that it includes, directly or indirectly."""
    seen.add(path)
    for name in INCLUDE.findall(text(path)):
        for folder in (path.parent, REPO / "extension", REPO / "extension/bindings/include", REPO):
            other = Path(os.path.normpath(folder / name))
            if other not in seen and other.is_file():
                with_headers(other, seen)
                break
    return seen


def fingerprint(path: Path, command: str) -> str:
    """Returns a hash of everything that may change clang-tidy's result for a source that is compiled by this
    command."""
    digest = hashlib.sha256((text(REPO / ".clang-tidy") + text(REPO / "tests/requirements.txt") + command).encode())
    for file in sorted(with_headers(path, set())):
        digest.update(file.relative_to(REPO).as_posix().encode() + b"\0" + text(file).encode())
    return digest.hexdigest()[:32]


def tidy(everything: bool) -> str:
    """Runs clang-tidy. Returns its warnings, or "" if all sources are clean."""
    CLEAN.mkdir(parents=True, exist_ok=True)
    database_folder = REPO / "build/tidy"
    database_folder.mkdir(parents=True, exist_ok=True)
    database = json.loads((REPO / "compile_commands.json").read_text(encoding="utf-8"))
    for entry in database:
        entry["command"] = " ".join(word for word in entry["command"].split() if word not in UNKNOWN)
    (database_folder / "compile_commands.json").write_text(json.dumps(database), encoding="utf-8")
    folders = ("extension/", "tests/") if everything else ("extension/",)
    commands = {REPO / entry["file"]: entry["command"] for entry in database if entry["file"].startswith(folders)}
    stamps = {path: CLEAN / fingerprint(path, command) for path, command in commands.items()}
    unchecked = [path for path, stamp in stamps.items() if not stamp.is_file()]

    def check(path: Path) -> str:
        # -w disables clang's compiler warnings, because g++ is the reference for compiler warnings.
        command = [tool("clang-tidy"), "--quiet", f"-p={database_folder}", "--extra-arg=-w", "--header-filter=/(extension|tests)/", path]
        process = subprocess.run(command, capture_output=True, text=True, cwd=REPO, check=False)
        if process.returncode == 0:
            stamps[path].touch()
            return ""
        return process.stdout or process.stderr

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return "".join(pool.map(check, unchecked))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["format", "tidy"])
    parser.add_argument("--all", action="store_true", help="tidy: also check the tests")
    arguments = parser.parse_args()
    report = format_sources(check=False) if arguments.what == "format" else tidy(arguments.all)
    print(report, end="")
    return int(bool(report))


if __name__ == "__main__":
    sys.exit(main())
