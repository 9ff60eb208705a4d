"""Tests the workflows of the forge, their scripts and the forms for reports, without the forge: rules for the YAML files, the release
notes, and the release's draft with a program that replaces the forge's."""

from __future__ import annotations

import hashlib
import os
import re
import sys

import pytest
from conftest import CACHE, REPO, run

sys.path.insert(0, str(REPO / "tools/package"))
import contents  # noqa: E402 (only on the path above)
import notes  # noqa: E402

yaml = pytest.importorskip("yaml")
WORKFLOWS = sorted((REPO / ".github/workflows").glob("*.yml"))
FORMS = sorted(path for path in (REPO / ".github/ISSUE_TEMPLATE").glob("*.yml") if path.stem != "config")
CHECKERS = CACHE / "workflow-checkers/bin"
# The permissions to write that each job has.
WRITES = {"release": {"contents"}, "publish": {"pages", "id-token"}}
SCRIPTS = sorted((REPO / ".github").glob("*.sh"))


def steps_of(workflow: dict) -> list[dict]:
    return [step for job in workflow["jobs"].values() for step in job["steps"]]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_workflows_have_least_permissions_and_pinned_actions(path):
    workflow = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert workflow["permissions"] == {}, "no job has a permission that it does not list"
    assert "concurrency" in workflow
    for name, job in workflow["jobs"].items():
        writes = {permission for permission, level in job["permissions"].items() if level != "read"}
        assert writes == WRITES.get(name, set()), f"{name} may write {writes}"
        assert job["timeout-minutes"] <= 120 and not job["runs-on"].endswith("-latest"), name
    for step in steps_of(workflow):
        if "uses" in step:
            assert re.fullmatch(r"actions/[\w/-]+@[0-9a-f]{40}", step["uses"]), step["uses"]
        if step.get("uses", "").startswith("actions/checkout@"):
            assert step["with"]["persist-credentials"] is False
        # A name that someone else chose must not become part of a script, so it is passed as a variable.
        assert "github.event" not in step.get("run", "") and "github.ref" not in step.get("run", ""), step["run"]
    pins = set(re.findall(r"actions/(\w[\w-]*)\S*@(\S+ # v[\d.]+)$", path.read_text(encoding="utf-8"), re.MULTILINE))
    assert len(pins) == len({action for action, _ in pins}) >= 3, "one version of each action"


@pytest.mark.full
@pytest.mark.parametrize("checker", [["zizmor", "--offline", "--no-progress", "--quiet"], ["actionlint", "-shellcheck=", "-pyflakes="]], ids=lambda each: each[0])
def test_checkers_find_no_problem(checker, tmp_path):
    """Checks the workflows for weaknesses with zizmor, and for mistakes with actionlint. Each must find a problem in another workflow."""
    program = CHECKERS / checker[0]
    if not program.is_file():
        pytest.skip(f"no {checker[0]}: setup_workflow_checkers in tools/setup_full.sh installs it")
    completed = run([program, *checker[1:], *WORKFLOWS], timeout=60, cwd=REPO)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    wrong = tmp_path / "wrong.yml"
    wrong.write_text("on: pull_request_target\njobs:\n  a:\n    runs-on: nowhere\n    steps:\n      - run: echo ${{ github.event.issue.title }}\n")
    assert run([program, *checker[1:], wrong], timeout=60).returncode != 0


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_forms_are_valid(path):
    """Checks the parts that GitHub requires: unique IDs, and a label for each field."""
    form = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert form["name"] and form["description"]
    fields = [each for each in form["body"] if each["type"] != "markdown"]
    assert len({each["id"] for each in fields}) == len(fields) >= 3
    assert all(each["attributes"]["label"] for each in fields)
    assert any(each.get("validations", {}).get("required") for each in fields)


def test_the_form_for_problems_asks_for_the_system_report():
    """Checks that the form names the menu item as the editor shows it."""
    menu = (REPO / "demo_project/addons/thicket/editor/help/help_menu.gd").read_text(encoding="utf-8")
    item = re.search(r'add_item\("([^"]+)", Item.COPY_REPORT\)', menu).group(1)
    form = yaml.safe_load((REPO / ".github/ISSUE_TEMPLATE/problem.yml").read_text(encoding="utf-8"))
    (field,) = [each for each in form["body"] if each.get("id") == "system"]
    assert f"Project > Tools > Thicket > {item}" in field["attributes"]["description"] and field["validations"]["required"]


def test_pages_for_contributors_name_the_contact():
    assert re.search(r'^\[thicket\]$(?s:.*)^contact="\S+@\S+"$', (REPO / "demo_project/addons/thicket/plugin.cfg").read_text(encoding="utf-8"), re.MULTILINE)
    for name in (".github/SECURITY.md", ".github/CODE_OF_CONDUCT.md"):
        assert "address `contact` in the section `[thicket]`" in (REPO / name).read_text(encoding="utf-8").replace("\n", " "), name


def test_a_commit_is_tested_once():
    """Checks that a push to a pull request's branch does not start the same tests twice."""
    workflow = yaml.safe_load((REPO / ".github/workflows/test.yml").read_text(encoding="utf-8"))
    triggers = workflow[True]  # YAML reads the word "on" as true.
    assert triggers["push"]["branches"] == ["main"] and "pull_request" in triggers


