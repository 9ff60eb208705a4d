"""Some test takes every fast path. A fast path produces the result of the code after it, only sooner, so no result shows whether it is
ever taken. A comment that begins with "Fast path:" precedes the statement that runs only then. This test builds the sources a second
time, from a copy in which a statement that reports its first run replaces each of these comments."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from conftest import BUILD_DIR, LONG_CASES, REPO, build, check_engine_tests, run

COPY = REPO / "build/fast_paths"
TOLD = "THICKET_FAST_PATHS"  # The environment variable with the path of the file that lists the fast paths taken.
MARK = re.compile(r"// Fast path: \S.*")
HEADER = f"""#pragma once
#include <cstdio>
#include <cstdlib>
namespace thicket {{
inline bool tell_fast_path(const char *file, int line) {{
	const char *path = std::getenv("{TOLD}");
	std::FILE *told = path != nullptr ? std::fopen(path, "a") : nullptr;
	if (told != nullptr) {{
		std::fprintf(told, "%s:%d\\n", file, line);
		std::fclose(told);
	}}
	return true;
}}
}} // namespace thicket
"""
# A lambda, because some of the functions may run at compile time.
STATEMENT = "[] { static const bool told = ::thicket::tell_fast_path(__FILE__, __LINE__); static_cast<void>(told); }();"


def marks(root: Path, folder: str) -> set[str]:
    """The fast paths in a folder of root, each as the path of its file relative to root and the line of its comment."""
    return {
        f"{path.relative_to(root).as_posix()}:{number}"
        for path in (root / folder).rglob("*.[ch]pp")
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if MARK.search(line)
    }


def telling(text: str, header: Path) -> str:
    """A source that reports which of its fast paths are taken. Its line numbers are unchanged."""
    changed, count = MARK.subn(lambda _: STATEMENT, text)
    return f'#include "{header.as_posix()}"\n#line 1\n{changed}' if count else text


def write(path: Path, data: bytes, mode: int = 0o644):
    """Writes only files that differ, so that equal ones are not rebuilt."""
    if not path.is_file() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        path.chmod(mode)


def copy_of_the_sources():
    listed = run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], timeout=60, cwd=REPO)
    wanted = {name for name in listed.stdout.split("\0") if name and (REPO / name).is_file()}
    assert wanted, listed.stderr
    for path in [path for folder in ("extension", "tests") for path in (COPY / folder).rglob("*.?pp")]:
        if path.relative_to(COPY).as_posix() not in wanted:
            path.unlink()
    header = Path("tests/fast_paths.hpp")
    write(COPY / header, HEADER.encode())
    for name in wanted:
        data = (REPO / name).read_bytes()
        if name.startswith("extension/") and name.endswith((".cpp", ".hpp")):
            up = Path(os.path.relpath(header, Path(name).parent))
            data = telling(data.decode(), up).encode()
        write(COPY / name, data, (REPO / name).stat().st_mode)


def never_taken(wanted: set[str], told: Path) -> list[str]:
    taken = [os.path.normpath(line) for line in told.read_text(encoding="utf-8").splitlines()] if told.exists() else []
    return sorted(wanted - set(taken))


def test_a_fast_path_that_nothing_takes_is_told(tmp_path):
    source = """int main(int count, char **) {
    if (count == 1) {
        // Fast path: always.
        count = 2;
    }
    if (count == 1) {
        // Fast path: never,
        // which takes two lines to say.
        return 1;
    }
    return 0;
}
"""
    (tmp_path / "main.cpp").write_text(source)
    assert marks(tmp_path, ".") == {"main.cpp:3", "main.cpp:7"}
    (tmp_path / "fast_paths.hpp").write_text(HEADER)
    (tmp_path / "telling").mkdir()
    (tmp_path / "telling/main.cpp").write_text(telling(source, Path("../fast_paths.hpp")))
    built = run([os.environ.get("CXX", "g++"), "-std=c++20", "main.cpp", "-o", tmp_path / "main"], timeout=60, cwd=tmp_path / "telling")
    assert built.returncode == 0, built.stderr
    told = tmp_path / "told"
    assert run([tmp_path / "main"], timeout=60, env={TOLD: str(told)}).returncode == 0
    assert never_taken({"main.cpp:3", "main.cpp:7"}, told) == ["main.cpp:7"]


def test_the_core_takes_its_fast_paths(tmp_path):
    """Runs the cases of tests/core that do not take long."""
    wanted = marks(REPO, "extension/core")
    assert len(wanted) > 50
    copy_of_the_sources()
    runner = Path("build", BUILD_DIR.name + ".scu", "core_tests")
    build("scu_build=yes", "compiledb=no", runner, timeout=1800, cwd=COPY)
    told = tmp_path / "told"
    done = run([COPY / runner, "--no-intro", "--test-case-exclude=" + ",".join(LONG_CASES)],
        timeout=900, env={**os.environ, TOLD: str(told)})  # fmt: skip
    assert done.returncode == 0, (done.stdout + done.stderr)[-8000:]
    assert not never_taken(wanted, told)


@pytest.mark.full
def test_the_nodes_take_their_fast_paths(tmp_path):
    """Runs the scripts of tests/engine."""
    wanted = marks(REPO, "extension/nodes")
    assert len(wanted) > 50
    copy_of_the_sources()
    build("scu_build=yes", "compiledb=no", "extension", timeout=3600, cwd=COPY)
    told = tmp_path / "told"
    check_engine_tests(COPY / "demo_project/addons/thicket", **{TOLD: str(told)})
    assert not never_taken(wanted, told)
