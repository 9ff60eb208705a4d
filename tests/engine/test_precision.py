"""Tests that, in an engine with the wrong precision, the library prints an error with a fix and registers no classes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ARCH, REPO, run

import manifest  # From tools/scons, which conftest adds to sys.path.

ADDON = REPO / "demo_project/addons/thicket"
DOUBLE = f"libthicket.linux.template_debug.double.{ARCH}.so"

# A fake engine whose vectors consist of reals with the given number of bytes. Its only other function prints.
ENGINE = """#include "nodes/common/precision.hpp"
#include <cstdio>
#include <cstdlib>
#include <cstring>
static std::size_t real_size;
static void construct(void *r_vector, const GDExtensionConstTypePtr *) { std::memset(r_vector, 0, 3 * real_size); }
static GDExtensionPtrConstructor get_constructor(GDExtensionVariantType p_type, int32_t p_index) {
	return p_type == GDEXTENSION_VARIANT_TYPE_VECTOR3 && p_index == 0 ? construct : nullptr;
}
static void print(const char *p_text, const char *, const char *, int32_t, GDExtensionBool) { std::puts(p_text); }
static GDExtensionInterfaceFunctionPtr find(const char *p_name) {
	const bool prints = std::strcmp(p_name, "print_error") == 0;
	void *function = prints ? reinterpret_cast<void *>(print) : reinterpret_cast<void *>(get_constructor);
	return reinterpret_cast<GDExtensionInterfaceFunctionPtr>(function);
}
int main(int, char **arguments) {
	real_size = std::strtoul(arguments[1], nullptr, 10);
	return thicket::fits_precision(find) ? 0 : 1;
}
"""


@pytest.mark.parametrize("library", ["single", "double"])
def test_the_wrong_precision_is_rejected(library, tmp_path, build_dir):
    """Tests the first check in the library's entry point, with fake engines of both precisions."""
    source, program = tmp_path / "engine.cpp", tmp_path / "engine"
    source.write_text(ENGINE)
    include = [f"-I{folder}" for folder in (REPO / "extension", REPO / "extension/bindings/include", build_dir / "gen/include")]
    define = ["-DREAL_T_IS_DOUBLE"] if library == "double" else []
    checked = REPO / "extension/nodes/common/precision.cpp"
    built = run(["g++", "-std=c++20", "-Wall", "-Werror", *define, *include, source, checked, "-o", program], timeout=300)
    assert built.returncode == 0, built.stderr
    for engine, size in {"single": 4, "double": 8}.items():
        completed = run([program, str(size)], timeout=60)
        if engine == library:
            assert completed.returncode == 0 and not completed.stdout
        else:
            assert completed.returncode == 1 and completed.stdout.count("\n") == 1
            assert f"compiled for engines with {library} precision, and this engine has {engine} precision" in completed.stdout
            assert f"scons precision={engine} extension" in completed.stdout


@pytest.fixture(scope="module")
def double_library(tmp_path_factory) -> Iterator[Path]:
    """Builds the library for double precision, moves it out of the add-on, and returns its path."""
    kept = tmp_path_factory.mktemp("double") / DOUBLE
    try:
        completed = run(["scons", "-Q", "-j2", "precision=double", "scu_build=yes", "extension"], 3600, cwd=REPO)
        assert completed.returncode == 0, completed.stdout + completed.stderr
        assert f'.double = "bin/{DOUBLE}"' in (ADDON / "thicket.gdextension").read_text()
        shutil.move(ADDON / "bin" / DOUBLE, kept)
    finally:
        (ADDON / "bin" / DOUBLE).unlink(missing_ok=True)
        again = run(["scons", "-Q", "-j2", "extension"], 3600, cwd=REPO)
    assert again.returncode == 0, again.stdout + again.stderr
    yield kept


@pytest.mark.full
@pytest.mark.alone  # While the fixture builds, the add-on that all tests load has a different manifest.
@pytest.mark.parametrize("mode", ["game", "editor"])
def test_a_single_engine_rejects_the_double_library(mode, double_library, godot, tmp_path):
    project = tmp_path / "project"
    addon = project / "addons/thicket"
    shutil.copytree(ADDON, addon)
    for library in (addon / "bin").glob("libthicket.*"):
        library.unlink()
    shutil.copy(double_library, addon / "bin")
    text = "\n".join(manifest.write({DOUBLE}, [])).replace("@MINIMUM@", "4.4")
    (addon / "thicket.gdextension").write_text(text)
    (project / "project.godot").write_text('config_version=5\n[application]\nconfig/name="Wrong precision"\n')
    (project / ".godot").mkdir()
    (project / ".godot/extension_list.cfg").write_text("res://addons/thicket/thicket.gdextension\n")
    script = project / "look.gd"
    script.write_text('extends SceneTree\nfunc _init():\n\tprint("there: ", ClassDB.class_exists("ScatterLayer"))\n\tquit()\n')
    how = ["--script", script] if mode == "game" else ["--editor", "--quit-after", "3"]
    completed = godot(["--path", project, *how])
    output = completed.stdout + completed.stderr
    assert completed.returncode == 0, output
    assert "compiled for engines with double precision, and this engine has single precision" in output
    assert "crashed" not in output and "SCRIPT ERROR" not in output
    assert mode == "editor" or "there: false" in output
