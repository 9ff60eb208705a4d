"""The C library that extension/core/c_api/thicket.h declares. It is built in build/<config>/c, as an archive and a shared library."""

import compilers
import rooms

# The room of the header, and all rooms that it includes.
ROOMS = [*rooms.reached_from("core/c_api"), "core/c_api"]


def library(env, out, objects, highway):
    """Nodes of the archive, the shared library and the header. Neither library needs any other library of ours."""
    parts = [*objects, highway[0].sources]
    header = env.Install(out + "/c", "#extension/core/c_api/thicket.h")
    archive = env.StaticLibrary(out + "/c/thicket_c", parts)
    if env["platform"] == "web":
        return [archive, header]  # Programs for the web are linked statically.
    own = env.Clone()
    if env["platform"] == "linux" and not compilers.is_msvc(env):
        exports = env.File("#tools/scons/c_exports.map")
        own.Append(LINKFLAGS=["-Wl,--no-undefined", "-Wl,--version-script=" + exports.abspath])
        own.Depends(out + "/c/libthicket_c.so", exports)
    shared = own.SharedLibrary(out + "/c/thicket_c", parts, SHLIBPREFIX="lib")
    return [archive, shared, header]
