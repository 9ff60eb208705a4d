#!/usr/bin/env python3
"""Extracts the part of an engine description that our stand-in for godot-cpp needs, without the documentation texts.

    describe.py --api extension_api.json

The description must be that of the oldest supported engine, so that the generated code runs in all later engines. check.py compares it
with their descriptions. The output contains all items of used_api.toml, and all types that these items mention. Each method,
enumeration and class has its own line, for readable diffs.
"""

import argparse
import json
import pathlib
import tomllib

import api as dump
import emit

HERE = pathlib.Path(__file__).resolve().parent
OLDEST = "description_4.4.json"

# Documentation texts, and keys that matter only in descriptions of later engines.
OMITTED_KEYS = {"description", "brief_description", "category", "is_required", "hash_compatibility"}
# Keys of lists that are written with one entry per line.
MULTILINE_KEYS = set(
    "builtin_class_sizes global_enums builtin_classes constructors operators methods classes constants enums singletons".split()
)


def without_texts(item):
    """Returns an item without its texts and without enumeration values that are counts, such as FORMAT_MAX, which grow in later engines."""
    if isinstance(item, list):
        return [without_texts(entry) for entry in item if not (isinstance(entry, dict) and entry.get("name", "").endswith("_MAX"))]
    if isinstance(item, dict):
        return {key: without_texts(value) for key, value in item.items() if key not in OMITTED_KEYS}
    return item


def subset(item, keys, **lists):
    """Returns a copy of an item that has only these keys, if they exist, and the entries of `lists` that are not empty."""
    return {key: item[key] for key in keys if key in item} | {key: without_texts(entries) for key, entries in lists.items() if entries}


def builtin(api, name, entry):
    """Returns the used part of a type that the engine constructs and destroys, including the parts that Opaque uses for all such types."""
    type_item = api.pick(api.builtins, name, "builtins")
    constructor_types = [tuple(types) for types in entry.get("constructors", [])]
    signatures = {tuple(a["type"] for a in item.get("arguments", [])): item for item in type_item["constructors"]}
    constructors = {(): None, (name,): None} | dict.fromkeys(constructor_types)
    operators = {(item["name"], item.get("right_type")): item for item in type_item["operators"]}
    operator_keys = {("==", name): None} | dict.fromkeys(map(tuple, entry.get("operators", [])))
    return subset(type_item, ["name", "has_destructor", "indexing_return_type"],
        constructors=[api.pick(signatures, types, name) for types in constructors],
        operators=[api.pick(operators, key, name) for key in operator_keys],
        methods=[api.pick(type_item["methods"], method, name) for method in entry.get("methods", [])])  # fmt: skip


def engine_class(api, name, entry):
    """Returns the used part of a class, with the enumerations of the class that the used methods mention."""
    class_item = api.pick(api.classes, name, "classes")
    methods = [api.pick(class_item.get("methods", []), method, name) for method in entry.get("methods", [])]
    enums = [enum for owner, enum in api.enums_of(methods) if owner == name]
    return subset(class_item, ["name", "inherits", "is_refcounted"],
        constants=[api.pick(class_item.get("constants", []), constant, name) for constant in entry.get("constants", [])],
        enums=[api.pick(class_item["enums"], enum, name) for enum in enums],
        methods=methods)  # fmt: skip


def used_part(description, used):
    """Returns the part of a description that used_api.toml lists."""
    api = dump.Api(description)
    builtins = [builtin(api, name, entry) for name, entry in used["builtins"].items()]
    builtins += [subset(api.pick(api.builtins, name, "values"), ["name"]) for name in used["global"]["values"]]
    classes = [engine_class(api, name, entry) for name, entry in used["classes"].items()]
    mentioned_classes = sorted(set(api.classes_of([method for item in classes for method in item.get("methods", [])])))
    classes += [subset(api.classes[name], ["name", "is_refcounted"]) for name in mentioned_classes if name not in used["classes"]]
    sized = {item["name"] for item in builtins} | {"Variant"}
    return {
        "header": description["header"],
        "builtin_class_sizes": [
            item | {"sizes": [size for size in item["sizes"] if size["name"] in sized]}
            for item in description["builtin_class_sizes"]
        ],
        "global_enums": without_texts([api.pick(api.enums, name, "global.enums") for name in used["global"]["enums"]]),
        "builtin_classes": builtins,
        "classes": classes,
        "singletons": [item for item in description["singletons"] if item["type"] in used["classes"]],
    }


def text(value, key="", depth=0):
    """Returns the value as JSON. Lists whose key is in MULTILINE_KEYS have one entry per line."""
    if isinstance(value, dict) and (depth == 0 or any(name in MULTILINE_KEYS for name in value)):
        entries = ["%s: %s" % (json.dumps(name), text(item, name, depth + 1)) for name, item in value.items()]
        return "{%s}" % (",\n" if depth == 0 else ", ").join(entries)
    if key in MULTILINE_KEYS:
        return "[\n%s\n]" % ",\n".join(text(item, "", depth + 1) for item in value)
    return json.dumps(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--api", required=True, help="extension_api.json of the oldest supported engine")
    parser.add_argument("--used", type=pathlib.Path, default=HERE / "used_api.toml", help="the API to describe")
    parser.add_argument("--out", type=pathlib.Path, default=HERE / OLDEST, help="description_<version>.json")
    options = parser.parse_args()
    used = tomllib.loads(options.used.read_text(encoding="utf-8"))
    description = used_part(dump.load(options.api), used)
    release = dump.Api(description).release
    if options.out.name != "description_%s.json" % release:
        raise SystemExit("describe.py: %s is of Godot %s, and %s is not" % (options.api, release, options.out.name))
    # Reports errors that otherwise only the generator would report.
    emit.builtins(dump.Api(description), used)
    emit.classes(dump.Api(description), used)
    options.out.write_text(text(description) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
