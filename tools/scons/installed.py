"""Finds the folders into which tools/setup.sh installs."""

import os
import re

TOOLS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def version(name):
    """Returns the version of a package that tools/setup.sh installs, read from that script."""
    with open(os.path.join(TOOLS, "setup.sh"), encoding="utf-8") as file:
        return re.search(r"^%s_version=(\S+)$" % name, file.read(), re.MULTILINE).group(1)


def cache_folder():
    """Returns the folder of downloads and built libraries. Must be the same as in tools/find.sh."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return os.environ.get("THICKET_CACHE") or os.path.join(caches, "thicket")


def highway_folder():
    """Returns the folder of Highway's sources."""
    return os.path.join(cache_folder(), "highway-" + version("highway"))


def lodepng_folder():
    """Returns the folder of LodePNG's sources."""
    return os.path.join(cache_folder(), "lodepng-" + version("lodepng"))


def zig_program():
    """Returns the path of the program zig. The library sources that it compiles for each target are next to it."""
    return os.path.join(cache_folder(), "zig-" + version("zig"), "ziglang", "zig")


def zig_environment(zig):
    """Returns environment variables for zig's cache, which contains the libraries that zig compiles once per target."""
    folder = os.path.join(os.path.dirname(os.path.dirname(zig)), "compiled")
    return {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
