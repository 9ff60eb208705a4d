"""Compiles the C# wrappers of the add-on and the C# example of docs/howto/csharp.md without an engine. No package registry offers
Godot with .NET, so Debian's Mono compiler compiles them against tests/csharp/GodotStub.cs."""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import REPO, run

GENERATOR = REPO / "tools/csharp/generate.py"
# Deprecated classes have no wrapper.
PAGES = [page for page in sorted((REPO / "extension/doc_classes").glob("*.xml")) if "deprecated=" not in page.read_text(encoding="utf-8")]
STUB = REPO / "tests/csharp/GodotStub.cs"

sys.path.insert(0, str(GENERATOR.parent))
import types_of_godot  # noqa: E402 (only on the path above)

pytestmark = pytest.mark.skipif(shutil.which("mcs") is None, reason="the Mono compiler (mcs) is not installed")


def generated(folder: Path) -> list[Path]:
    completed = run([sys.executable, GENERATOR, "--out", folder, *(REPO / "extension/doc_classes").glob("*.xml")], timeout=60)
    assert completed.returncode == 0, completed.stderr
    return sorted(folder.glob("*.cs"))


@pytest.fixture(scope="module")
def wrappers(tmp_path_factory) -> list[Path]:
    return generated(tmp_path_factory.mktemp("wrappers"))


def engine_classes(sources: list[str]) -> str:
    """Returns C# code with empty classes, their base classes and enums for all engine types that the sources use and
    the stub lacks."""
    api = json.loads((REPO / "build/engine/extension_api.json").read_text(encoding="utf-8"))
    known = {one["name"]: one for one in api["classes"]}
    there = set(re.findall(r"\b(?:class|struct) (\w+)", STUB.read_text(encoding="utf-8"))) | {"Object"}
    code = "\n".join(re.sub(r"//.*", "", source) for source in sources)
    wanted = [name for name in sorted(set(re.findall(r"\b[A-Z]\w+\b", code)) & known.keys()) if name not in there]
    lines = []
    while wanted:
        name = wanted.pop()
        if name in there:
            continue
        there.add(name)
        base = known[name].get("inherits", "Object")
        wanted.append(base)
        enums = ""
        for enum in known[name].get("enums", []):
            values = types_of_godot.members_of_enum([value["name"] for value in enum["values"]])
            enums += f" public enum {enum['name']} : long {{ {', '.join(values.values())} }}"
        lines.append(f"public class {name} : {base.replace('Object', 'GodotObject') if base == 'Object' else base} {{{enums} }}")
    return "namespace Godot\n{\n" + "\n".join(lines) + "\n}\n"


def compile_all(folder: Path, files: list[Path], *more: str):
    """Compiles a library from the files and from the additional sources in `more`."""
    texts = [path.read_text(encoding="utf-8") for path in files] + list(more)
    (folder / "engine.cs").write_text(engine_classes(texts), encoding="utf-8")
    for number, source in enumerate(more):
        (folder / f"source_{number}.cs").write_text(source, encoding="utf-8")
    named = [*files, STUB, folder / "engine.cs", *(folder / f"source_{number}.cs" for number in range(len(more)))]
    return run(["mcs", "-target:library", "-langversion:7.2", f"-out:{folder / 'all.dll'}", *named], timeout=300)


def test_every_class_has_a_wrapper_that_compiles(wrappers, tmp_path):
    completed = compile_all(tmp_path, wrappers)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    names = {ElementTree.parse(page).getroot().get("name") for page in PAGES}
    assert {path.stem for path in wrappers} == names | {"ThicketObject"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_wrapper_has_every_member_of_its_page(wrappers, page):
    root = ElementTree.parse(page).getroot()
    text = next(path for path in wrappers if path.stem == page.stem).read_text(encoding="utf-8")
    for kind, tag in (("Object.Get(PropertyName.", "member"), ("Object.Call(MethodName.", "method"), ("AddHandler(SignalName.", "signal")):
        for element in root.iter(tag):
            if "virtual" not in (element.get("qualifiers") or "") and not element.get("overrides"):
                assert f"{kind}{types_of_godot.pascal(element.get('name'))}" in text, element.get("name")
    for constant in root.iter("constant"):
        assert re.search(rf"\w+ = {constant.get('value')}[,;]", text), constant.get("name")


def test_the_example_of_the_documentation_compiles(wrappers, tmp_path):
    text = (REPO / "docs/howto/csharp.md").read_text(encoding="utf-8")
    examples = re.findall(r"^```csharp\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert examples, "docs/howto/csharp.md has no example"
    if not (REPO / "extension/doc_classes/ScatterRequest.xml").is_file():
        pytest.skip("the class reference is older than the example")
    completed = compile_all(tmp_path, wrappers, *examples)
    assert completed.returncode == 0, completed.stdout + completed.stderr


@pytest.mark.parametrize(
    "body",
    [
        "new ScatterLayer { Radius = \"three\" };",
        "new ScatterLayer { Radios = 3.0 };",
        "new TerrainScatter3D { Layers = new[] { new ScatterState() } };",
        "new TerrainScatter3D().InstanceRemoved += (string id) => { };",
        "ScatterState state = new ScatterLayer();",
    ],
)
def test_wrong_code_does_not_compile(wrappers, tmp_path, body):
    source = f"using Godot; using Thicket; class Wrong {{ void Run() {{ {body} }} }}"
    completed = compile_all(tmp_path, wrappers, source)
    assert completed.returncode != 0 and "source_0.cs" in completed.stdout + completed.stderr, completed.stdout + completed.stderr


def test_generated_files_are_replaced_and_others_kept(tmp_path):
    """Checks that the generator deletes the file of a removed class, but not a user's file."""
    generated(tmp_path)
    note = (tmp_path / "ScatterLayer.cs").read_text(encoding="utf-8").splitlines()[0]
    (tmp_path / "ScatterGone.cs").write_text(note + "\nclass ScatterGone {}\n")
    (tmp_path / "Mine.cs").write_text("class Mine {}\n")
    names = {path.name for path in generated(tmp_path)}
    assert "Mine.cs" in names and "ScatterGone.cs" not in names


def test_the_add_on_has_the_generated_files(wrappers):
    """Checks that the build has copied the generated files into the add-on."""
    shipped = REPO / "demo_project/addons/thicket/csharp"
    for path in wrappers:
        assert (shipped / path.name).read_text(encoding="utf-8") == path.read_text(encoding="utf-8"), path.name
