"""The folders into which tools/setup.sh installs."""

import os
import re

TOOLS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def version(name):
    """The release of a package that tools/setup.sh installs, read from that script."""
    with open(os.path.join(TOOLS, "setup.sh"), encoding="utf-8") as file:
        return re.search(r"^%s_version=(\S+)$" % name, file.read(), re.MULTILINE).group(1)


def cache_folder():
    """The folder of downloads and built libraries. Keep it equal to that of tools/find.sh."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return os.environ.get("THICKET_CACHE") or os.path.join(caches, "thicket")


def highway_folder():
    """The folder of Highway's sources."""
    return os.path.join(cache_folder(), "highway-" + version("highway"))


def zig_program():
    """The path of the program zig. The sources that it compiles for each target are beside it."""
    return os.path.join(cache_folder(), "zig-" + version("zig"), "ziglang", "zig")


def zig_environment(zig):
    """The environment in which zig caches the libraries that it compiles from its own sources, once for each target."""
    folder = os.path.join(os.path.dirname(os.path.dirname(zig)), "compiled")
    return {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
