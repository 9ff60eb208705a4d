"""Compiler, flags and the two libraries that the core uses (GLM is header only, Highway is linked)."""

import os
import platform as host
import re
import subprocess
import sys

from SCons.Script import BoolVariable, EnumVariable, PathVariable, Variables

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None

TARGETS = ("template_debug", "template_release", "editor")
SANITIZERS = ("address", "undefined", "thread")

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion"]

# Contraction is off because a fused multiply-add rounds once where the source rounds twice: the same seed would give
# other points on another processor.
EXACT = ["-ffp-contract=off"]


def options():
    """The options of this build, as `scons --help` prints them."""
    known = Variables()
    known.AddVariables(
        EnumVariable("target", "what to build for", "template_debug", allowed_values=TARGETS),
        (
            "godot_cpp",
            "a godot-cpp that was built or installed there; without it, the stand-in in extension/bindings is used",
            "",
            lambda key, value, env: value and PathVariable.PathIsDir(key, value, env),
        ),
        ("sanitize", "comma-separated sanitizers: address, undefined, thread", ""),
        ("CXX", "the C++ compiler", os.environ.get("CXX", "g++")),
        BoolVariable("dev_build", "for a debugger: -Og -g3, in a build folder of its own", False),
        BoolVariable("werror", "treat warnings in our own code as errors", True),
        BoolVariable("compiledb", "write compile_commands.json for editors and clang tools", True),
    )
    return known


def platform_name():
    return {"Linux": "linux", "Darwin": "macos", "Windows": "windows"}.get(host.system(), host.system().lower())


def arch_name():
    machine = host.machine().lower()
    return {"amd64": "x86_64", "aarch64": "arm64", "i686": "x86_32", "riscv64": "rv64"}.get(machine, machine)


def sanitizers(env):
    names = [name for name in env["sanitize"].split(",") if name]
    for name in names:
        if name not in SANITIZERS:
            raise SystemExit("thicket: sanitize=%s: %s is none of %s" % (env["sanitize"], name, ", ".join(SANITIZERS)))
    return names


def lock(env):
    """Waits until no other build runs in this tree: two would write the same files. The lock ends with its process."""
    folder = env.Dir("#build").abspath
    os.makedirs(folder, exist_ok=True)
    file = open(os.path.join(folder, ".lock"), "w", encoding="utf-8")
    if fcntl:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("thicket: waiting for another build in this tree", file=sys.stderr)
            fcntl.flock(file, fcntl.LOCK_EX)
    return file


def configure(env):
    """Sets the flags that all our code is compiled with; returns the name of the build folder, one for each set of
    options that gives other objects."""
    env["ENV"] = {name: os.environ[name] for name in ("PATH", "HOME", "TERM", "TMPDIR") if name in os.environ}
    env["platform"] = platform_name()
    env["arch"] = arch_name()

    env.Append(
        CPPPATH=["#extension"],
        CXXFLAGS=["-std=c++20"],
        CCFLAGS=WARNINGS + (["-Werror"] if env["werror"] else []) + EXACT + ["-fPIC", "-fvisibility=hidden"],
        LINKFLAGS=["-pthread"],
    )
    # Objects of programs and of the extension are the same: position-independent, hidden by default.
    env["STATIC_AND_SHARED_OBJECTS_ARE_THE_SAME"] = 1
    env["SHOBJSUFFIX"] = env["OBJSUFFIX"]
    env["SHCCFLAGS"] = ["$CCFLAGS"]
    release = env["target"] == "template_release"
    env.Append(CPPDEFINES=["NDEBUG" if release else "DEBUG_ENABLED"])
    if env["dev_build"]:
        env.Append(CCFLAGS=["-Og", "-g3"])
    elif release:
        env.Append(CCFLAGS=["-O3"], LINKFLAGS=["-s"])
    else:
        env.Append(CCFLAGS=["-O2", "-g1"])
    if env["target"] == "editor":
        env.Append(CPPDEFINES=["TOOLS_ENABLED"])

    name = "%s.%s.%s" % (env["platform"], env["target"], env["arch"])
    compiler = os.path.basename(env["CXX"])
    if compiler != "g++":
        name += "." + compiler
    for sanitizer in sanitizers(env):
        flags = ["-fsanitize=" + sanitizer, "-fno-omit-frame-pointer", "-fno-sanitize-recover=all"]
        env.Append(CCFLAGS=flags, LINKFLAGS=flags)
        name += "." + sanitizer
    if env["dev_build"]:
        name += ".dev"
    if env["godot_cpp"]:
        name += ".godot-cpp"
    # Short lines while building: a compiler's own messages stay, compile_commands.json has the full commands.
    env.Replace(CXXCOMSTR="compile $SOURCE", SHCXXCOMSTR="compile $SOURCE", ARCOMSTR="archive $TARGET")
    env.Replace(LINKCOMSTR="link    $TARGET", SHLINKCOMSTR="link    $TARGET")
    env.Replace(ARFLAGS="rcsD", RANLIBCOM="")
    return name


def program_flags(env):
    """What tests and benches have besides."""
    if sanitizers(env):
        # To compile so many checks would take longer than to run them. What they check, the core, keeps its level.
        env.Append(CCFLAGS=["-O1"])


def shared_flags(env):
    """What turns our objects into a library that a running Godot can load, unload and load again."""
    if env["platform"] == "linux":
        # Templates of the standard library are visible whatever -fvisibility says; the map hides them too, so that
        # Godot sees its entry and nothing that could be taken for its own.
        exports = env.File("#tools/scons/exports.map")
        env.Append(LINKFLAGS=["-Wl,--no-undefined", "-Wl,-rpath,'$$ORIGIN'", "-Wl,--version-script=" + exports.abspath])
    if "clang" not in os.path.basename(env["CXX"]):
        # A unique symbol pins its library in memory for ever, and a reload would then find the old code.
        env.Append(CXXFLAGS=["-fno-gnu-unique"])
    if env["target"] == "template_release" and not env["sanitize"]:
        env.Append(LINKFLAGS=["-static-libstdc++", "-static-libgcc"])


def highway(env):
    """What to link for Highway: its archive where the system has one, the shared library otherwise."""
    return [highway_archive(env) or "hwy"]


def shipped_highway(env):
    """What to link for Highway into the extension, and the (name, path) of the library to ship beside it, if any.

    Debian has Highway as a shared library only. A machine that runs the extension need not have it, and one that does
    may have another version, so a copy goes into the addon and is found through the binary's own run path."""
    archive = highway_archive(env)
    if archive:
        return [archive], None
    library = library_path(env, "libhwy.so")
    if library is None:
        return ["hwy"], None
    return ["hwy"], (soname(library), library)


def highway_archive(env):
    archive = library_path(env, "libhwy.a")
    return env.File(archive) if archive else None


def library_path(env, name):
    """Where the compiler finds a library, or None."""
    answer = subprocess.run([env["CXX"], "-print-file-name=" + name], capture_output=True, text=True, check=False)
    path = answer.stdout.strip()
    return os.path.realpath(path) if os.path.isabs(path) and os.path.exists(path) else None


def soname(path):
    """The name under which programs ask for a shared library: libhwy.so.1.0.3 is asked for as libhwy.so.1."""
    return re.sub(r"(\.so\.\d+)\..*$", r"\1", os.path.basename(path))
