"""Reads a description of the engine (Godot's own dump or description_4.4.json) and translates it to C++."""

import json
import re

ENUM = re.compile(r"^enum::(?:(\w+)\.)?(\w+)$")

# Default values as written in the dump, and their C++ equivalents.
IDENTITIES = {
    "Transform3D(1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)": "Transform3D()",
    'NodePath("")': "NodePath()",
    '&""': "StringName()",
    '""': "String()",
    "[]": "Array()",
    "{}": "Dictionary()",
}

OPERATORS = {"+": "ADD", "%": "MODULE"}

# Handwritten structs without a destructor. (RID has no destructor, either, but is a class.)
STRUCTS = frozenset("Vector2 Vector2i Vector3 Rect2 Rect2i AABB Basis Transform3D Color".split())

# The build configurations of the engine, in the order of the arguments of in_build() in defs.hpp.
BUILDS = ("float_32", "float_64", "double_32", "double_64")

PACKED_ELEMENTS = {"Byte": "uint8_t", "Int32": "int32_t", "Int64": "int64_t", "Float32": "float", "Float64": "double"}


def snake(name):
    """Returns godot-cpp's file name for a class: node3d for Node3D, multi_mesh_instance3d for MultiMeshInstance3D."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    name = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name)
    return name.replace("2_D", "2D").replace("3_D", "3D").lower()


def upper(name):
    """Returns Godot's constant for a Variant type: PACKED_BYTE_ARRAY for PackedByteArray, AABB for AABB."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z][a-z])|(?<=[a-z])(?=[A-Z])", "_", name).upper()


def packed_element(name):
    """Returns the element type of a packed array, such as Vector2 for PackedVector2Array, or None for other types."""
    match = re.match(r"^Packed(\w+)Array$", name)
    return PACKED_ELEMENTS.get(match.group(1), match.group(1)) if match else None


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def by_name(items):
    return {item["name"]: item for item in items}


class Api:
    """Looks up items of a description, for all build configurations of the engine. If an item is missing, the program ends with a
    message that includes `remedy`."""

    def __init__(self, description, remedy=""):
        header = description["header"]
        self.release = "%d.%d" % (header["version_major"], header["version_minor"])
        self.source_name = "the description of %s%s" % (header["version_full_name"], remedy)
        self.classes = by_name(description["classes"])
        self.builtins = by_name(description["builtin_classes"])
        self.enums = by_name(description["global_enums"])
        self.singletons = {item["type"] for item in description["singletons"]}
        configurations = {item["build_configuration"]: item["sizes"] for item in description["builtin_class_sizes"]}
        tables = [by_name(configurations[build]) for build in BUILDS]
        self.sizes = {name: [table[name]["size"] for table in tables] for name in tables[0]}

    def pick(self, items, name, owner):
        """Returns the item with a name from a dictionary or a list. A missing item is an error in used_api.toml and ends the program."""
        items = items if isinstance(items, dict) else by_name(items)
        if name not in items:
            raise SystemExit("used_api.toml: %s has no '%s' in %s" % (owner, name, self.source_name))
        return items[name]

    def hash(self, owner, method, double_hashes):
        """Returns a method's hash as a C++ expression. The hash covers the bytes of default values. If one of them contains reals, the
        hash is different in double-precision engines, and the description of a single-precision engine does not contain it."""
        double = double_hashes.get(method["name"])
        if double is not None:
            return "sizeof(real_t) == 4 ? %d : %d" % (method["hash"], double)
        for argument in method.get("arguments", []):
            if "default_value" in argument and self.has_reals(argument["type"]):
                raise SystemExit(
                    "used_api.toml: %s.%s has a default value with reals, so its hash is different in double-precision"
                    " engines. Add that hash to double_hashes" % (owner, method["name"])
                )
        return "%d" % method["hash"]

    def has_reals(self, type_name):
        """Returns True if values of the type contain the engine's reals, and the values are therefore larger in double-precision engines."""
        single, double = self.sizes.get(type_name, [0] * 4)[1::2]
        return type_name == "float" or (type_name != "Variant" and single != double)

    def cpp_type(self, type_name, meta=""):
        """Returns the C++ type for values of a type in the dump."""
        enum = ENUM.match(type_name)
        if enum:
            return "%s::%s" % enum.groups() if enum.group(1) else enum.group(2)
        if type_name.startswith("typedarray::"):
            return "TypedArray<%s>" % type_name[len("typedarray::") :]
        if type_name == "int":
            return meta + "_t" if meta else "int64_t"
        if type_name == "float":
            return meta or "double"
        if type_name in self.classes:
            return ("Ref<%s>" if self.classes[type_name]["is_refcounted"] else "%s *") % type_name
        if type_name in ("bool", "Variant") or type_name in self.builtins:
            return type_name
        raise SystemExit("used_api.toml: the type '%s' is not in %s" % (type_name, self.source_name))

    def parameter_type(self, argument):
        """Returns the type of a parameter. Small values are passed by value, and all others by const reference."""
        cpp = self.cpp_type(argument["type"], argument.get("meta", ""))
        by_value = argument["type"] in ("int", "float", "bool") or ENUM.match(argument["type"]) or cpp.endswith("*")
        return cpp + ("" if cpp.endswith("*") else " ") if by_value else "const %s &" % cpp

    def parameters(self, method, defaults):
        """Returns the parameter list of a method. `defaults` adds the default values, for declarations."""
        return ", ".join(
            self.parameter_type(argument)
            + "p_"
            + argument["name"]
            + (" = " + self.default(argument) if defaults and "default_value" in argument else "")
            for argument in method.get("arguments", [])
        )

    def default(self, argument):
        """Converts a default value in the dump to a C++ expression."""
        value, cpp = argument["default_value"], self.cpp_type(argument["type"], argument.get("meta", ""))
        if ENUM.match(argument["type"]):
            return "static_cast<%s>(%s)" % (cpp, value)
        if value == "null":
            return "nullptr" if cpp.endswith("*") else cpp + "()"
        if cpp.startswith("TypedArray"):
            return cpp + "()"
        return IDENTITIES.get(value, value)

    def enums_of(self, items):
        """Returns (class or "", enum) for every enumeration that the methods mention, in order and without duplicates."""
        enums = {}
        for item in items:
            types = [argument["type"] for argument in item.get("arguments", [])] + [return_type(item)]
            for match in filter(None, map(ENUM.match, types)):
                enums[match.group(1) or "", match.group(2)] = None
        return list(enums)

    def classes_of(self, items):
        """Returns the sorted names of all classes that the methods mention as argument or return types."""
        types = {argument["type"] for item in items for argument in item.get("arguments", [])}
        types.update(return_type(item) for item in items)
        return sorted(name.removeprefix("typedarray::") for name in types if name.split("::")[-1] in self.classes)


def return_type(method):
    """Returns the return type of a method of a class or a builtin type, or "" if it returns nothing."""
    return method.get("return_value", {}).get("type") or method.get("return_type") or ""


def return_meta(method):
    return method.get("return_value", {}).get("meta", "")
