"""Tests tools/package.sh without building. There must be one version number, zips must be reproducible, and the
manifest must distinguish all libraries."""

from __future__ import annotations

import os
import re
import sys

from conftest import REPO, run

sys.path.insert(0, str(REPO / "tools/package"))
import archive  # noqa: E402 (only on the path above)
import contents  # noqa: E402
import manifest  # noqa: E402
import package  # noqa: E402


def test_one_version():
    """Checks that the version is a semantic version, and that the first section of the change log is for this version."""
    version = contents.version()
    assert re.fullmatch(r"\d+\.\d+\.\d+(-[0-9a-z.]+)?", version), version
    first = re.search(r"^## (\S+)", (REPO / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert first and first.group(1) == version


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
    done = run([sys.executable, REPO / "tools/package/package.py", "amiga.m68k"], timeout=60)
    assert done.returncode == 2 and "no such build: amiga.m68k" in done.stderr and "linux.x86_64" in done.stderr


def test_builds_are_listed():
    """Checks that --list prints the builds that the same arguments would create. tools/package.sh installs the
    compilers for these builds."""
    for arguments, names in (
        ([], [build.name for build in package.BUILDS]),
        (["--out", "/tmp/windows"], [build.name for build in package.BUILDS]),
        (["linux.x86_64", "web.wasm32.nothreads"], ["linux.x86_64", "web.wasm32.nothreads"]),
    ):
        done = run(["bash", "tools/package.sh", "--list", *arguments], timeout=60, cwd=REPO)
        assert done.returncode == 0 and done.stdout.split() == names, done.stdout + done.stderr
