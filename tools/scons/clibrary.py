"""Builds the C library that extension/core/c_api/thicket.h declares, in build/<config>/c, as a static and a shared library, and
installs it for pkg-config and CMake."""

import re

import compilers
import rooms

# The room of the C API, and all rooms that it includes.
ROOMS = [*rooms.reached_from("core/c_api"), "core/c_api"]
HEADERS = ["#extension/core/c_api/thicket.h", "#extension/core/c_api/thicket.hpp"]


def version(env):
    """Returns the version in the header, as (major, minor)."""
    header = env.File(HEADERS[0]).srcnode().get_text_contents()
    return divmod(int(re.search(r"#define THICKET_C_VERSION (\d+)", header).group(1)), 1000)


def is_elf(env):
    return env["platform"] == "linux" and not compilers.is_msvc(env)


def library(env, out, objects, highway):
    """Returns the nodes of the static library, the shared library (except on the web) and the headers. A program needs
    one of the two libraries, and none of our other libraries."""
    objects_and_highway = [*objects, highway[0].sources]
    headers = env.Install(out + "/c", HEADERS)
    archive = env.StaticLibrary(out + "/c/thicket_c", objects_and_highway)
    if env["platform"] == "web":
        return [archive, headers]  # The web needs no shared library, because programs for it are linked statically.
    shared_env = env.Clone()
    if is_elf(env):
        exports = env.File("#tools/scons/c_exports.map")
        shared_env.Append(LINKFLAGS=["-Wl,--no-undefined", "-Wl,--version-script=" + exports.abspath])
        if env["target"] == "template_release":
            shared_env.Append(LINKFLAGS=["-Wl,--strip-all"])
        # The name of the file has the version, and programs load it by the major version.
        shared_env["SHLIBVERSION"] = "%d.%d.0" % version(env)
    shared = shared_env.SharedLibrary(out + "/c/thicket_c", objects_and_highway, SHLIBPREFIX="lib")
    if is_elf(env):
        shared_env.Depends(shared, exports)
    return [archive, shared, headers]


def install(env, out, nodes):
    """Returns the nodes of the installed library: its headers, both libraries, and the files for pkg-config and CMake."""
    archive, shared, _headers = nodes
    prefix = env["prefix"]
    major, minor = version(env)
    values = {
        "@version@": "%d.%d.0" % (major, minor),
        "@major@": str(major),
        "@shared@": shared[0].name,
        "@soname@": "libthicket_c.so.%d" % major,
    }

    def config_file(name):
        return env.Substfile(out + "/c/" + name, "#tools/scons/c_install/%s.in" % name, SUBST_DICT=values)

    configs = [config_file("thicket_c-config.cmake"), config_file("thicket_c-config-version.cmake")]
    return [
        env.Install(prefix + "/include", HEADERS),
        env.Install(prefix + "/lib", archive),
        env.InstallVersionedLib(prefix + "/lib", shared, SHLIBVERSION=values["@version@"]),
        env.Install(prefix + "/lib/pkgconfig", config_file("thicket_c.pc")),
        env.Install(prefix + "/lib/cmake/thicket_c", configs),
    ]
