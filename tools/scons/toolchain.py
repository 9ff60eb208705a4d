"""Defines the options of a build and configures its environment."""

import os
import sys

import compilers
import installed
import platforms
from SCons.Script import BoolVariable, EnumVariable, PathVariable, Variables

try:
    import fcntl
except ImportError:  # Windows does not have this module.
    fcntl = None

TARGETS = ("template_debug", "template_release", "editor")
SANITIZERS = ("address", "undefined", "thread")
# The environment variables that are passed to compilers and the compiler cache.
INHERITED = ("PATH", "HOME", "TERM", "TMPDIR", "THICKET_CACHE", "XDG_CACHE_HOME")


def options():
    """Returns the options of the build, which `scons --help` prints."""
    known = Variables()
    known.AddVariables(
        EnumVariable("target", "the kind of build", "template_debug", allowed_values=TARGETS),
        ("platform", "the system to build for: " + ", ".join(platforms.PLATFORMS), platforms.native_platform()),
        ("arch", "the processor architecture to build for; by default this machine's, or wasm32 for the web", ""),
        EnumVariable("precision", "the precision of the engine, which must have been built with the same value", "single", allowed_values=("single", "double")),
        BoolVariable("threads", "platform=web: for export templates with threads", True),
        BoolVariable("use_zig", "compile with zig, for this or another platform", False),
        BoolVariable("scu_build", "compile up to 16 sources together, which makes a full build faster and an incremental build slower", False),
        BoolVariable("ship", "for tools/package.sh: debug and release libraries, with symbols to split off", False),
        (
            "godot_cpp",
            "the folder of a built or installed godot-cpp; without it, the stand-in in extension/bindings is used",
            "",
            lambda key, value, env: value and PathVariable.PathIsDir(key, value, env),
        ),
        (
            "engine_api",
            "a folder with extension_api.json and gdextension_interface.h, as Godot writes them; without it, the build runs Godot",
            "",
            lambda key, value, env: value and PathVariable.PathIsDir(key, value, env),
        ),
        ("prefix", "the folder in which c_install puts the C library", "/usr/local"),
        ("highway", "the sources of Highway " + installed.version("highway"), installed.highway_folder()),
        ("lodepng", "the sources of LodePNG " + installed.version("lodepng"), installed.lodepng_folder()),
        ("zig", "the program zig, for use_zig=yes", installed.zig_program()),
        ("sanitize", "comma-separated sanitizers: address, undefined, thread", ""),
        BoolVariable("count_steps", "with g++ on Linux: programs that count their steps (tests/cost), in a separate build folder", False),
        BoolVariable("coverage", "with clang: counts how often each line runs, in a separate build folder", False),
        ("CXX", "the C++ compiler", ""),
        BoolVariable("dev_build", "for a debugger: -Og -g3, in a separate build folder", False),
        BoolVariable("werror", "treat warnings in our code as errors", True),
        BoolVariable("compiledb", "write compile_commands.json for editors and clang tools", True),
    )
    return known


def sanitizers(env):
    names = [name for name in env["sanitize"].split(",") if name]
    for name in names:
        if name not in SANITIZERS:
            raise SystemExit("thicket: sanitize=%s: %s is not one of %s" % (env["sanitize"], name, ", ".join(SANITIZERS)))
    return names


def targets(env):
    """Returns the targets for which libraries are linked. A release has two, which share their objects, because their
    libraries differ only in the class reference."""
    return ("template_debug", "template_release") if env["ship"] else (env["target"],)


def lock(env):
    """Waits until no other build runs in this tree, because both would write the same files. On Windows, does not wait.
    Returns the locked file, which the caller must keep: the lock is released when the file is closed or garbage
    collected, or when this process ends."""
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
    """Sets the flags for all of our code. Returns the names of the build folder and of the folder with the core's
    objects, which both precisions share. Each option that changes the objects also changes the names."""
    env["ENV"] = {name: value for name, value in os.environ.items() if name in INHERITED or name.startswith("CCACHE_")}
    env["arch"] = env["arch"] or ("wasm32" if env["platform"] == "web" else platforms.native_arch())
    env["CXX"] = env["CXX"] or os.environ.get("CXX") or "g++"
    problem = platforms.problem(env)
    if problem:
        raise SystemExit("thicket: " + problem)
    called = compilers.choose(env)
    env.Append(CPPPATH=["#extension"])
    compilers.configure(env)
    platform = platforms.PLATFORMS[env["platform"]]
    env.Replace(PROGSUFFIX=platform.program, SHLIBSUFFIX=platform.suffix, LIBPREFIX="lib", LIBSUFFIX=".a")

    name = ""
    for sanitizer in sanitizers(env):
        flags = ["-fsanitize=" + sanitizer, "-fno-omit-frame-pointer", "-fno-sanitize-recover=all"]
        env.Append(CCFLAGS=flags, LINKFLAGS=flags)
        name += "." + sanitizer
    if env["count_steps"]:
        env.Append(CCFLAGS=["-fsanitize-coverage=trace-pc"], LINKFLAGS=["-Wl,--wrap=%s" % each for each in ("memmove", "memcpy", "memset")])
        name += ".steps"
    if env["coverage"]:
        if not compilers.name(env).startswith("clang++"):
            raise SystemExit("thicket: coverage=yes needs clang: add CXX=clang++")
        flags = ["-fprofile-instr-generate", "-fcoverage-mapping"]
        # Source paths are relative to the root, so that checkouts can share a compiler cache. Higher levels than -O1
        # have no benefit, because counting prevents optimizations.
        env.Append(CCFLAGS=[*flags, "-fcoverage-compilation-dir=.", "-O1"], LINKFLAGS=flags)
        name += ".coverage"
    name += ".dev" if env["dev_build"] else ""
    name += ".godot-cpp" if env["godot_cpp"] else ""
    # Print short lines during a build. Compiler messages are unaffected, and compile_commands.json has the full
    # commands.
    env.Replace(CXXCOMSTR="compile $SOURCE", SHCXXCOMSTR="compile $SOURCE", ARCOMSTR="archive $TARGET")
    env.Replace(LINKCOMSTR="link    $TARGET", SHLINKCOMSTR="link    $TARGET")
    env.Replace(ARFLAGS="rcsD", RANLIBCOM="")
    if env["scu_build"]:
        env.Append(CPPPATH=["#"])
        # g++ treats an included source as a header, and would warn about types that depend on names local to a source.
        env.Append(CCFLAGS=["-Wno-subobject-linkage"] if compilers.is_gnu(env) and not compilers.is_msvc(env) else [])
        name += ".scu"
    kind = "ship" if env["ship"] else env["target"]
    return tuple(platforms.folder_name(env, kind, precision, called) + name for precision in (env["precision"], "single"))


def program_flags(env):
    """Adds the additional flags for the extension, tests and benchmarks. Only builds with sanitizers have any."""
    if sanitizers(env):
        # With sanitizers, optimizing takes longer than it saves at run time, so only the core keeps its optimization level.
        env.Append(CCFLAGS=["-O1"])
