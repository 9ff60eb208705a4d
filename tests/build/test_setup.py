"""Tests that tools/setup.sh finds existing programs, rejects versions that are too old, and does not use the network if
everything is installed."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from conftest import CACHE, REPO, run


def shell(script: str, **environment: str):
    """Runs a shell command with the functions of tools/setup.sh and additional environment variables."""
    changed = {**os.environ, **environment}
    return run(["bash", "-euo", "pipefail", "-c", f"source tools/setup.sh; {script}"], timeout=60, cwd=REPO, env=changed)


def fake_godot(folder: Path, name: str, version: str) -> Path:
    program = folder / name
    program.write_text(f"#!/bin/sh\necho '{version}'\n")
    program.chmod(0o755)
    return program


@pytest.mark.parametrize(
    ("version", "taken"),
    [
        ("4.4.stable.official.4c311cbee", True),
        ("4.10.1.stable", True),
        ("5.0.beta1", True),
        ("4.3.stable.official.77dcf97d8", False),
        ("3.6.stable", False),
        ("not a version", False),
    ],
)
def test_versions_of_godot(tmp_path, version, taken):
    godot = fake_godot(tmp_path, "godot4", version)
    found = shell("find_native_godot", GODOT="", PATH=f"{tmp_path}:/usr/bin:/bin")
    assert found.stdout.strip() == (str(godot) if taken else "")


def test_the_users_godot_takes_priority(tmp_path):
    (tmp_path / "other").mkdir()
    fake_godot(tmp_path, "godot", "4.6.stable")
    mine = fake_godot(tmp_path / "other", "my-godot", "4.5.stable")
    found = shell("find_native_godot", GODOT=str(mine), PATH=f"{tmp_path}:/usr/bin:/bin")
    assert found.stdout.strip() == str(mine)


@pytest.mark.parametrize("version", [None, "4.2.stable"])
def test_a_wrong_godot_is_an_error(tmp_path, version):
    """Checks that it is an error if the Godot that the user has specified is missing or too old. The setup must not use another
    Godot instead."""
    named = tmp_path / "my-godot"
    if version:
        fake_godot(tmp_path, "my-godot", version)
    fake_godot(tmp_path, "godot", "4.6.stable")
    found = shell("find_native_godot", GODOT=str(named), PATH=f"{tmp_path}:/usr/bin:/bin")
    assert found.returncode != 0
    assert f"GODOT={named}" in found.stderr
    assert run([REPO / "tools/godot", "--where"], timeout=60, env={**os.environ, "GODOT": str(named)}).returncode != 0


@pytest.mark.parametrize(
    ("file", "text", "mirror"),
    [
        ("sources.list", "deb http://one.example/debian trixie main\n", "http://one.example/debian"),
        (
            "sources.list",
            "# deb http://no.example/debian old main\ndeb [arch=amd64 signed-by=/k.gpg] https://two.example/debian/ trixie main\n",
            "https://two.example/debian/",
        ),
        ("sources.list.d/debian.sources", "Types: deb\nURIs: http://three.example/debian\nSuites: x\n", "http://three.example/debian"),
        ("sources.list.d/a.sources", "Types: deb\nURIs: http://four.example/ubuntu/\nSuites: noble\n", ""),
        ("sources.list.d/a.list", "deb http://five.example/debian-security trixie-security main\n", ""),
    ],
)
def test_the_mirror_of_the_machine_is_used(tmp_path, file, text, mirror):
    (tmp_path / "sources.list.d").mkdir()
    (tmp_path / file).write_text(text)
    found = shell(f"debian_mirror '{tmp_path}'")
    assert found.stdout.strip() == mirror


@pytest.fixture
def bare_path(tmp_path) -> str:
    """Returns a PATH with the programs of this machine, except those of Debian's packaging and those that macOS does not have."""
    folder = tmp_path / "programs"
    folder.mkdir()
    without = {"apt-get", "sudo", "scons", "mmdebstrap", "bwrap", "cargo", "godot", "nproc", "timeout", "sha256sum"}
    for program in Path("/usr/bin").iterdir():
        if program.name not in without:
            (folder / program.name).symlink_to(program)
    return str(folder)


