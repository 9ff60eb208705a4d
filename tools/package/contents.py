"""Assembles the contents of the zips, except the libraries."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
ADDON = REPO / "demo_project/addons/thicket"
BESIDE_ADDONS = """Thicket consists of the folder addons/thicket. You may delete this file after the installation.

Enable the plugin in Project > Project Settings > Plugins. addons/thicket/README.md describes the next steps.
"""
sys.path.insert(0, str(REPO / "tools/scons"))

import installed  # noqa: E402 (only on the path above)
import manifest  # noqa: E402


def version():
    """Returns the version of the add-on, which plugin.cfg contains."""
    return setting("version")


def setting(name):
    """Returns a value in plugin.cfg, the only file with the version and with the addresses of the repository and the
    documentation."""
    return re.search(r'^%s="([^"]+)"$' % name, (ADDON / "plugin.cfg").read_text(encoding="utf-8"), re.MULTILINE).group(1)


def readme():
    """Returns the README of the zips, with the addresses of plugin.cfg."""
    text = (REPO / "tools/package/README.md").read_text(encoding="utf-8")
    return re.sub(r"@(REPOSITORY|DOCUMENTATION)@", lambda name: setting(name.group(1).lower()), text)


def with_addresses(changes):
    """Returns a text of CHANGELOG.md whose relative links are addresses, for readers who do not have the repository."""
    changes = re.sub(r"(?<=\]\()(?:docs|demo_project/addons/thicket)/([\w/]+)\.md", lambda link: f"{setting('documentation')}/{link.group(1)}.html", changes)
    return re.sub(r"^(\[[\d.]+\]: )\.\./\.\./", lambda link: f"{link.group(1)}{setting('repository')}/", changes, flags=re.MULTILINE)


def tracked(folder):
    """Returns the files in a folder of the repository that git tracks."""
    listing = subprocess.run(["git", "ls-files", "-z", "--", str(folder)], cwd=REPO, check=True, capture_output=True, text=True)
    return [REPO / name for name in listing.stdout.split("\0") if name and (REPO / name).is_file()]


def copy(paths, root, target):
    for path in paths:
        destination = target / path.relative_to(root)
        destination.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, destination)


def addon(folder, built):
    """Assembles the add-on in `folder`, whose bin/ already contains the libraries. `built` is the add-on's folder in
    one of the builds, from which generated files are copied."""
    copy(tracked(ADDON), ADDON, folder)
    shutil.copytree(built / "csharp", folder / "csharp", dirs_exist_ok=True)
    minimum = re.search(r'^compatibility_minimum = "([^"]+)"$', (built / "thicket.gdextension").read_text(encoding="utf-8"), re.MULTILINE)
    text = "\n".join(manifest.write({path.name for path in (folder / "bin").iterdir()}, [path.name for path in (folder / "icons").iterdir()]))
    (folder / "thicket.gdextension").write_text(text.replace("@MINIMUM@", minimum.group(1)), encoding="utf-8")
    shutil.copy(REPO / "LICENSE", folder)
    (folder / "CHANGELOG.md").write_text(with_addresses((REPO / "CHANGELOG.md").read_text(encoding="utf-8")), encoding="utf-8")
    (folder / "README.md").write_text(readme(), encoding="utf-8")
    (folder / "THIRD_PARTY.txt").write_text(notices(), encoding="utf-8")


def beside_addons(folder):
    """Writes the file that the zip of the add-on contains beside the folder addons. In Godot up to 4.6, the editor's Asset Library
    skips the top folder of a zip that has only one, and would install the add-on into res://thicket."""
    (folder / "thicket_readme.txt").write_text(BESIDE_ADDONS, encoding="utf-8")


def demo(folder, addon_folder):
    """Copies the demo project without its shell scripts and puts the add-on into it."""
    root = REPO / "demo_project"
    copy([path for path in tracked(root) if not path.is_relative_to(ADDON) and path.suffix != ".sh"], root, folder / "thicket_demo")
    shutil.copytree(addon_folder, folder / "thicket_demo/addons/thicket")


def notices():
    """Returns the licenses of all third-party code that is compiled into the libraries."""
    highway, lodepng, zig = Path(installed.highway_folder()), Path(installed.lodepng_folder()), Path(installed.zig_program()).parent
    works = [
        ("Highway, vectors for every processor (its BSD 3-clause license is chosen)", highway / "LICENSE-BSD3"),
        ("LodePNG, a reader of PNG files", lodepng / "LICENSE"),
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
