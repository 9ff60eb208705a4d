"""Tests that the C++ sources are formatted according to .clang-format, and that clang-tidy reports no problems."""

from __future__ import annotations

import re
import sys
from collections import defaultdict

import pytest
from conftest import REPO, run

sys.path.insert(0, str(REPO / "tools"))
import lint  # noqa: E402 (only on the path above)


def test_sources_are_formatted():
    output = lint.format_sources(check=True)
    assert not output, f"{output[:4000]}\nto fix it, run: {sys.executable} tools/lint.py format"


def test_type_names_are_unique():
    """Checks that no two headers define a type with the same name. All types are in one namespace, so the linker would
    merge functions of such types, for example their destructors."""
    headers = defaultdict(set)
    for header in sorted((REPO / "extension").glob("**/*.hpp")):
        if "bindings" in header.parts:
            continue  # The bindings have a different namespace.
        for name in re.findall(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;]*?)? \{", header.read_text(), re.MULTILINE):
            headers[name].add(header.relative_to(REPO).as_posix())
    assert len(headers) > 200
    assert not {name: where for name, where in headers.items() if len(where) > 1}


@pytest.fixture(scope="module")
def database():
    # The long timeout includes waiting for builds that other tests run in this tree.
    completed = run(["scons", "-Q", "compiledb"], timeout=1800, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr


def test_clang_tidy_finds_nothing_in_the_extension(database):
    """Checks with clang-tidy. Only files that have changed since they were last clean are checked. The first run takes
    several minutes."""
    output = lint.tidy(everything=False)
    assert not output, output[:8000]


@pytest.mark.full
def test_clang_tidy_finds_nothing_anywhere(database):
    output = lint.tidy(everything=True)
    assert not output, output[:8000]
