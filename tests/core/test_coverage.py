"""Tests that every line of the extension is executed by at least one test, except the lines in uncovered_core.txt and
uncovered_nodes.txt. A line that only makes the code faster does not affect results, so only this test shows whether it is ever
reached. A build with coverage=yes counts the executions."""

from __future__ import annotations

import os
import re
import shutil
from collections import Counter
from pathlib import Path

import pytest
from conftest import BUILD_DIR, LONG_CASES, REPO, build, check_engine_tests, run

OPTIONS = ("coverage=yes", "CXX=clang++", "scu_build=yes", "werror=no", "compiledb=no")
FOLDER = Path("build", BUILD_DIR.name + ".clang++.coverage.scu")
# Lines with only brackets or one of these keywords are executed together with adjacent lines.
NO_WORDS = re.compile(r"[^A-Za-z]*(else|default:|do|try)?[^A-Za-z]*")

# Only the set-up for --full installs the libraries that clang needs for coverage.
pytestmark = [pytest.mark.full, pytest.mark.skipif(shutil.which("clang++") is None, reason="no clang++")]


def llvm(name: str) -> str:
    """Returns the path of the LLVM tool that belongs to the compiler's version."""
    return run(["clang++", f"-print-prog-name={name}"], timeout=60).stdout.strip()


def never_run(program: Path, profiles: Path, folder: str) -> dict[str, Counter[str]]:
    """Returns the lines of the sources in `folder` that no process executed: for each file, the content of the lines and the
    number of times that each line occurs."""
    merged_profile = profiles / "merged.profdata"
    result = run([llvm("llvm-profdata"), "merge", "--sparse", "-o", merged_profile, *profiles.glob("*.profraw")], timeout=600)
    assert result.returncode == 0, result.stderr
    result = run([llvm("llvm-cov"), "export", "--format=lcov", "--skip-functions", f"--instr-profile={merged_profile}", program], timeout=1200, cwd=REPO)
    assert result.returncode == 0, result.stderr[-4000:]
    found: dict[str, Counter[str]] = {}
    path, source = "", []
    for row in result.stdout.splitlines():
        kind, _, value = row.partition(":")
        if kind == "SF":
            path = os.path.relpath(REPO / value, REPO)
            source = (REPO / path).read_text(encoding="utf-8").splitlines() if path.startswith(folder + "/") else []
        elif kind == "DA" and source:
            line, count = map(int, value.split(",")[:2])
            # The end of a function may be reported one line after the end of the file. Comments are ignored, because
            # they may be reworded.
            text = source[line - 1].split("//")[0].strip() if line <= len(source) else ""
            if count == 0 and not text.startswith("#") and not NO_WORDS.fullmatch(text):
                found.setdefault(path, Counter())[text] += 1
    return found


def listed_lines(text: str) -> dict[str, Counter[str]]:
    """Parses a list that `listing` has written: the path of each file, followed by its indented lines."""
    found: dict[str, Counter[str]] = {}
    for row in text.splitlines():
        if not row.startswith(("#", "\t")):
            path = row
        elif row.startswith("\t"):
            found.setdefault(path, Counter())[row.strip()] += 1
    return found


def listing(lines: dict[str, Counter[str]]) -> str:
    return "".join(f"{path}\n" + "".join(f"\t{text}\n" for text in sorted(lines[path].elements())) for path in sorted(lines) if lines[path])


def check_covered(program: Path, profiles: Path, folder: str, name: str):
    """Fails if a line that is missing from the list `name` was not executed. Writes an updated list into the build folder."""
    file = REPO / "tests/core" / name
    listed = file.read_text(encoding="utf-8")
    found, expected = never_run(program, profiles, folder), listed_lines(listed)
    header = "".join(row for row in listed.splitlines(keepends=True) if row.startswith("#"))
    new_list = REPO / FOLDER / name
    new_list.write_text(header + listing(found), encoding="utf-8")
    remedy = f"Add a test, or if none can run them: cp {FOLDER / name} {file.relative_to(REPO)}"
    new = {path: found[path] - expected.get(path, Counter()) for path in found}
    assert not any(new.values()), f"no test runs\n{listing(new)}{remedy}"


def environment(profiles: Path) -> dict[str, str]:
    """Returns environment variables with which processes add their counts to shared files. File names with process IDs would collide, because
    processes in different containers may have the same ID."""
    return {"LLVM_PROFILE_FILE": str(profiles / "%4m.profraw")}


def test_lines_that_nothing_runs_are_found(tmp_path):
    source = """int main(int count, char **) {
	if (count == 1) {
		++count;
	}
	if (count == 1) {
		return 1;
	}
	return 0;
}
"""
    (tmp_path / "main.cpp").write_text(source)
    flags = ["-fprofile-instr-generate", "-fcoverage-mapping"]
    assert run(["clang++", *flags, tmp_path / "main.cpp", "-o", tmp_path / "main"], timeout=60).returncode == 0
    assert run([tmp_path / "main"], timeout=60, env=environment(tmp_path)).returncode == 0
    folder = os.path.relpath(tmp_path, REPO)
    assert never_run(tmp_path / "main", tmp_path, folder) == {f"{folder}/main.cpp": Counter(["return 1;"])}


def test_cases_run_every_line_of_the_core(tmp_path):
    """Checks the lines that the test cases of tests/core execute, except the slow ones."""
    build(*OPTIONS, FOLDER / "core_tests", timeout=3600)
    result = run([REPO / FOLDER / "core_tests", "--no-intro", f"--test-case-exclude={LONG_CASES}"],
        timeout=900, env={**os.environ, **environment(tmp_path)})  # fmt: skip
    assert result.returncode == 0, (result.stdout + result.stderr)[-8000:]
    check_covered(REPO / FOLDER / "core_tests", tmp_path, "extension/core", "uncovered_core.txt")


def test_scripts_run_every_line_of_the_nodes(tmp_path):
    """Checks the lines that the scripts of tests/engine execute. Two scripts are omitted because they depend on speed
    or free memory, which counting affects."""
    build(*OPTIONS, "extension", timeout=3600)
    addon, profiles = tmp_path / "addon", tmp_path / "profiles"
    shutil.copytree(REPO / "demo_project/addons/thicket", addon, ignore=shutil.ignore_patterns("bin"))
    shutil.copytree(REPO / FOLDER / "addon", addon, dirs_exist_ok=True)
    check_engine_tests(addon, "-k", "not lack_of_memory and not test_domain_cancel", **environment(profiles))
    library = next((addon / "bin").glob("*.so"))
    check_covered(library, profiles, "extension/nodes", "uncovered_nodes.txt")
