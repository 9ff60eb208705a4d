#!/usr/bin/env python3
"""Compares the bindings' description of the engine with the descriptions of later engines (extension_api.json).

    check.py NEWER...

Prints a sentence for each item that the bindings need and that a later engine removed or changed. Fails if there are any.
Additions in later engines are ignored.
"""

import argparse
import pathlib
import sys
import tomllib

import api as dump
from describe import OLDEST

HERE = pathlib.Path(__file__).resolve().parent


def signature(method):
    """Returns the return type and the argument types of a method, as text."""
    types = [argument["type"] for argument in method.get("arguments", [])]
    return "%s(%s)" % (dump.return_type(method) or "void", ", ".join(types))


def method(owner, old, new):
    """Compares a method. The engine finds a method by its hash, and may keep the old version of a changed method under the old hash.
    It looks up virtual methods only by the new hash."""
    name = "%s.%s()" % (owner, old["name"])
    if old["hash"] != new.get("hash"):
        if old["is_static"] != new["is_static"] or old.get("is_virtual", False) != new.get("is_virtual", False):
            yield "%s is a different kind of method" % name
        elif old.get("is_virtual") or old["hash"] not in new.get("hash_compatibility", []):
            yield "%s has the hash %s, and %d is no longer known" % (name, new.get("hash"), old["hash"])
        return
    for flag in ("is_static", "is_virtual", "is_vararg", "is_const"):
        if old.get(flag, False) != new.get(flag, False):
            yield "%s: %s is %s" % (name, flag, new.get(flag, False))
    if signature(old) != signature(new):
        yield "%s is %s and was %s" % (name, signature(new), signature(old))


def values(owner, old, new):
    """Compares constants, or the values of an enumeration."""
    new_items = dump.by_name(new)
    for item in old:
        value = new_items.get(item["name"], {"value": "gone"})["value"]
        if value != item["value"]:
            yield "%s.%s is %s and was %s" % (owner, item["name"], value, item["value"])


def enums(owner, old, new):
    for name, enum in dump.by_name(old).items():
        yield from values(owner + name, enum["values"], dump.by_name(new).get(name, {"values": []})["values"])


def methods(owner, old, new):
    new_items = dump.by_name(new)
    for item in old:
        if item["name"] in new_items:
            yield from method(owner, item, new_items[item["name"]])
        else:
            yield "%s.%s() is gone" % (owner, item["name"])


def builtin(name, old, new):
    """Compares a builtin type. Its constructors are identified by their index."""
    for key in ("has_destructor", "indexing_return_type"):
        if key in old and old[key] != new.get(key):
            yield "%s: %s is %s and was %s" % (name, key, new.get(key), old[key])
    constructors = {item["index"]: signature(item) for item in new.get("constructors", [])}
    for item in old.get("constructors", []):
        if constructors.get(item["index"]) != signature(item):
            yield "%s: constructor %d was %s" % (name, item["index"], signature(item))
    operators = {(item["name"], item.get("right_type")): item["return_type"] for item in new.get("operators", [])}
    for item in old.get("operators", []):
        if operators.get((item["name"], item.get("right_type"))) != item["return_type"]:
            yield "%s: operator %s %s was %s" % (name, item["name"], item.get("right_type", ""), item["return_type"])
    yield from methods(name, old.get("methods", []), new.get("methods", []))


def ancestors(api, name):
    while name in api.classes:
        name = api.classes[name].get("inherits")
        yield name


def engine_class(old, new, name):
    """Compares a class. New classes between it and its parent do not count as a difference."""
    old_class, new_class = old.classes[name], new.classes[name]
    if "inherits" in old_class and old_class["inherits"] not in ancestors(new, name):
        yield "%s no longer inherits %s" % (name, old_class["inherits"])
    if old_class["is_refcounted"] != new_class["is_refcounted"]:
        yield "%s: is_refcounted is %s" % (name, new_class["is_refcounted"])
    yield from values(name, old_class.get("constants", []), new_class.get("constants", []))
    yield from enums(name + ".", old_class.get("enums", []), new_class.get("enums", []))
    yield from methods(name, old_class.get("methods", []), new_class.get("methods", []))


def newer_values(new, newer):
    """Compares the values that used_api.toml lists as numbers. An engine without such a value must not use its number for another value."""
    for owner, expected in newer.items():
        for name, numbers in expected.items():
            enum = dump.by_name(new.classes[owner]["enums"])[name]["values"]
            for value in enum:
                expected_number = numbers.get(value["name"], value["value"])
                is_taken = value["value"] in numbers.values() and value["name"] not in numbers
                if value["value"] != expected_number or (is_taken and not value["name"].endswith("_MAX")):
                    yield "%s.%s.%s is %d, which [newer] does not have" % (owner, name, value["name"], value["value"])


def differences(old, new, newer):
    """Yields a sentence for each item that the bindings need and that is different in a later engine."""
    for name, sizes in old.sizes.items():
        if new.sizes.get(name) != sizes:
            yield "%s takes %s bytes (%s) and took %s" % (name, new.sizes.get(name), ", ".join(dump.BUILDS), sizes)
    yield from enums("", old.enums.values(), new.enums.values())
    for name, old_type in old.builtins.items():
        yield from builtin(name, old_type, new.builtins[name]) if name in new.builtins else ["%s is gone" % name]
    for name in old.classes:
        yield from engine_class(old, new, name) if name in new.classes else ["%s is gone" % name]
    for name in sorted(old.singletons - new.singletons):
        yield "%s is no longer a singleton" % name
    yield from newer_values(new, newer)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("newer", nargs="+", help="extension_api.json of a later engine")
    parser.add_argument("--api", default=HERE / OLDEST, help="the description from describe.py")
    parser.add_argument("--used", type=pathlib.Path, default=HERE / "used_api.toml")
    options = parser.parse_args()
    old = dump.Api(dump.load(options.api))
    newer = tomllib.loads(options.used.read_text(encoding="utf-8")).get("newer", {})
    has_differences = False
    for path in options.newer:
        new = dump.Api(dump.load(path))
        for sentence in differences(old, new, newer):
            print("Godot %s: %s" % (new.release, sentence))
            has_differences = True
    return 1 if has_differences else 0


if __name__ == "__main__":
    sys.exit(main())
