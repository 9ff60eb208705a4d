"""Tests tools/package.sh without building. There must be one version number, zips must be reproducible, and the
manifest must distinguish all libraries."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import struct
import sys
import zipfile
from pathlib import Path, PurePosixPath

import numpy as np
import pytest
from conftest import REPO, run
from PIL import Image

sys.path.insert(0, str(REPO / "tools/package"))
import archive  # noqa: E402 (only on the path above)
import contents  # noqa: E402
import installed  # noqa: E402
import manifest  # noqa: E402
import package  # noqa: E402
import platforms  # noqa: E402
import signing  # noqa: E402


def test_one_version():
    """Checks that the version is a semantic version, and that the first section of the change log is for this version."""
    version = contents.version()
    assert re.fullmatch(r"\d+\.\d+\.\d+(-[0-9a-z.]+)?", version), version
    first = re.search(r"^## \[([^]]+)\] - ", (REPO / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert first and first.group(1) == version


def test_the_addresses_are_in_one_file():
    """Checks that the owner sets the addresses of the repository and the documentation in plugin.cfg alone. The documentation,
    the Python package and the README of the zips read them there; the add-on's menu does, too."""
    addresses = [contents.setting("repository"), contents.setting("documentation")]
    assert all(re.fullmatch(r"https://[\w./-]+[\w-]", address) for address in addresses)
    assert all(address in contents.readme() for address in addresses) and "@" not in contents.readme()
    listed = run(["git", "grep", "--files-with-matches", "--fixed-strings", *(part for address in addresses for part in ("-e", address))], timeout=60, cwd=REPO)
    if listed.returncode not in (0, 1):
        pytest.skip("not a git checkout")
    assert listed.stdout.split() == ["demo_project/addons/thicket/plugin.cfg"]
    for reader in ("docs/conf.py", "python/plugin_cfg.py"):
        text = (REPO / reader).read_text(encoding="utf-8")
        assert "plugin.cfg" in text and "repository" in text and "documentation" in text, reader


def test_a_zip_depends_only_on_its_content(tmp_path):
    """Checks that file times and the order of writing do not affect the bytes of a zip, but that the content does."""
    for number, names in enumerate((["b.txt", "a/c.txt"], ["a/c.txt", "b.txt"])):
        for name in names:
            path = tmp_path / str(number) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("content of " + name)
            os.utime(path, (10**9 * (number + 1),) * 2)
    first, second = (archive.write(tmp_path / str(number), tmp_path / f"{number}.zip").read_bytes() for number in (0, 1))
    assert first == second
    (tmp_path / "1/b.txt").write_text("other")
    assert archive.write(tmp_path / "1", tmp_path / "1.zip").read_bytes() != first


def skipped_folder(path: Path) -> str:
    """Returns the top folder that the editor's Asset Library skips when it installs a zip, or "". Implements
    EditorAssetInstaller::_check_has_toplevel of Godot 4.6, which also counts the folders of all files."""
    with zipfile.ZipFile(path) as file:
        entries = {parent.as_posix() + "/" for name in file.namelist() for parent in PurePosixPath(name).parents if parent.name} | set(file.namelist())
    first, *others = sorted(entries)
    return first if first.endswith("/") and all(entry.startswith(first) for entry in others) else ""


def test_the_asset_library_installs_into_addons(tmp_path):
    """Checks that the editor does not skip the folder addons of the zip, as it would without a second entry."""
    (tmp_path / "stage/addons/thicket").mkdir(parents=True)
    (tmp_path / "stage/addons/thicket/plugin.cfg").touch()
    assert skipped_folder(archive.write(tmp_path / "stage", tmp_path / "alone.zip")) == "addons/"
    contents.beside_addons(tmp_path / "stage")
    assert skipped_folder(archive.write(tmp_path / "stage", tmp_path / "shipped.zip")) == ""


def test_the_store_has_what_it_asks_for():
    """Checks the texts and the pictures in tools/package/store, and that the editor's list of plugins mentions plants."""
    store = REPO / "tools/package/store"
    text = (store / "listing.md").read_text(encoding="utf-8")
    fields = dict(re.findall(r"^\| (\w[\w ]*) \| (.+) \|$", text, re.MULTILINE))
    assert {"Title", "Summary", "Tags", "Category", "License", "Minimum Godot version"} <= fields.keys()
    assert len(fields["Summary"]) <= 120 and "plants" in fields["Summary"] and "plants" in contents.setting("description")
    assert len(text.split("## Description")[1].split()) > 100
    with Image.open(store / "icon.png") as icon, Image.open(store / "thumbnail.jpg") as thumbnail:
        assert icon.size == (256, 256) and thumbnail.size == (1280, 720)
    screenshots = sorted(store.glob("screenshot_*.jpg"))
    assert len(screenshots) == 5
    for path in screenshots:
        with Image.open(path) as image:
            assert image.size == (1920, 1080) and path.stat().st_size < 2_000_000, path.name
            assert np.asarray(image.convert("L"), np.float32).std() > 20, f"{path.name} is almost blank"


