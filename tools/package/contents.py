"""The contents of the zips, apart from the libraries."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
ADDON = REPO / "demo_project/addons/thicket"
sys.path.insert(0, str(REPO / "tools/scons"))

import installed  # noqa: E402 (only on the path above)
import manifest  # noqa: E402


def version():
    """The version of the add-on. plugin.cfg, where the engine reads it, is its only source."""
    return re.search(r'^version="([^"]+)"$', (ADDON / "plugin.cfg").read_text(encoding="utf-8"), re.MULTILINE).group(1)


def tracked(folder):
    """The files below a folder of the repository that git tracks."""
    listed = subprocess.run(["git", "ls-files", "-z", "--", str(folder)], cwd=REPO, check=True, capture_output=True, text=True)
    return [REPO / name for name in listed.stdout.split("\0") if name and (REPO / name).is_file()]


def copy(paths, root, target):
    for path in paths:
        place = target / path.relative_to(root)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, place)


def addon(folder, built):
    """Assembles the add-on around the libraries in its bin/. `built` is the add-on's folder in one of the builds, which contains
    generated files."""
    copy(tracked(ADDON), ADDON, folder)
    shutil.copytree(built / "csharp", folder / "csharp", dirs_exist_ok=True)
    minimum = re.search(r'^compatibility_minimum = "([^"]+)"$', (built / "thicket.gdextension").read_text(encoding="utf-8"), re.MULTILINE)
    text = "\n".join(manifest.write({path.name for path in (folder / "bin").iterdir()}, [path.name for path in (folder / "icons").iterdir()]))
    (folder / "thicket.gdextension").write_text(text.replace("@MINIMUM@", minimum.group(1)), encoding="utf-8")
    for name in ("LICENSE", "CHANGELOG.md"):
        shutil.copy(REPO / name, folder)
    shutil.copy(REPO / "tools/package/README.md", folder)
    (folder / "THIRD_PARTY.txt").write_text(notices(), encoding="utf-8")


def demo(folder, addon_folder):
    """Copies the demo project with the add-on in it."""
    root = REPO / "demo_project"
    copy([path for path in tracked(root) if not path.is_relative_to(ADDON) and path.suffix != ".sh"], root, folder / "thicket_demo")
    shutil.copytree(addon_folder, folder / "thicket_demo/addons/thicket")


def notices():
    """The licenses of the works that are compiled into the libraries."""
    highway, zig = Path(installed.highway_folder()), Path(installed.zig_program()).parent
    works = [
        ("Highway, vectors for every processor (its BSD 3-clause license is chosen)", highway / "LICENSE-BSD3"),
        ("GLM, vectors and matrices", Path("/usr/share/doc/libglm-dev/copyright")),
        ("LLVM libc++, the C++ standard library", zig / "lib/libcxx/LICENSE.TXT"),
        ("LLVM libc++abi and libunwind", zig / "lib/libcxxabi/LICENSE.TXT"),
        ("Zig's compiler_rt", zig / "LICENSE"),
        ("MinGW-w64, start files of the libraries for Windows", zig / "lib/libc/mingw/COPYING"),
    ]
    rule = "=" * 100
    parts = ["Thicket's libraries contain parts of these works, under these licenses.\n"]
    parts += ["%s\n%s\n%s\n\n%s\n" % (rule, name, rule, path.read_text(encoding="utf-8").strip()) for name, path in works]
    return "\n".join(parts)