def test_one_message_lists_everything_that_is_missing(bare_path, tmp_path):
    """Checks the message of a machine that has nothing, and that a machine that has everything prints none."""
    bare = {"PATH": bare_path, "THICKET_CACHE": str(tmp_path / "cache"), "CXX": "no-compiler", "GODOT": ""}
    found = shell("debian_mirror() { :; }; setup_check godot tests", **bare)
    assert found.returncode != 0 and found.stderr.count("thicket:") == 1, found.stderr
    for missing in ("C++20 compiler", "GLM", "doctest", "CGAL", "cargo", "LodePNG", "Godot 4.4"):
        assert missing in found.stderr, missing
    for system in ("Debian", "Fedora", "Arch", "Homebrew"):
        assert system in found.stderr, system
    complete = shell("setup_check godot tests")
    assert complete.returncode == 0 and not complete.stderr, complete.stderr


def test_the_cached_sources_of_highway_match_both_checksums(bare_path):
    """Checks that Debian's sources are those of the Rust crate, also without the program sha256sum."""
    for environment in ({}, {"PATH": bare_path} if shutil.which("shasum") else {}):
        found = shell('[[ $(tree_sum "$(cache_folder)/highway-$highway_version" hwy LICENSE-BSD3) == "$highway_tree_sha256" ]]', **environment)
        assert found.returncode == 0, found.stderr


def test_time_limits_and_cores_do_not_need_gnu_programs(bare_path):
    found = shell("time_limit 5 echo done; core_count", PATH=bare_path)
    assert found.returncode == 0 and found.stdout.split()[0] == "done" and int(found.stdout.split()[1]) >= 1, found.stderr
    assert shell("time_limit 1 sleep 20").returncode == 124


@pytest.fixture
def no_namespaces(tmp_path) -> dict[str, str]:
    """Returns an environment in which bubblewrap fails as in a container without privileges."""
    folder = tmp_path / "failing"
    folder.mkdir()
    failing_bwrap = folder / "bwrap"
    failing_bwrap.write_text("#!/bin/sh\necho 'bwrap: No permissions to create new namespace' >&2\nexit 1\n")
    failing_bwrap.chmod(0o755)
    return {"PATH": f"{folder}:{os.environ['PATH']}"}


def test_godot_runs_without_bubblewrap(no_namespaces):
    """Checks that tools/godot runs the Debian root's Godot in the same way with and without bubblewrap."""
    if shell("find_native_godot").stdout or not (CACHE / "godot-root/usr/bin/godot").exists():
        pytest.skip("Godot of this machine does not need a Debian root")
    environment = {**os.environ, **no_namespaces}
    for option in ("--version", "--where"):
        sandboxed, direct = (run([REPO / "tools/godot", option], timeout=60, env=each) for each in (os.environ, environment))
        assert direct.returncode == 0, direct.stderr
        assert sandboxed.stdout == direct.stdout
    found = shell("setup_display() { :; }; setup_godot", **no_namespaces)
    assert found.returncode == 0, found.stderr


def test_another_version_of_godot_is_reported():
    """Checks that the setup warns if the suite's Godot is not the version that the tests are made for."""
    if shell("find_native_godot").stdout or not (CACHE / "godot-root/usr/bin/godot").exists():
        pytest.skip("Godot of this machine does not come from a Debian root")
    found = shell("godot_version=4.5.1; setup_godot")
    assert found.returncode == 0 and "made for Godot 4.5.1" in found.stderr, found.stderr
    assert not shell("setup_godot").stderr


def test_without_missing_packages_no_network_is_used():
    """Runs the setup in an empty network namespace, where any network access fails."""
    if run(["unshare", "--net", "true"], timeout=20).returncode:
        pytest.skip("this user may not create a network namespace")
    completed = run(["unshare", "--net", "bash", "tools/setup.sh"], timeout=120, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    assert "everything is installed" in completed.stderr
    assert "installing" not in completed.stderr and "creating" not in completed.stderr, completed.stderr


def test_godot_runs_in_the_callers_folder(tmp_path):
    """Checks that arguments with spaces are passed unchanged, and that relative paths refer to the caller's working
    directory."""
    folder = tmp_path / "a project"
    folder.mkdir()
    (folder / "say.gd").write_text(
        "extends SceneTree\nfunc _init():\n\tprint('ARGS ', OS.get_cmdline_user_args())\n\tquit(7)\n"
    )
    command = [REPO / "tools/godot", "--headless", "--script", "say.gd", "--", "one two", "*"]
    completed = run(command, timeout=120, cwd=folder)
    assert completed.returncode == 7, completed.stdout + completed.stderr
    assert 'ARGS ["one two", "*"]' in completed.stdout
