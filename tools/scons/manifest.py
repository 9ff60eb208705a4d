"""Determines the file names of the extension and writes its .gdextension manifest, which lists the existing
binaries."""

import os
import re

import engine
import platforms

ADDON = "demo_project/addons/thicket"
ENTRY_SYMBOL = "thicket_library_init"

BINARY = re.compile(
    r"^libthicket\.(?P<platform>\w+)\.(?P<target>template_debug|template_release|editor)(?P<double>\.double)?(?:\.(?P<arch>(?!framework)\w+?))?"
    r"(?P<nothreads>\.nothreads)?\.(?:so|dll|dylib|framework|wasm)$"
)


def addon_folder(env, out):
    """Returns the folder into which the extension is built. This is the demo's add-on for an ordinary build for this machine,
    otherwise the build folder. Builds with zig and releases are meant for other machines. Standard Godot builds cannot load a
    build with sanitizers, and a build with coverage=yes would write its counts into the project."""
    is_for_this_machine = platforms.is_native(env) and not (env["use_zig"] or env["sanitize"] or env["coverage"] or env["ship"])
    return "#" + ADDON if is_for_this_machine else out + "/addon"


def binary_name(env, target):
    return "lib" + platforms.library_name(env, target) + platforms.PLATFORMS[env["platform"]].suffix


def manifest(env, addon, binaries):
    """Returns the node of the manifest, which is rewritten after the binaries are linked. It also lists binaries from
    other builds, so the folder is read when the build starts."""
    folder = env.Dir(addon)
    binary_folder = os.path.join(folder.abspath, "bin")
    names = set(os.listdir(binary_folder) if os.path.isdir(binary_folder) else [])
    names.update(node.name for node in env.Flatten(binaries))
    icons = os.path.join(folder.abspath, "icons")
    text = write(names, os.listdir(icons) if os.path.isdir(icons) else [])
    action = env.Action(write_text, "write   %s/thicket.gdextension" % addon.lstrip("#"))
    node = env.Command(addon + "/thicket.gdextension", [env.Value("\n".join(text)), engine.version_source(env)], action)
    env.Depends(node, binaries)
    return node


def write_text(target, source, env):
    """Writes the manifest. The binaries support the engine version for which they were built and all later versions."""
    text = source[0].get_text_contents().replace("@MINIMUM@", engine.version(source[1].get_text_contents()))
    with open(target[0].abspath, "w", encoding="utf-8") as file:
        file.write(text)


def write(names, icons):
    """Returns the lines of the manifest for these files in bin/ and icons/."""
    binaries = sorted((match for match in map(BINARY.match, names) if match), key=lambda match: match.group(0))
    kinds = {}  # For each kind of binary, the files by target.
    for match in binaries:
        kinds.setdefault(match.group("platform", "arch", "double", "nothreads"), {})[match.group("target")] = match.group(0)
    platforms_without_threads = {platform for platform, _, _, nothreads in kinds if nothreads}
    libraries = []
    for (platform, arch, double, nothreads), built in sorted(kinds.items(), key=str):
        # If a binary is missing, engines load the next best one. For example, an exported game then runs the debug
        # binary.
        features = {
            "editor": built.get("editor"),
            "debug": built.get("template_debug") or built.get("editor") or built.get("template_release"),
            "release": built.get("template_release") or built.get("template_debug") or built.get("editor"),
        }
        tags = [arch] if arch else []
        # If there are binaries of only one precision, the manifest offers them to all engines. In an engine of the
        # other precision, the binary does not load, and reports why.
        other = (platform, arch, None if double else ".double", nothreads)
        tags += ["double" if double else "single"] if other in kinds else []
        tags += ["nothreads" if nothreads else "threads"] if platform in platforms_without_threads else []
        libraries += ['%s = "bin/%s"' % (".".join([platform, feature, *tags]), name) for feature, name in features.items() if name]
    lines = [
        "[configuration]", "",
        'entry_symbol = "%s"' % ENTRY_SYMBOL,
        'compatibility_minimum = "@MINIMUM@"',
        "reloadable = true", "",
        "[libraries]", "", *libraries,
    ]  # fmt: skip
    pictures = sorted(name for name in icons if name.endswith(".svg"))
    if pictures:
        lines += ["", "[icons]", "", *('%s = "icons/%s"' % (name[: -len(".svg")], name) for name in pictures)]
    return [*lines, ""]
