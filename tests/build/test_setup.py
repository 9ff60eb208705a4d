"""Tests that tools/setup.sh finds existing programs, rejects versions that are too old, and does not use the network if
everything is installed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from conftest import REPO, run


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


def test_without_missing_packages_no_network_is_used():
    """Runs the setup in an empty network namespace, where any network access fails."""
    if run(["unshare", "--net", "true"], timeout=20).returncode:
        pytest.skip("this user may not create a network namespace")
    done = run(["unshare", "--net", "bash", "tools/setup.sh"], timeout=120, cwd=REPO)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "everything is installed" in done.stderr
    assert "installing" not in done.stderr and "creating" not in done.stderr, done.stderr


def test_godot_runs_in_the_callers_folder(tmp_path):
    """Checks that arguments with spaces are passed unchanged, and that relative paths refer to the caller's working
    directory."""
    folder = tmp_path / "a project"
    folder.mkdir()
    (folder / "say.gd").write_text(
        "extends SceneTree\nfunc _init():\n\tprint('ARGS ', OS.get_cmdline_user_args())\n\tquit(7)\n"
    )
    command = [REPO / "tools/godot", "--headless", "--script", "say.gd", "--", "one two", "*"]
    done = run(command, timeout=120, cwd=folder)
    assert done.returncode == 7, done.stdout + done.stderr
    assert 'ARGS ["one two", "*"]' in done.stdout
