"""Builds the C library that extension/core/c_api/thicket.h declares, in build/<config>/c, as a static and a shared
library."""

import compilers
import rooms

# The room of the C API, and all rooms that it includes.
ROOMS = [*rooms.reached_from("core/c_api"), "core/c_api"]


def library(env, out, objects, highway):
    """Returns the nodes of the static library, the shared library (except on the web) and the header. A program needs
    one of the two libraries, and none of our other libraries."""
    parts = [*objects, highway[0].sources]
    header = env.Install(out + "/c", "#extension/core/c_api/thicket.h")
    archive = env.StaticLibrary(out + "/c/thicket_c", parts)
    if env["platform"] == "web":
        return [archive, header]  # The web needs no shared library, because programs for it are linked statically.
    own = env.Clone()
    if env["platform"] == "linux" and not compilers.is_msvc(env):
        exports = env.File("#tools/scons/c_exports.map")
        own.Append(LINKFLAGS=["-Wl,--no-undefined", "-Wl,--version-script=" + exports.abspath])
        own.Depends(out + "/c/libthicket_c.so", exports)
    shared = own.SharedLibrary(out + "/c/thicket_c", parts, SHLIBPREFIX="lib")
    return [archive, shared, header]
