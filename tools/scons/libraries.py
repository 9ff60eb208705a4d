"""Third-party libraries: the four sources of Highway that a program needs, compiled for the same processors as our code, and the
headers of GLM and doctest."""

import contextlib
import filecmp
import os
import shutil
import tempfile

import compilers
import installed
import platforms

HIGHWAY_SOURCES = ("abort", "aligned_allocator", "per_target", "targets")


def highway(env, out):
    """The library's node. Its headers are third-party code, so their warnings are off."""
    folder = os.path.abspath(env["highway"])
    if not os.path.exists(os.path.join(folder, "hwy/highway.h")):
        raise SystemExit(
            "thicket: highway=%s holds no hwy/highway.h: run bash tools/setup.sh, or name the sources of Highway %s" % (folder, installed.version("highway"))
        )
    env.Append(CPPDEFINES=["HWY_STATIC_DEFINE"])
    env.Append(CCFLAGS=["/external:W0", "/external:I" + folder] if compilers.is_msvc(env) else ["-isystem", folder])
    foreign = env.Clone()
    # Its own sources must target the same processors as ours.
    sets = env.File("#extension/core/base/instruction_sets.hpp").abspath
    foreign.Append(CCFLAGS=["/w", "/FI" + sets] if compilers.is_msvc(env) else ["-w", "-include", sets])
    objects = [foreign.Object("%s/highway/%s" % (out, name), os.path.join(folder, "hwy", name + ".cc")) for name in HIGHWAY_SOURCES]
    return env.StaticLibrary(out + "/hwy", objects)


def headers(env):
    """Makes GLM and doctest visible to a cross compiler, and nothing else from the folder that contains them."""
    if env["use_zig"] or not platforms.is_native(env):
        env.Append(CCFLAGS=["-isystem", copied_headers(env.Dir("#build/headers").abspath)])


def copied_headers(folder):
    """Copies these headers into a folder, because a compiler may run in a separate root. Returns the folder."""
    os.makedirs(folder, exist_ok=True)
    for name, header in (("glm", "glm/glm.hpp"), ("doctest", "doctest/doctest.h")):
        roots = ["/usr/include", "/usr/local/include", "/opt/homebrew/include", *os.environ.get("CPATH", "").split(os.pathsep)]
        found = [root for root in roots if root and os.path.exists(os.path.join(root, header))]
        copied = os.path.join(folder, header)
        if found and not (os.path.exists(copied) and filecmp.cmp(copied, os.path.join(found[0], header))):
            shutil.rmtree(os.path.join(folder, name), ignore_errors=True)
            # Copied as a whole or not at all, and never into a copy that another build is making.
            with tempfile.TemporaryDirectory(dir=folder) as own:
                shutil.copytree(os.path.join(found[0], name), os.path.join(own, name))
                with contextlib.suppress(OSError):
                    os.rename(os.path.join(own, name), os.path.join(folder, name))
    return folder
