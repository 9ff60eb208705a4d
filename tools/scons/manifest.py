"""The file names of the extension, and its .gdextension manifest, which lists the binaries that exist."""

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
    """The folder that the extension is built into: the demo's add-on if a plain Godot on this machine can load it, otherwise the
    build folder. A plain Godot cannot load a build with sanitizers, and one with coverage=yes writes its counts into the project."""
    here = platforms.is_native(env) and not (env["use_zig"] or env["sanitize"] or env["coverage"] or env["ship"])
    return "#" + ADDON if here else out + "/addon"


def binary_name(env, target):
    return "lib" + platforms.library_name(env, target) + platforms.PLATFORMS[env["platform"]].suffix


def manifest(env, addon, binaries):
    """The node of the manifest, which is rewritten after the binaries are linked. It also lists binaries that other runs have
    built, so the folder is read when the build starts."""
    folder = env.Dir(addon)
    there = os.path.join(folder.abspath, "bin")
    names = set(os.listdir(there) if os.path.isdir(there) else [])
    names.update(node.name for node in env.Flatten(binaries))
    icons = os.path.join(folder.abspath, "icons")
    text = write(names, os.listdir(icons) if os.path.isdir(icons) else [])
    action = env.Action(write_text, "write   %s/thicket.gdextension" % addon.lstrip("#"))
    node = env.Command(addon + "/thicket.gdextension", [env.Value("\n".join(text)), engine.version_source(env)], action)
    env.Depends(node, binaries)
    return node


def write_text(target, source, env):
    """Writes the manifest. The binaries support the version that they were built for and all later ones, but no older one."""
    text = source[0].get_text_contents().replace("@MINIMUM@", engine.version(source[1].get_text_contents()))
    with open(target[0].abspath, "w", encoding="utf-8") as file:
        file.write(text)


def write(names, icons):
    """The manifest's text for these files in bin/ and these in icons/."""
    binaries = sorted((match for match in map(BINARY.match, names) if match), key=lambda match: match.group(0))
    kinds = {}  # The binaries of each kind: {target: file}.
    for match in binaries:
        kinds.setdefault(match.group("platform", "arch", "double", "nothreads"), {})[match.group("target")] = match.group(0)
    several = {platform for platform, _, _, nothreads in kinds if nothreads}
    libraries = []
    for (platform, arch, double, nothreads), built in sorted(kinds.items(), key=str):
        # Without a release binary, an exported game runs the debug binary, and vice versa.
        features = {
            "editor": built.get("editor"),
            "debug": built.get("template_debug") or built.get("editor") or built.get("template_release"),
            "release": built.get("template_release") or built.get("template_debug") or built.get("editor"),
        }
        tags = [arch] if arch else []
        # A binary without a counterpart is offered to engines of both precisions. It refuses the wrong one and reports why.
        other = (platform, arch, None if double else ".double", nothreads)
        tags += ["double" if double else "single"] if other in kinds else []
        tags += ["nothreads" if nothreads else "threads"] if platform in several else []
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
