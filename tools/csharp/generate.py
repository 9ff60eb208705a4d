"""Generates C# wrappers for the classes of the extension from its class reference (extension/doc_classes/*.xml).

In C#, an object of an extension class has the type of its engine base class: a ScatterLayer is a Resource. A wrapper holds such
an object and accesses its properties, methods and signals by name. The wrapper's members are typed, have PascalCase names, and
are documented with the text of the class reference. The build runs this script and puts the files into the add-on.

    python3 tools/csharp/generate.py --out FOLDER PAGE.xml...     writes the files and removes outdated ones
    python3 tools/csharp/generate.py --list PAGE.xml...           only prints their names"""

from __future__ import annotations

import argparse
import re
import textwrap
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import escape

from types_of_godot import STRUCTS, VALUES, camel, members_of_enum, pascal, plain

BASE = "ThicketObject"
WRITTEN_BY = "// Written by tools/csharp/generate.py"
NOTE = f"{WRITTEN_BY} from the class reference. The next build overwrites all changes.\n"
Element = ElementTree.Element


class Reference:
    """Reads all pages of the class reference, except those of deprecated classes, which have no wrapper."""

    def __init__(self, pages: list[Path]):
        roots = [root for root in (ElementTree.parse(page).getroot() for page in pages) if root.get("deprecated") is None]
        self.classes = {root.get("name"): root for root in sorted(roots, key=lambda root: root.get("name"))}

    def parent(self, name: str) -> str | None:
        """Returns the parent class if it has a wrapper, otherwise None."""
        parent = self.classes[name].get("inherits")
        return parent if parent in self.classes else None

    def engine_base(self, name: str) -> str:
        """Returns the closest engine base class, which is the type of the object in C#."""
        while name in self.classes:
            name = self.classes[name].get("inherits")
        return "GodotObject" if name == "Object" else name

    def enum(self, name: str, owner: str) -> str:
        """Returns an enum's qualified name. In C#, an enum with the same name as a property gets the suffix Enum."""
        owner, _, short = name.rpartition(".") if "." in name else (owner, ".", name)
        if owner in self.classes:
            member_names = {pascal(member.get("name")) for member in self.classes[owner].iter("member")}
            short += "Enum" if short in member_names else ""
            return f"{owner}.{short}"
        return short if not owner or name == "Error" else f"{owner}.{short}"

    def type(self, element: Element, owner: str) -> str:
        """Returns the C# type of a property, a parameter or a return value."""
        type_name = element.get("type")
        if element.get("enum"):
            enum = element.get("enum")
            return "Error" if enum == "Error" else self.enum(enum, owner)
        if type_name in VALUES:
            return VALUES[type_name]
        if type_name.endswith("[]"):
            inner = VALUES.get(type_name[:-2], type_name[:-2])
            return f"{inner}[]" if inner in self.classes else f"Godot.Collections.Array<{inner}>"
        if type_name.startswith("Dictionary["):
            return VALUES["Dictionary"]
        return "GodotObject" if type_name == "Object" else type_name

    def from_variant(self, value: str, type_: str) -> str:
        """Returns an expression that converts a Variant to this type."""
        if type_ == "Variant":
            return value
        if type_ in self.classes:
            return f"{type_}.Wrap({value}.As<GodotObject>())"
        if type_.removesuffix("[]") in self.classes:
            return f"Unwrapped({value}, {type_.removesuffix('[]')}.Wrap)"
        return f"{value}.As<{type_}>()"

    def to_variant(self, value: str, type_: str) -> str:
        """Returns an expression that converts a value of this type to a Variant. C# has no implicit conversion for some
        types."""
        if type_.removesuffix("[]") in self.classes and type_.endswith("[]"):
            return f"Wrapped({value})"
        if "." in type_ and type_ not in VALUES.values() or type_ == "Error":
            return f"Variant.From({value})"
        return value


def summary(text: str | None, indent: str = "\t") -> str:
    text = plain(text or "")
    if not text:
        return ""
    lines = textwrap.wrap(escape(text), 110, break_long_words=False, break_on_hyphens=False)
    return "".join(f"{indent}/// {line}\n" for line in ["<summary>", *lines, "</summary>"])