def test_files_that_workflows_name_exist():
    for path in WORKFLOWS:
        for step in steps_of(yaml.safe_load(path.read_text(encoding="utf-8"))):
            for script in re.findall(r"[\w./]+\.(?:sh|py)\b", step.get("run", "")):
                assert (REPO / script).is_file(), f"{path.name}: {script}"
    for script in SCRIPTS:
        completed = run(["bash", "-n", script], timeout=20)
        assert completed.returncode == 0, completed.stderr


def test_notes_are_the_section_of_the_version():
    changes = (
        "# Changelog\n\nIntroduction.\n\n## [1.2.0] - Unreleased\n\n### Added\n\n- second\n\n### Fixed\n\n- more\n\n"
        "## [1.1.0] - 2026-01-02\n\n- first\n\n## [1.0.0] - 2026-01-01\n\n[1.2.0]: ../../compare/v1.1.0...HEAD\n"
    )
    assert notes.notes(changes, "1.2.0") == "### Added\n\n- second\n\n### Fixed\n\n- more"
    assert notes.notes(changes, "1.1.0") == "- first"
    assert notes.notes(changes, "1.0.0") is None, "an empty section"
    assert notes.notes(changes, "1x2x0") is None and notes.notes(changes, "1.2") is None


def test_a_tag_must_match_the_version():
    def printed(tag):
        return run([sys.executable, "tools/package/notes.py", tag], timeout=20, cwd=REPO)

    right, wrong = printed("v" + contents.version()), printed("v0.0.1")
    assert right.returncode == 0 and right.stdout.startswith("### Added\n"), right.stderr
    assert "](docs/" not in right.stdout and "](demo_project/" not in right.stdout, "the page of a release has no folder docs beside it"
    assert wrong.returncode != 0 and "v0.0.1" in wrong.stderr and "v" + contents.version() in wrong.stderr


@pytest.fixture
def forge(tmp_path) -> dict[str, str]:
    """Returns an environment whose program gh only writes its arguments to a file."""
    programs = tmp_path / "programs"
    programs.mkdir()
    program = programs / "gh"
    program.write_text(f"#!/bin/sh\nprintf '%s\\n' \"$@\" >'{tmp_path}/called'\n")
    program.chmod(0o755)
    return {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "GITHUB_REF_NAME": "v" + contents.version()}


def test_a_release_is_drafted_with_all_files(forge, tmp_path):
    """Drafts a release of small files. A zip that does not match its checksum must end the script."""
    dist = tmp_path / "dist"
    (dist / "symbols").mkdir(parents=True)
    (dist / "symbols/libthicket.so").write_text("symbols")
    version = contents.version()
    zips = [dist / f"thicket-{version}.zip", dist / f"thicket-demo-{version}.zip"]
    packages = [dist / f"poissontiles-{version}.tar.gz", dist / f"poissontiles-{version}-cp312-abi3-manylinux_2_17_aarch64.whl"]
    for path in zips + packages:
        path.write_text(path.name)
    (dist / "SHA256SUMS").write_text("".join(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in zips))
    completed = run(["bash", ".github/draft_release.sh", dist], timeout=30, cwd=REPO, env=forge)
    assert completed.returncode == 0, completed.stderr
    called = (tmp_path / "called").read_text().splitlines()
    assert called[:5] == ["release", "create", f"v{version}", "--draft", "--verify-tag"]
    files = {name.rsplit("/", 1)[1] for name in called if name.startswith(str(dist))}
    assert files == {*(path.name for path in zips + packages), "SHA256SUMS", f"thicket-symbols-{version}.tar.xz"}
    assert "libthicket.so" in run(["tar", "--list", "--file", dist / f"thicket-symbols-{version}.tar.xz"], timeout=20).stdout
    (tmp_path / "called").unlink()
    zips[0].write_text("damaged")
    completed = run(["bash", ".github/draft_release.sh", dist], timeout=30, cwd=REPO, env=forge)
    assert completed.returncode != 0 and not (tmp_path / "called").exists()


def test_scripts_of_the_engine_tests_run_without_pytest(tmp_path):
    """Runs two scripts with a program that replaces Godot. One passes, and the other makes no check, which must not count as passed."""
    addon = tmp_path / "addon"
    addon.mkdir()
    (addon / "thicket.gdextension").write_text("")
    godot = tmp_path / "godot"
    godot.write_text(
        "#!/bin/sh\n[ -f \"$3/addons/thicket/thicket.gdextension\" ] && [ -f \"$5\" ] || exit 3\n"
        "[ $(basename $5) = test_state.gd ] && count=5 || count=0\necho \"thicket engine tests: $count checks, 0 failed\"\n"
    )
    godot.chmod(0o755)
    command = [sys.executable, "tests/engine/run_scripts.py", "--godot", godot, "--addon", addon]
    completed = run([*command, "test_state", "test_saves"], timeout=60, cwd=REPO)
    assert completed.returncode == 1 and "test_state: passed" in completed.stdout and "test_saves: failed" in completed.stdout, completed.stdout + completed.stderr
    assert run([*command, "test_state"], timeout=60, cwd=REPO).returncode == 0
