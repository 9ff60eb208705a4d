"""Provides third-party libraries: the four sources of Highway that a program needs, compiled for the same CPUs as our
code, LodePNG without its encoder, and the headers of GLM and doctest."""

import contextlib
import filecmp
import os
import shutil
import tempfile

import compilers
import installed
import platforms

HIGHWAY_SOURCES = ("abort", "aligned_allocator", "per_target", "targets")
# Parts of LodePNG that reading heights does not need.
LODEPNG_OMITTED = ["LODEPNG_NO_COMPILE_" + part for part in ("ENCODER", "DISK", "ANCILLARY_CHUNKS", "ERROR_TEXT")]


def highway(env, out):
    """Makes the library's headers visible to the code of env. Returns the library's node."""
    folder = sources_of(env, "highway", "Highway", "hwy/highway.h")
    env.Append(CPPDEFINES=["HWY_STATIC_DEFINE"])
    include(env, folder)
    foreign = env.Clone()
    # Highway's sources must target the same CPUs as ours.
    sets = env.File("#extension/core/base/instruction_sets.hpp").abspath
    foreign.Append(CCFLAGS=["/w", "/FI" + sets] if compilers.is_msvc(env) else ["-w", "-include", sets])
    objects = [foreign.Object("%s/highway/%s" % (out, name), os.path.join(folder, "hwy", name + ".cc")) for name in HIGHWAY_SOURCES]
    return env.StaticLibrary(out + "/hwy", objects)


def lodepng(env, out):
    """Returns the library's node and the environment of the code that includes its header."""
    folder = sources_of(env, "lodepng", "LodePNG", "lodepng.h")
    user = env.Clone()
    user.Append(CPPDEFINES=LODEPNG_OMITTED)
    include(user, folder)
    foreign = user.Clone()
    foreign.Append(CCFLAGS=["/w"] if compilers.is_msvc(env) else ["-w"])
    return env.StaticLibrary(out + "/lodepng", foreign.Object(out + "/lodepng/lodepng", os.path.join(folder, "lodepng.cpp"))), user


def sources_of(env, option, name, header):
    """Returns the folder of a library's sources, from the option of the build. Ends the build if the header is not in
    it."""
    folder = os.path.abspath(env[option])
    if not os.path.exists(os.path.join(folder, header)):
        raise SystemExit(
            "thicket: %s=%s does not contain %s: run bash tools/setup.sh, or specify the sources of %s %s" % (option, folder, header, name, installed.version(option))
        )
    return folder


def include(env, folder):
    """Makes a library's headers visible. They are third-party code, so their warnings are disabled."""
    env.Append(CCFLAGS=["/external:W0", "/external:I" + folder] if compilers.is_msvc(env) else ["-isystem", folder])


def headers(env):
    """Makes GLM and doctest visible to zig and to cross compilers, without other headers from the same folder. Other compilers
    find them without help."""
    if env["use_zig"] or not platforms.is_native(env):
        env.Append(CCFLAGS=["-isystem", copied_headers(env.Dir("#build/headers").abspath)])


def copied_headers(folder):
    """Copies the headers of GLM and doctest into a folder, because a compiler may run in a separate root. Skips headers
    that are not installed, and up-to-date copies. Returns the folder."""
    os.makedirs(folder, exist_ok=True)
    for name, header in (("glm", "glm/glm.hpp"), ("doctest", "doctest/doctest.h")):
        roots = ["/usr/include", "/usr/local/include", "/opt/homebrew/include", *os.environ.get("CPATH", "").split(os.pathsep)]
        installed_roots = [root for root in roots if root and os.path.exists(os.path.join(root, header))]
        copied = os.path.join(folder, header)
        if installed_roots and not (os.path.exists(copied) and filecmp.cmp(copied, os.path.join(installed_roots[0], header))):
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
            # Copy into a temporary folder and rename it, so that a copy is always complete, even if several builds run
            # concurrently.
            with tempfile.TemporaryDirectory(dir=folder) as temporary:
                shutil.copytree(os.path.join(installed_roots[0], name), os.path.join(temporary, name))
                with contextlib.suppress(OSError):
                    os.rename(os.path.join(temporary, name), os.path.join(folder, name))
    return folder
