"""The C++ sources are formatted as .clang-format says, and clang-tidy has nothing against them."""

from __future__ import annotations

import re
import sys
from collections import defaultdict

import pytest
from conftest import REPO, run

sys.path.insert(0, str(REPO / "tools"))
import lint  # noqa: E402 (only on the path above)


def test_sources_are_formatted():
    said = lint.format_sources(check=True)
    assert not said, f"{said[:4000]}\nto mend it: {sys.executable} tools/lint.py format"


def test_no_two_headers_give_one_name_to_two_types():
    """All of them are of one namespace: the linker takes a function of one such type, its destructor say, for that of the other."""
    headers = defaultdict(set)
    for header in sorted((REPO / "extension").glob("**/*.hpp")):
        if "bindings" in header.parts:
            continue  # They have a namespace of their own.
        for name in re.findall(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;]*?)? \{", header.read_text(), re.MULTILINE):
            headers[name].add(header.relative_to(REPO).as_posix())
    assert len(headers) > 200
    assert not {name: where for name, where in headers.items() if len(where) > 1}


@pytest.fixture(scope="module")
def database():
    done = run(["scons", "-Q", "compiledb"], timeout=300, cwd=REPO)
    assert done.returncode == 0, done.stdout + done.stderr


def test_clang_tidy_finds_nothing_in_the_extension(database):
    """Only what changed since it was last found clean; the first time that takes some minutes."""
    said = lint.tidy(everything=False)
    assert not said, said[:8000]


@pytest.mark.full
def test_clang_tidy_finds_nothing_anywhere(database):
    said = lint.tidy(everything=True)
    assert not said, said[:8000]


def test_clang_tidy_notices_a_fault(tmp_path):
    """Its configuration is read, and finds are errors."""
    source = tmp_path / "fault.cpp"
    source.write_text("#include <string>\n#include <utility>\nstd::size_t f(std::string a) {\n\tstd::string b = std::move(a);\n\treturn a.size() + b.size();\n}\n")
    done = run([lint.tool("clang-tidy"), "--quiet", f"--config-file={REPO / '.clang-tidy'}", source, "--", "-std=c++20"], timeout=120)
    assert done.returncode != 0 and "bugprone-use-after-move" in done.stdout, done.stdout + done.stderr


def test_a_header_counts_for_what_includes_it():
    source = REPO / "extension/core/rules/rules.cpp"
    files = lint.with_headers(source, set())
    assert REPO / "extension/core/rules/rules.hpp" in files and len(files) > 5
    assert lint.fingerprint(source, "g++") == lint.fingerprint(source, "g++") != lint.fingerprint(source, "g++ -DX")
