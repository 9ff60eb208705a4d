"""The libraries of others: the part of Highway that a program links, four of its sources, compiled with ours and for the
same processors; and the headers of GLM and doctest."""

import filecmp
import os
import shutil

import compilers
import platforms

HIGHWAY_VERSION = "1.2.0"
HIGHWAY_SOURCES = ("abort", "aligned_allocator", "per_target", "targets")


def cache_folder():
    """As in tools/find.sh."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return os.environ.get("THICKET_CACHE") or os.path.join(caches, "thicket")


def highway_folder():
    """Where tools/setup.sh puts the sources of Highway."""
    return os.path.join(cache_folder(), "highway-" + HIGHWAY_VERSION)


def highway(env, out):
    """The library's node. Its headers are not ours, so their warnings are not shown."""
    folder = os.path.abspath(env["highway"])
    if not os.path.exists(os.path.join(folder, "hwy/highway.h")):
        raise SystemExit(
            "thicket: highway=%s holds no hwy/highway.h: run bash tools/setup.sh, or name the sources of Highway %s" % (folder, HIGHWAY_VERSION)
        )
    env.Append(CPPDEFINES=["HWY_STATIC_DEFINE"])
    env.Append(CCFLAGS=["/external:W0", "/external:I" + folder] if compilers.is_msvc(env) else ["-isystem", folder])
    foreign = env.Clone()
    # Its own sources are for the same processors as ours.
    sets = env.File("#extension/core/sampling/instruction_sets.hpp").abspath
    foreign.Append(CCFLAGS=["/w", "/FI" + sets] if compilers.is_msvc(env) else ["-w", "-include", sets])
    objects = [foreign.Object("%s/highway/%s" % (out, name), os.path.join(folder, "hwy", name + ".cc")) for name in HIGHWAY_SOURCES]
    return env.StaticLibrary(out + "/hwy", objects)


def headers(env):
    """Lets a compiler for another system find GLM and doctest, and nothing else that lies beside them: in a copy, since it may
    run in a root of its own."""
    if not env["use_zig"] and platforms.is_native(env):
        return
    folder = env.Dir("#build/headers").abspath
    for name, header in (("glm", "glm/glm.hpp"), ("doctest", "doctest/doctest.h")):
        roots = ["/usr/include", "/usr/local/include", "/opt/homebrew/include", *os.environ.get("CPATH", "").split(os.pathsep)]
        found = [root for root in roots if root and os.path.exists(os.path.join(root, header))]
        copied = os.path.join(folder, header)
        if found and not (os.path.exists(copied) and filecmp.cmp(copied, os.path.join(found[0], header))):
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
            shutil.copytree(os.path.join(found[0], name), os.path.join(folder, name))
    env.Append(CCFLAGS=["-isystem", folder])
