"""Converts Godot's names of types and members to C#, and descriptions to plain text."""

from __future__ import annotations

import re

# The Variant types, with their C# names. Any other type name in the class reference is a class, a typed array or a typed
# dictionary.
VALUES = {
    "void": "void",
    "bool": "bool",
    "int": "long",
    "float": "double",
    "String": "string",
    "StringName": "StringName",
    "NodePath": "NodePath",
    "Variant": "Variant",
    "Callable": "Callable",
    "Signal": "Signal",
    "RID": "Rid",
    "Array": "Godot.Collections.Array",
    "Dictionary": "Godot.Collections.Dictionary",
    "Vector2": "Vector2",
    "Vector2i": "Vector2I",
    "Vector3": "Vector3",
    "Vector3i": "Vector3I",
    "Vector4": "Vector4",
    "Vector4i": "Vector4I",
    "Rect2": "Rect2",
    "Rect2i": "Rect2I",
    "Color": "Color",
    "Plane": "Plane",
    "Quaternion": "Quaternion",
    "AABB": "Aabb",
    "Basis": "Basis",
    "Transform2D": "Transform2D",
    "Transform3D": "Transform3D",
    "Projection": "Projection",
    "PackedByteArray": "byte[]",
    "PackedInt32Array": "int[]",
    "PackedInt64Array": "long[]",
    "PackedFloat32Array": "float[]",
    "PackedFloat64Array": "double[]",
    "PackedStringArray": "string[]",
    "PackedVector2Array": "Vector2[]",
    "PackedVector3Array": "Vector3[]",
    "PackedColorArray": "Color[]",
}
STRUCTS = {name for name in VALUES.values() if re.match("(Vector|Rect|Color$|Plane|Quaternion|Aabb|Basis|Transform|Proj)", name)}

KEYWORDS = set(
    "abstract as base bool break byte case catch char checked class const continue decimal default delegate do double else "
    "enum event explicit extern false finally fixed float for foreach goto if implicit in int interface internal is lock "
    "long namespace new null object operator out override params private protected public readonly ref return sbyte sealed "
    "short sizeof stackalloc static string struct switch this throw true try typeof uint ulong unchecked unsafe ushort using "
    "virtual void volatile while".split()
)


def pascal(name: str) -> str:
    """Converts max_slope_degrees to MaxSlopeDegrees, and COLLISION_BOX to CollisionBox."""
    return "".join(word[:1].upper() + word[1:].lower() for word in name.strip("_").split("_"))


def camel(name: str) -> str:
    word = pascal(name)
    word = word[:1].lower() + word[1:]
    return "@" + word if word in KEYWORDS else word


def members_of_enum(names: list[str]) -> dict[str, str]:
    """Maps the names of an enum's values to C# names. Omits the words that all names have in common at the start."""
    words = [name.split("_") for name in names]
    shared_count = 0
    while len(words) > 1 and all(len(parts) > shared_count + 1 and parts[shared_count] == words[0][shared_count] for parts in words):
        shared_count += 1
    while shared_count > 0 and any(parts[shared_count][:1].isdigit() for parts in words):  # A name cannot begin with a digit.
        shared_count -= 1
    return {name: pascal("_".join(parts[shared_count:])) for name, parts in zip(names, words, strict=True)}


def plain(text: str) -> str:
    """Removes the markup and the examples, which are in GDScript, from a description."""
    text = re.sub(r"\[(codeblocks?|gdscript|csharp)[^]]*\].*?\[/\1\]", "", text, flags=re.DOTALL)
    text = re.sub(r"\[(?:member|method|signal|constant|enum|param|theme_item|annotation) ([^]]+)\]", r"\1", text)
    text = re.sub(r"\[([A-Z]\w*)\]", r"\1", text)
    text = re.sub(r"\[/?(?:b|i|code|kbd|br|url[^]]*)\]", "", text)
    return " ".join(text.split())