def test_archives_of_the_repository_leave_out_what_only_the_forge_needs():
    listed = run(["git", "check-attr", "export-ignore", ".github", ".ci", "tools/package/store", "extension", "docs", "tests"], timeout=20, cwd=REPO)
    if listed.returncode:
        pytest.skip("no git, or not a git checkout")
    ignored = {line.split(":")[0] for line in listed.stdout.splitlines() if line.endswith(": set")}
    assert ignored == {".github", ".ci", "tools/package/store"}


def test_every_library_has_a_separate_entry():
    """Checks that the manifest of a complete package lists every library under different feature tags."""
    names = {file for build in package.BUILDS for file in shipped_names(build)}
    text = "\n".join(manifest.write(names, []))
    entries = re.findall(r'^([\w.]+) = "bin/([^"]+)"$', text, re.MULTILINE)
    assert {file for _, file in entries} == names
    tags = [frozenset(key.split(".")) for key, _ in entries]
    assert len(set(tags)) == len(tags)
    by_tags = dict(zip(tags, (file for _, file in entries), strict=True))
    assert by_tags[frozenset("linux debug x86_64 single".split())] == "libthicket.linux.template_debug.x86_64.so"
    assert by_tags[frozenset("windows release arm64 double".split())] == "libthicket.windows.template_release.double.arm64.dll"
    assert by_tags[frozenset("macos release single".split())] == "libthicket.macos.template_release.framework"
    assert by_tags[frozenset("web release wasm32 nothreads".split())].endswith("wasm32.nothreads.wasm")
    assert by_tags[frozenset("web release wasm32 threads".split())].endswith("wasm32.wasm")


def shipped_names(build: package.Build) -> list[str]:
    """Returns the names of the files that a build adds to bin/."""
    double = ".double" if build.precision == "double" else ""
    threads = "" if build.threads else ".nothreads"
    suffix = {"linux": ".so", "windows": ".dll", "web": ".wasm"}.get(build.platform)
    rest = f"{double}.{build.arch}{threads}{suffix}" if suffix else f"{double}.framework"
    return [f"libthicket.{build.platform}.{target}{rest}" for target in ("template_debug", "template_release")]


def test_wrong_names_are_rejected():
    completed = run([sys.executable, REPO / "tools/package/package.py", "amiga.m68k"], timeout=60)
    assert completed.returncode == 2 and "no such build: amiga.m68k" in completed.stderr and "linux.x86_64" in completed.stderr


def test_builds_are_listed():
    """Checks that --list prints the builds that the same arguments would create. tools/package.sh installs the
    compilers for these builds."""
    for arguments, names in (
        ([], [build.name for build in package.BUILDS]),
        (["--out", "/tmp/windows"], [build.name for build in package.BUILDS]),
        (["linux.x86_64", "web.wasm32.nothreads"], ["linux.x86_64", "web.wasm32.nothreads"]),
    ):
        completed = run(["bash", "tools/package.sh", "--list", *arguments], timeout=60, cwd=REPO)
        assert completed.returncode == 0 and completed.stdout.split() == names, completed.stdout + completed.stderr


@pytest.mark.parametrize("options", [["--engine-api", "build"], ["--built"]])
def test_packing_does_not_need_godot(options):
    """Checks that neither packing nor a build with Godot's API in a folder looks for Godot. The wrong name then ends the script."""
    if not Path(installed.zig_program()).exists() or not shutil.which("llvm-strip"):
        pytest.skip("tools/package.sh would install zig or LLVM")
    completed = run(["bash", "tools/package.sh", *options, "amiga.m68k"], timeout=120, cwd=REPO, env={**os.environ, "GODOT": "/nonexistent"})
    assert completed.returncode == 2 and "no such build: amiga.m68k" in completed.stderr and "GODOT" not in completed.stderr, completed.stderr


