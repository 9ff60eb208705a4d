"""Provides the bindings for engine code: either the godot-cpp that the user specifies, or our replacement for godot-cpp.
The replacement is generated from an API description of the oldest supported engine."""

import glob
import os
import re
import subprocess
import sys

BINDINGS = "extension/bindings"
DUMPED = ("extension_api.json", "gdextension_interface.h")


def bind(env, out, sources):
    """Prepares env for engine code. Returns the objects to link with that code; none with an external godot-cpp, whose
    library is added to env instead."""
    return external(env, env["godot_cpp"]) if env["godot_cpp"] else stand_in(env, out, sources)


def external(env, folder):
    """Uses a godot-cpp, either a built checkout or an installed prefix. Its headers are third-party code, so warnings
    in them are disabled. Adds its library to env and returns an empty list. Ends the build if there is no library for
    this target, architecture and precision."""
    folder = os.path.abspath(folder)
    roots = [os.path.join(folder, subfolder) for subfolder in ("include", "gen/include", "gdextension")]
    archives = [
        path
        for subfolder in ("bin", "lib", "lib64", "lib/*-linux-gnu")
        for path in sorted(glob.glob(os.path.join(folder, subfolder, "libgodot-cpp*.a")))
    ]
    double = env["precision"] == "double"
    matching = [path for path in archives if env["target"] in path and env["arch"] in path and (".double." in path) == double]
    if not matching:
        found = ", ".join(os.path.relpath(path, folder) for path in archives) or "none"
        sys.exit("thicket: godot_cpp=%s contains no library for %s%s %s (found: %s)"
            % (folder, env["target"], " double" * double, env["arch"], found))  # fmt: skip
    for root in roots:
        if os.path.isdir(root):
            env.Append(CCFLAGS=["-isystem", root])
    # Repeats the definitions that godot-cpp's own build sets for code that links with it.
    env.Append(CPPDEFINES=["GDEXTENSION"], LIBS=[env.File(matching[0])])
    if supports_reload(matching[0]):
        env.Append(CPPDEFINES=["HOT_RELOAD_ENABLED"])
    return []


def supports_reload(archive):
    """Returns whether a godot-cpp was built with use_hot_reload=yes. Code linked with it must be compiled with the same
    setting, because both share thread-local data of Wrapped that depends on it. Depending on the release, this is a record
    whose size differs, or a member that exists only with the setting."""
    symbols = subprocess.run(["nm", "-S", archive], capture_output=True, text=True, check=False).stdout
    sizes = re.findall(r"^[0-9a-f]+ ([0-9a-f]+) \w _ZZN5godot7Wrapped19_get_construct_infoEvE4info$", symbols, re.MULTILINE)
    return any(int(size, 16) > 16 for size in sizes) or re.search(r"5godot7Wrapped\d+\w*recreate_\w+E", symbols) is not None


def stand_in(env, out, sources):
    """Builds the replacement for godot-cpp from its hand-written part and the sources that are generated from the API
    description. The interface header comes from the engine. The generator lists its output files in advance, so the engine is
    started only if a target needs one of those files. Returns the objects to link."""
    root = env.Dir("#").abspath
    generated = env.Dir(out + "/gen").abspath
    generator = [sys.executable, os.path.join(root, BINDINGS, "generate.py"), "--out", generated, "--used", used_api(root)]
    listing = subprocess.run([*generator, "--list"], capture_output=True, text=True, check=False)
    if listing.returncode:
        sys.exit("thicket: extension/bindings/generate.py --list failed:\n" + listing.stderr)
    interface = dump(env)[DUMPED.index("gdextension_interface.h")]
    inputs = [path for path in glob.glob(os.path.join(root, BINDINGS, "**"), recursive=True) if os.path.isfile(path)]
    inputs = [path for path in inputs if "__pycache__" not in path]
    command = [*generator, "--api", description(root), "--interface", interface.abspath]
    action = env.Action([command], "write   %s/gen" % out.lstrip("#"))
    # The generator reads headers as text. Files that these headers include, some of which the generator writes, are
    # therefore not inputs of the command.
    generated_files = env.Command(
        listing.stdout.splitlines(),
        [interface, *sorted({*inputs, used_api(root), description(root)})],
        action,
        source_scanner=env.Scanner(lambda node, env, path: []),
    )
    env.Append(CPPPATH=["#%s/include" % BINDINGS, generated + "/include"])
    generated_objects = [env.SharedObject(node) for node in generated_files if node.name.endswith(".cpp")]
    return generated_objects + sources(BINDINGS + "/src/**/*.cpp")