def parameter(reference: Reference, element: Element, owner: str) -> tuple[str, str]:
    """Returns a parameter's declaration and the expression that converts it to a Variant."""
    name, type_, default = camel(element.get("name")), reference.type(element, owner), element.get("default")
    variant = reference.to_variant(name, type_)
    if default is None:
        return f"{type_} {name}", variant
    if type_ in ("bool", "long", "double"):
        return f"{type_} {name} = {default}", variant
    if type_ == "string":
        return f"string {name} = {default}", variant
    if type_ in ("StringName", "NodePath"):
        return f"{type_} {name} = null", f'{name} ?? ""'
    if type_.endswith("[]") and default.endswith(("()", "[]")):
        empty = type_.replace("[]", "[0]")
        return f"{type_} {name} = null", reference.to_variant(f"{name} ?? new {empty}", type_)
    if type_.startswith("Godot.Collections."):
        return f"{type_} {name} = null", reference.to_variant(f"{name} ?? new {type_}()", type_)
    if type_ in STRUCTS:
        numbers = re.findall(r"-?\d+(?:\.\d+)?", default.partition("(")[2])
        value = ", ".join(number + ("f" if "." in number else "") for number in numbers)
        return f"{type_}? {name} = null", f"{name} ?? new {type_}({value})"
    if reference.enum(element.get("enum") or "", owner) == type_:
        return f"{type_} {name} = ({type_}){default}", variant
    return f"{type_} {name} = default", variant  # Callable(), null and RID() are all empty values.


def joined(texts: list[str], glue: str) -> str:
    return glue.join(text for text in texts if text)


def names(kind: str, elements: list[Element], hides: bool) -> str:
    """Returns a nested class of StringNames, as in the engine's C# classes."""
    if not elements:
        return ""
    header = f"\tpublic {'new ' if hides else ''}static class {kind}\n\t{{\n"
    lines = [f'\t\tpublic static readonly StringName {pascal(element.get("name"))} = "{element.get("name")}";\n' for element in elements]
    return header + "".join(lines) + "\t}\n"


def enums(reference: Reference, root: Element, owner: str) -> str:
    constants_by_enum: dict[str, list[Element]] = {}
    for constant in root.iter("constant"):
        constants_by_enum.setdefault(constant.get("enum"), []).append(constant)
    parts = []
    for enum, constants in constants_by_enum.items():
        if enum is None:
            parts += [f"\tpublic const long {pascal(constant.get('name'))} = {constant.get('value')};\n" for constant in constants]
            continue
        members = members_of_enum([constant.get("name") for constant in constants])
        lines = [
            summary(constant.text, "\t\t") + f"\t\t{members[constant.get('name')]} = {constant.get('value')},\n" for constant in constants
        ]
        short = reference.enum(enum, owner).rpartition(".")[2]
        parts.append(f"\tpublic enum {short} : long\n\t{{\n{''.join(lines)}\t}}\n")
    return joined(parts, "\n")


def property_(reference: Reference, element: Element, owner: str) -> str:
    type_, name = reference.type(element, owner), pascal(element.get("name"))
    get = reference.from_variant(f"Object.Get(PropertyName.{name})", type_)
    lines = [f"\t\tget => {get};"]
    if element.get("setter"):
        lines.append(f"\t\tset => Object.Set(PropertyName.{name}, {reference.to_variant('value', type_)});")
    body = "\n".join(lines)
    return f"{summary(element.text)}\tpublic {type_} {name}\n\t{{\n{body}\n\t}}\n"


def method(reference: Reference, element: Element, owner: str) -> str:
    name = pascal(element.get("name"))
    type_ = reference.type(element.find("return"), owner)
    parameters = [parameter(reference, parameter_element, owner) for parameter_element in element.findall("param")]
    call = f"Object.Call({', '.join([f'MethodName.{name}', *(value for _, value in parameters)])})"
    body = call if type_ == "void" else reference.from_variant(call, type_)
    declarations = ", ".join(declaration for declaration, _ in parameters)
    return f"{summary(element.findtext('description'))}\tpublic {type_} {name}({declarations}) => {body};\n"


