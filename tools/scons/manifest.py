"""The extension's file names, and the .gdextension manifest, written from the binaries that are really there."""

import os
import re

import engine

ADDON = "demo_project/addons/thicket"
ENTRY_SYMBOL = "thicket_library_init"
SUFFIXES = {"windows": "dll", "macos": "dylib"}

BINARY = re.compile(
    r"^libthicket\.(\w+)\.(template_debug|template_release|editor)(?:\.(double))?\.(\w+)\.(?:so|dll|dylib)$"
)


def addon_folder(env, out):
    """Where the extension is built: into the demo's addon, except with sanitizers, which a plain Godot cannot load."""
    return out + "/addon" if env["sanitize"] else "#" + ADDON


def binary_name(env):
    suffix = SUFFIXES.get(env["platform"], "so")
    double = ".double" if env.get("precision") == "double" else ""
    return "libthicket.%s.%s%s.%s.%s" % (env["platform"], env["target"], double, env["arch"], suffix)


def manifest(env, addon, binary, beside):
    """The node of the manifest, rewritten after the binary is linked. What it says depends on which other binaries lie
    there, built by other runs, so they are listed when the build starts."""
    folder = env.Dir(addon)
    there = os.path.join(folder.abspath, "bin")
    names = set(os.listdir(there) if os.path.isdir(there) else [])
    names.update(node.name for node in env.Flatten([binary, beside]))
    icons = os.path.join(folder.abspath, "icons")
    text = write(names, os.listdir(icons) if os.path.isdir(icons) else [])
    action = env.Action(write_text, "write   %s/thicket.gdextension" % addon.lstrip("#"))
    node = env.Command(addon + "/thicket.gdextension", [env.Value("\n".join(text)), engine.version_source(env)], action)
    env.Depends(node, [binary, beside])
    return node


def write_text(target, source, env):
    """What was built knows the engine of this version and all later ones, and promises nothing about older ones."""
    text = source[0].get_text_contents().replace("@MINIMUM@", engine.version(source[1].get_text_contents()))
    with open(target[0].abspath, "w", encoding="utf-8") as file:
        file.write(text)


def write(names, icons):
    """The manifest's text for these files in bin/ and these in icons/."""
    binaries = sorted((match for match in map(BINARY.match, names) if match), key=lambda match: match.group(0))
    libraries, dependencies = [], []
    shipped = sorted(name for name in names if re.match(r"^libhwy\.", name))
    kinds = sorted({(match.group(1), match.group(4), match.group(3) or "single") for match in binaries})
    for platform, arch, precision in kinds:
        kind = platform, arch, precision if precision == "double" else None
        built = {match.group(2): match.group(0) for match in binaries if match.group(1, 4, 3) == kind}
        # One that is alone is offered to engines of both precisions: it refuses the wrong one and says why.
        other = (platform, arch, "single" if precision == "double" else "double") in kinds
        # Without a release binary an exported game still runs, and the other way round.
        features = {
            "editor": built.get("editor"),
            "debug": built.get("template_debug") or built.get("editor") or built.get("template_release"),
            "release": built.get("template_release") or built.get("template_debug") or built.get("editor"),
        }
        for feature, name in features.items():
            if name:
                key = "%s.%s.%s" % (platform, feature, arch + ("." + precision if other else ""))
                libraries.append('%s = "bin/%s"' % (key, name))
                if shipped:
                    entries = ", ".join('"bin/%s": ""' % name for name in shipped)
                    dependencies.append("%s = { %s }" % (key, entries))
    lines = [
        "[configuration]", "",
        'entry_symbol = "%s"' % ENTRY_SYMBOL,
        'compatibility_minimum = "@MINIMUM@"',
        "reloadable = true", "",
        "[libraries]", "", *libraries,
    ]  # fmt: skip
    if dependencies:
        lines += ["", "[dependencies]", "", *dependencies]
    pictures = sorted(name for name in icons if name.endswith(".svg"))
    if pictures:
        lines += ["", "[icons]", "", *('%s = "icons/%s"' % (name[: -len(".svg")], name) for name in pictures)]
    return [*lines, ""]