def class_reference(env, out, target):
    """Returns a list with the object that contains our class reference for the editor. The list is empty for release
    builds, because the editor does not load them."""
    pages = sorted(env.Glob("#extension/doc_classes/*.xml"), key=str)
    if target == "template_release" or not pages:
        return []
    script = env.File("#%s/docs.py" % BINDINGS)
    action = env.Action([[sys.executable, script.abspath, "--out", "$TARGET", *[page.abspath for page in pages]]],
        "pack    the class reference")  # fmt: skip
    source = env.Command(out + "/gen/doc_data.cpp", pages, action)
    env.Depends(source, script)
    return [env.SharedObject(source)]


def version_source(env):
    """Returns the node that contains the version of the oldest engine that the bindings support: a file or, for a
    godot-cpp without a version header, the text of version 4.4."""
    if not env["godot_cpp"]:
        return env.File(description(env.Dir("#").abspath))
    for subfolder in ("gen/include", "include"):
        header = os.path.join(os.path.abspath(env["godot_cpp"]), subfolder, "godot_cpp/core/version.hpp")
        if os.path.exists(header):
            return env.File(header)
    return env.Value("version_major 4 version_minor 4")


def version(text):
    """Returns the major and minor version, such as "4.6", from the text of version_source."""
    return ".".join(re.search(r'(?i)version_%s"?:? +([0-9]+)' % component, text).group(1) for component in ("major", "minor"))


def used_api(root):
    """Returns the path of the list of the API that engine code uses."""
    return only(root, "used_api.toml")


def description(root):
    """Returns the path of the API description of the oldest supported engine, written by describe.py."""
    return only(root, "description_*.json")


def only(root, name):
    paths = glob.glob(os.path.join(root, "extension/*", name))
    if len(paths) != 1:
        sys.exit("thicket: extension/ must contain one %s, found %d" % (name, len(paths)))
    return paths[0]


def find(env):
    """Returns the path and the modification time, as text, of the Godot that provides the API dump. Returns None if there is
    none."""
    script = env.File("#tools/godot").abspath
    process = subprocess.run([script, "--where"], capture_output=True, text=True, check=False)
    path = process.stdout.strip()
    return "%s %d" % (path, os.stat(path).st_mtime_ns) if process.returncode == 0 and path else None


def dump(env):
    """Returns the nodes of the two files in which Godot describes its API. They are rewritten when another Godot is found. With
    engine_api=DIR, returns the files in that folder."""
    if env["engine_api"]:
        return [env.File(os.path.join(os.path.abspath(env["engine_api"]), name)) for name in DUMPED]
    folder = "#build/engine/"
    godot = find(env)

    def run(target, source, env):
        if not godot:
            print("thicket: no Godot 4.4 or newer found: run tools/setup.sh, or set GODOT, "
                "or build without the extension: scons core tests bench", file=sys.stderr)  # fmt: skip
            return 1
        folder_path = os.path.dirname(target[0].abspath)
        command = [env.File("#tools/godot").abspath, "--headless",
            "--dump-extension-api-with-docs", "--dump-gdextension-interface"]  # fmt: skip
        process = subprocess.run(command, cwd=folder_path, capture_output=True, text=True, check=False)
        missing = [name for name in DUMPED if not os.path.exists(os.path.join(folder_path, name))]
        if process.returncode != 0 or missing:
            print(process.stdout + process.stderr, file=sys.stderr)
            return 1
        return 0

    action = env.Action(run, "query   Godot's API")
    return env.Command([folder + name for name in DUMPED], env.Value(godot or "no Godot"), action)
