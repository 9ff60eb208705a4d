"""Compares tests/csharp/GodotStub.cs with the handwritten part of GodotSharp, the engine's C# library. The wrappers of the
add-on are compiled against the stub (test_csharp.py). If the stub declared more than GodotSharp has, they might not
compile in a game."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import CACHE, REPO

STUB = REPO / "tests/csharp/GodotStub.cs"
GODOT_SHARP = CACHE / "godot-source/modules/mono/glue/GodotSharp/GodotSharp/Core"
# The engine generates these classes from its API description, which test_csharp.py reads.
GENERATED = {"RefCounted", "Resource", "Node", "Node3D", "ClassDB", "ResourceSaver", "Error"}
GENERATED_MEMBERS = {"Get", "Set", "Call", "Connect", "Disconnect", "IsClass", "GetClass"}  # Of GodotObject.

MODIFIERS = r"\b(?:static|unsafe|readonly|override|virtual|sealed|partial|abstract|new)\s+"


def without_comments(text: str) -> str:
    text = re.sub(r"//.*", "", text)
    # Attributes. An indexer follows the word `this`, and the brackets of an array are empty.
    return re.sub(r"(?<!\w)\[[A-Za-z][^\[\]]*\]\s*", "", text)


def split(parameters: str) -> list[str]:
    """Splits a list at the commas outside of angle brackets."""
    return [part.strip() for part in re.split(r",(?![^<]*>)", parameters) if part.strip()]


def signature(head: str, parameters: str) -> str:
    """Returns the form in which a method, constructor or operator is compared: without modifiers, names of parameters
    and names of type parameters."""
    head = " ".join(re.sub(MODIFIERS, "", head).split())
    types = []
    for parameter in split(parameters):
        words = parameter.split("=")[0].split()
        types.append(" ".join(word for word in words[:-1] if word != "params"))
    whole = f"{head}({', '.join(types)})".replace("real_t", "float").replace("Collections.", "").replace("?", "")
    generic = re.search(r"<([^<>]*)>\(", whole)
    for number, name in enumerate(split(generic.group(1)) if generic else []):
        whole = re.sub(rf"\b{name}\b", f"type{number}", whole)
    return whole


def signatures(text: str) -> set[str]:
    found = re.findall(r"\bpublic\s+([^;{}=()\[\]]*(?:\[\])?[^;{}=()\[\]]*)\(([^()]*)\)", text)
    return {signature(head, parameters) for head, parameters in found}


def members(text: str) -> set[str]:
    """Returns the names of fields and properties."""
    found = re.findall(r"\bpublic\s+[\w<>\[\]?. ]+?\s+(\w+(?:, \w+)*)\s*(?:;|=|\{)", text)
    return {name for names in found for name in names.split(", ")}


def types_of_the_stub() -> dict[str, str]:
    """Returns the declarations inside of each public type of the stub."""
    text = without_comments(STUB.read_text(encoding="utf-8"))
    parts = re.split(r"\bpublic\s+(?:sealed\s+|static\s+)*(?:class|struct|enum|interface)\s+(\w+)", text)
    found: dict[str, str] = {}
    for name, body in zip(parts[1::2], parts[2::2], strict=True):
        found[name] = found.get(name, "") + body
    return found


def handwritten(name: str) -> str:
    """Returns the sources of a type in GodotSharp."""
    paths: list[Path] = sorted({*GODOT_SHARP.rglob(f"{name}.cs"), *GODOT_SHARP.rglob(f"{name}.*.cs")})
    assert paths, f"GodotSharp has no source for {name}"
    return without_comments("\n".join(path.read_text(encoding="utf-8-sig") for path in paths))


HANDWRITTEN = sorted(set(types_of_the_stub()) - GENERATED)


@pytest.mark.full
@pytest.mark.parametrize("name", HANDWRITTEN)
def test_godot_sharp_has_what_the_stub_declares(name):
    if not GODOT_SHARP.is_dir():
        pytest.skip(f"{GODOT_SHARP} does not exist: setup_godot_sources in tools/setup_full.sh downloads it")
    declared = signatures(types_of_the_stub()[name])
    if name == "GodotObject":
        declared = {one for one in declared if re.split(r"[<(]", one)[0].split()[-1] not in GENERATED_MEMBERS}
    assert declared - signatures(handwritten(name)) == set()
    assert members(types_of_the_stub()[name]) - members(handwritten(name)) == set()


def test_signatures_are_compared_without_names():
    text = "public static unsafe Callable From<[MustBeVariant] T0>(\n Action<T0> action\n) {} public Vector2(real_t x, real_t y = 1) {}"
    assert signatures(without_comments(text)) == {"Callable From<type0>(Action<type0>)", "Vector2(float, float)"}
    assert signatures("public Vector2(float x) {}") - signatures(without_comments(text))
    assert members("public float X, Y; public static Vector3 Zero => default; public int Count { get; }") == {"X", "Y", "Zero", "Count"}