def test_the_api_of_the_engine_is_passed_to_the_build(monkeypatch):
    commands = []
    monkeypatch.setattr(package.subprocess, "run", lambda command, **_: commands.append(command))
    package.build(package.BUILDS[:2], "some/folder")
    package.build(package.BUILDS[:1], None)
    passed = [[option for option in command if option.startswith("engine_api=")] for command in commands]
    assert passed == [[f"engine_api={os.path.abspath('some/folder')}"]] * 2 + [[]]


@pytest.mark.parametrize("page", ["README.md", "docs/getting_started.md", "tools/package/README.md"])
def test_the_oldest_glibc_is_documented(page):
    targets = {target for (platform, _), target in platforms.ZIG_TARGETS.items() if platform == "linux" and "riscv" not in target}
    built_for = {re.search(r"-gnu\.([\d.]+)$", target).group(1) for target in targets}
    assert set(re.findall(r"glibc ([\d.]+)", (REPO / page).read_text(encoding="utf-8"))) == built_for


def small_library(first_section: int = 4096) -> bytes:
    """Returns a Mach-O library for x86_64 with one section and a segment __LINKEDIT, as a linker writes it without a signature."""
    text = struct.pack("<2I16s4Q4I", 0x19, 152, b"__TEXT", 0, 0x4000, 0, 6000, 5, 5, 1, 0)
    text += struct.pack("<16s16s2Q8I", b"__text", b"__TEXT", first_section, 100, first_section, *[0] * 7)
    linkedit = struct.pack("<2I16s4Q4I", 0x19, 72, b"__LINKEDIT", 0x4000, 0x1000, 8192, 1001, 1, 1, 0, 0)
    header = struct.pack("<8I", 0xFEEDFACF, 0x1000007, 3, 6, 2, len(text + linkedit), 0x85, 0)
    return (header + text + linkedit).ljust(first_section, b"\0") + bytes(range(256)) * 16 + b"l" * (8192 + 1001 - first_section - 4096)


def check_signature(library: bytes, identifier: str):
    """Checks that a library for one CPU has a signature with this name at its end, which covers every byte before it."""
    count, at = struct.unpack_from("<I", library, 16)[0], 32
    places, linkedit = [], []
    for _ in range(count):
        kind, size = struct.unpack_from("<2I", library, at)
        places += [struct.unpack_from("<2I", library, at + 8)] if kind == 0x1D else []
        linkedit += [struct.unpack_from("<4Q", library, at + 24)] if library[at + 8 : at + 18] == b"__LINKEDIT" else []
        at += size
    assert len(places) == 1, f"{len(places)} signatures"
    start, size = places[0]
    _, in_memory, offset, in_file = linkedit[0]
    assert start + size == len(library) == offset + in_file and in_memory >= in_file and start % 16 == 0
    magic, length, blobs, kind, directory = struct.unpack_from(">5I", library, start)
    assert (magic, length, blobs, kind) == (0xFADE0CC0, size, 1, 0)
    directory += start
    magic, _, _, flags, hashes, name, _, slots, covered, hash_size, hash_type, _, page = struct.unpack_from(">9I4B", library, directory)
    assert (magic, flags & 2, covered, hash_size, hash_type, page) == (0xFADE0C02, 2, start, 32, 2, 12)
    assert library[directory + name :].split(b"\0")[0].decode() == identifier
    pages = [hashlib.sha256(library[each : min(each + 4096, start)]).digest() for each in range(0, start, 4096)]
    assert slots == len(pages) and library[directory + hashes :][: 32 * slots] == b"".join(pages)


def test_libraries_for_macos_are_signed():
    """Checks the signature of a library that had none, and that a later signature replaces it. The content must not change."""
    library = small_library()
    signed = signing.sign(library, "thicket.template-release.single")
    check_signature(signed, "thicket.template-release.single")
    assert signed[4096 : len(library)] == library[4096:], "the content"
    again = signing.sign(signed, "other")
    check_signature(again, "other")
    assert signing.sign(again, "thicket.template-release.single") == signed
    changed = bytearray(signed)
    changed[5000] ^= 1
    with pytest.raises(AssertionError):
        check_signature(bytes(changed), "thicket.template-release.single")


def test_libraries_that_cannot_be_signed():
    header_only = 32 + 152 + 72
    with pytest.raises(ValueError, match="headerpad"):
        signing.sign(small_library(first_section=header_only + 8), "thicket")
    with pytest.raises(ValueError, match="before merging"):
        signing.sign(b"\xca\xfe\xba\xbe" + bytes(100), "thicket")
