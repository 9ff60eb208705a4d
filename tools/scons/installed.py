"""Where tools/setup.sh puts what it installs."""

import os
import re

TOOLS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def version(name):
    """The release of what tools/setup.sh installs, which names it."""
    with open(os.path.join(TOOLS, "setup.sh"), encoding="utf-8") as file:
        return re.search(r"^%s_version=(\S+)$" % name, file.read(), re.MULTILINE).group(1)


def cache_folder():
    """As in tools/find.sh."""
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return os.environ.get("THICKET_CACHE") or os.path.join(caches, "thicket")


def highway_folder():
    """Where tools/setup.sh puts the sources of Highway."""
    return os.path.join(cache_folder(), "highway-" + version("highway"))


def zig_program():
    """Where tools/setup.sh puts the program zig, beside the sources that it compiles for each target."""
    return os.path.join(cache_folder(), "zig-" + version("zig"), "ziglang", "zig")


def zig_environment(zig):
    """Where this zig keeps what it compiles of its own sources, once for each target."""
    folder = os.path.join(os.path.dirname(os.path.dirname(zig)), "compiled")
    return {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