def signal(reference: Reference, element: Element, owner: str) -> str:
    """Returns an event for a signal. The event connects the handler directly, or a function that first wraps the
    signal's arguments."""
    name = pascal(element.get("name"))
    types = [reference.type(type_, owner) for type_ in element.findall("param")]
    handler = f"Action<{', '.join(types)}>" if types else "Action"
    engine_types = [reference.engine_base(type_) if type_ in reference.classes else type_ for type_ in types]
    callable_ = "Callable.From(value)"
    if engine_types != types:
        declarations = ", ".join(f"{type_} a{index}" for index, type_ in enumerate(engine_types))
        arguments = ", ".join(
            f"{type_}.Wrap(a{index})" if type_ in reference.classes else f"a{index}" for index, type_ in enumerate(types)
        )
        callable_ = f"Callable.From(({declarations}) => value({arguments}))"
    return (
        f"{summary(element.findtext('description'))}\tpublic event {handler} {name}\n\t{{\n"
        f"\t\tadd => AddHandler(SignalName.{name}, value, {callable_});\n"
        f"\t\tremove => RemoveHandler(SignalName.{name}, value);\n\t}}\n"
    )


def head(reference: Reference, name: str) -> str:
    """Returns the start of a wrapper: its name, its constructors, and the conversions from and to the engine object."""
    parent, engine = reference.parent(name), reference.engine_base(name)
    hides = "new " if parent else ""
    parts = [
        f'\tpublic {hides}static readonly StringName NativeName = "{name}";\n',
        f"\t/// <summary>Creates a new {name}.</summary>\n\tpublic {name}() : base(Made(NativeName), NativeName) {{ }}\n",
        f"\t/// <summary>Wraps an object that is a {name}; throws for any other object.</summary>\n"
        f"\tpublic {name}(GodotObject instance) : base(instance, NativeName) {{ }}\n",
        f"\tprotected {name}(GodotObject instance, StringName nativeName) : base(instance, nativeName) {{ }}\n",
        f"\t/// <summary>Like the constructor, but returns null for null.</summary>\n"
        f"\tpublic static {hides}{name} Wrap(GodotObject instance) => instance == null ? null : new {name}(instance);\n",
    ]
    if not parent:
        parts += [
            f"\t/// <summary>The wrapped object, as its engine class.</summary>\n\tpublic {engine} Instance => ({engine})Object;\n",
            f"\tpublic static implicit operator {engine}({name} wrapper) => wrapper?.Instance;\n" if engine != "GodotObject" else "",
        ]
    return joined(parts, "\n")


def inherits_any(reference: Reference, name: str, tag: str) -> bool:
    parent = reference.parent(name)
    return parent is not None and (
        reference.classes[parent].find(f".//{tag}") is not None or inherits_any(reference, parent, tag)
    )


def wrapper(reference: Reference, name: str) -> str:
    """Returns the content of the file for one class."""
    root = reference.classes[name]
    members = [element for element in root.iter("member") if not element.get("overrides")]
    methods = [element for element in root.iter("method") if "virtual" not in (element.get("qualifiers") or "")]
    signals = list(root.iter("signal"))
    parts = [
        head(reference, name),
        enums(reference, root, name),
        joined([property_(reference, element, name) for element in members], "\n"),
        joined([method(reference, element, name) for element in methods], "\n"),
        joined([signal(reference, element, name) for element in signals], "\n"),
        names("PropertyName", members, inherits_any(reference, name, "member")),
        names("MethodName", methods, inherits_any(reference, name, "method")),
        names("SignalName", signals, inherits_any(reference, name, "signal")),
    ]
    documentation = summary(root.findtext("brief_description"), "")
    base = reference.parent(name) or BASE
    return f"{NOTE}using System;\nusing Godot;\n\nnamespace Thicket\n{{\n" + textwrap.indent(
        f"{documentation}public partial class {name} : {base}\n{{\n{joined(parts, chr(10))}}}\n", "\t"
    ) + "}\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="the folder to write into")
    parser.add_argument("--list", action="store_true", help="print the names of the files and write nothing")
    parser.add_argument("pages", nargs="+", type=Path, help="pages of the class reference")
    options = parser.parse_args()
    reference = Reference(options.pages)
    files = {f"{name}.cs": lambda name=name: wrapper(reference, name) for name in reference.classes}
    files[f"{BASE}.cs"] = lambda: NOTE + (Path(__file__).parent / f"{BASE}.cs.in").read_text(encoding="utf-8")
    if options.list:
        print("\n".join(files))
        return
    options.out.mkdir(parents=True, exist_ok=True)
    for existing in options.out.glob("*.cs"):
        if existing.name not in files and existing.read_text(encoding="utf-8").startswith(WRITTEN_BY):
            existing.unlink()
    for file, text in files.items():
        (options.out / file).write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
