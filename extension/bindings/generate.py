#!/usr/bin/env python3
"""Generates the part of our stand-in for godot-cpp that depends on the engine description.

    generate.py --api description_4.4.json --interface gdextension_interface.h --used used_api.toml --out DIR
    generate.py --used used_api.toml --out DIR --list
    generate.py --used used_api.toml --unused SOURCES...

The first command writes headers to DIR/include and sources to DIR/src, and does not touch files whose text is unchanged. --list only
prints the paths of these files. --unused prints the entries that no source contains, and fails if there are any.
"""

import argparse
import pathlib
import re
import sys
import tomllib

import api as dump
import emit

HERE = pathlib.Path(__file__).resolve().parent
REMEDY = "; if that Godot has it, run python3 extension/bindings/describe.py --api ITS_EXTENSION_API.json (see README.md there)"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--used", type=pathlib.Path, required=True, help="the classes and methods to generate")
    parser.add_argument("--api", help="a description from describe.py, or extension_api.json")
    parser.add_argument("--interface", type=pathlib.Path, help="gdextension_interface.h, as Godot dumps it")
    parser.add_argument("--out", type=pathlib.Path, help="folder for include/ and src/")
    parser.add_argument("--list", action="store_true", help="print the paths of the files")
    parser.add_argument("--unused", nargs="+", type=pathlib.Path, metavar="SOURCES", help="find unused entries")
    return parser.parse_args()


def outputs(used):
    """Returns the paths of all generated files, relative to DIR. They depend only on used_api.toml, so a build can determine them early."""
    paths = ["include/gdextension_interface.h"]
    paths += ["include/godot_cpp/core/" + name for name in ("gdextension_interface_loader.hpp", "builtin_traits.hpp")]
    paths += ["include/godot_cpp/classes/global_constants.hpp"]
    paths += ["include/godot_cpp/variant/%s.hpp" % dump.snake(name) for name in used["builtins"]]
    paths += ["include/godot_cpp/classes/%s.hpp" % dump.snake(name) for name in used["classes"]]
    paths += ["src/gdextension_interface_loader.cpp", "src/builtins.cpp", "src/engine_classes.cpp"]
    return paths


def interface_functions(generated):
    """Returns the names of the interface functions that handwritten or generated code calls. Only these are looked up."""
    paths = [*HERE.rglob("*.hpp"), *HERE.rglob("*.inc"), *HERE.rglob("*.cpp")]
    texts = [path.read_text(encoding="utf-8") for path in paths] + list(generated)
    return sorted({name for text in texts for name in re.findall(r"\bgdextension_interface::(\w+)", text)})


def interface_types(header, names, release):
    """Returns [(pointer type, name)] for interface functions. In the header, a comment with the name and release precedes the type."""
    matches = re.findall(r"@name (\w+)\n.*?@since (\d+)\.(\d+)\n.*?typedef .*?\(\*(\w+)\)\(", header, re.DOTALL)
    types = {name: kind for name, _, _, kind in matches}
    releases = {name: (int(major), int(minor)) for name, major, minor, _ in matches}
    for name in names:
        if name not in types:
            raise SystemExit("generate.py: this Godot has no interface function '%s'" % name)
        if releases[name] > tuple(map(int, release.split("."))):
            raise SystemExit("generate.py: the interface function '%s' is new in Godot %d.%d, and %s lacks it: look it up"
                " at run time, and handle its absence" % (name, *releases[name], release))  # fmt: skip
    return [(types[name], name) for name in names]


def write(path, text):
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def generate(options, used):
    api = dump.Api(dump.load(options.api), REMEDY)
    header = options.interface.read_text(encoding="utf-8")
    texts = emit.builtins(api, used) | emit.classes(api, used)
    texts |= emit.interface(interface_types(header, interface_functions(texts.values()), api.release))
    texts["include/gdextension_interface.h"] = header
    expected = outputs(used)
    if sorted(texts) != sorted(expected):
        raise SystemExit("generate.py: --list and the written files differ: %s" % (set(texts) ^ set(expected)))
    for path, text in texts.items():
        write(options.out / path, text)


def entries(used):
    """Yields (owner, word) for every entry of used_api.toml. A source that uses the entry contains the word."""
    for section in ("builtins", "classes"):
        for owner, entry in used[section].items():
            for kind in ("methods", "constants"):
                yield from ((owner, word) for word in entry.get(kind, []))


def unused(used, folders):
    """Returns a sentence for each entry that no source uses."""
    paths = [path for folder in folders for path in sorted(folder.rglob("*.[chi]*p*")) + sorted(folder.rglob("*.inc"))]
    words = set(re.findall(r"\w+", "\n".join(path.read_text(encoding="utf-8") for path in paths)))
    return ["%s: nothing uses '%s'" % pair for pair in entries(used) if pair[1] not in words]


def main():
    options = arguments()
    used = tomllib.loads(options.used.read_text(encoding="utf-8"))
    if options.unused:
        sentences = unused(used, options.unused)
        print("\n".join(sentences))
        return 1 if sentences else 0
    if not options.out or not (options.list or (options.api and options.interface)):
        raise SystemExit("generate.py: --out with --list, or with --api and --interface (see --help)")
    if options.list:
        print("\n".join(str(options.out / path) for path in outputs(used)))
    else:
        generate(options, used)
    return 0


if __name__ == "__main__":
    sys.exit(main())
