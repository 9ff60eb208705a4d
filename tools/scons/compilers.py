"""Defines the flags for each compiler: g++, clang, zig's clang for any platform, emscripten, and Microsoft's
compiler."""

import os

import installed
import platforms

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion"]

# g++ 12 at -O3 warns that `"text" + string` copies a string onto itself. This is a false positive (GCC bug 105651).
GNU_WARNINGS = WARNINGS + ["-Wno-restrict"]

# Prevents the compiler from fusing a multiplication and an addition, because the fused operation rounds once where the
# source rounds twice. The same seed would then produce different points on different CPUs.
EXACT = ["-ffp-contract=off"]
# With these flags, 32-bit x86 code uses SSE2 instead of the 80-bit registers of the x87 unit.
EXACT_ON = {"x86_32": ["-msse2", "-mfpmath=sse"]}


def name(env):
    """Returns the compiler's name: em++ for the web, zig with use_zig=yes, otherwise the file name of CXX, such as g++, clang++
    or cl."""
    if env["platform"] == "web":
        return "em++"
    return "zig" if env["use_zig"] else os.path.basename(env["CXX"])


def is_msvc(env):
    return name(env).lower() in ("cl", "cl.exe", "clang-cl", "clang-cl.exe")


def is_gnu(env):
    return env["platform"] != "web" and not env["use_zig"] and "clang" not in name(env)


def choose(env):
    """Sets the programs that compile, archive and link for the web and with use_zig=yes. For other builds, SCons uses
    CXX. Returns the compiler's name for the build folder's name, which is "" for default compilers. Ends the build if
    zig is not installed."""
    if env["platform"] == "web":
        run = env.File("#tools/emscripten").abspath
        env.Replace(CXX=[run, "em++"], LINK=[run, "em++"], SHLINK=[run, "em++"], AR=[run, "emar"], RANLIB=[run, "emranlib"])
    elif env["use_zig"]:
        zig = env["zig"]
        if not os.access(zig, os.X_OK):
            raise SystemExit("thicket: use_zig=yes: no zig at %s (bash tools/package.sh installs it)" % zig)
        compiler = [zig, "c++", "-target", platforms.zig_target(env)]
        env.Replace(CXX=compiler, LINK=compiler, SHLINK=compiler, AR=[zig, "ar"], RANLIB=[zig, "ranlib"])
        env["ENV"].update(installed.zig_environment(zig))
    return "" if name(env) in ("g++", "cl", "em++") else name(env)


def is_release(env):
    return env["target"] == "template_release" or env["ship"]


def configure(env):
    """Adds the flags for all of our code."""
    release = is_release(env)
    env.Append(CPPDEFINES=["NDEBUG" if release else "DEBUG_ENABLED"])
    if env["target"] == "editor":
        env.Append(CPPDEFINES=["TOOLS_ENABLED"])
    if env["ship"]:
        env.Append(CPPDEFINES=["THICKET_SHIPPED"])
    env.Append(CPPDEFINES=list(platforms.PLATFORMS[env["platform"]].defines))
    if env["threads"]:
        env.Append(CPPDEFINES=["THREADS_ENABLED"])
    if is_msvc(env):
        configure_msvc(env, release)
    else:
        configure_gnu(env, release)


def configure_gnu(env, release):
    env.Append(
        CXXFLAGS=["-std=c++20"],
        CCFLAGS=(GNU_WARNINGS if is_gnu(env) else WARNINGS) + (["-Werror"] if env["werror"] else []) + EXACT + EXACT_ON.get(env["arch"], []),
    )
    env.Append(CCFLAGS=["-fvisibility=hidden"] + (["-fPIC"] if env["platform"] != "windows" else []))
    # Programs and the extension share objects. All objects are position-independent and hide symbols by default.
    env["STATIC_AND_SHARED_OBJECTS_ARE_THE_SAME"] = 1
    env["OBJSUFFIX"] = env["SHOBJSUFFIX"] = ".o"
    env["SHCCFLAGS"] = ["$CCFLAGS"]
    if env["threads"]:
        env.Append(LINKFLAGS=["-pthread"])
    if env["platform"] == "web" and env["threads"]:
        env.Append(CCFLAGS=["-pthread"])
    if env["platform"] == "web":
        env.Append(CCFLAGS=["-msimd128", "-sSUPPORT_LONGJMP=wasm"])
    if env["use_zig"]:
        # zig checks for undefined behavior by default, but only builds with sanitize=undefined should do so. The prefix
        # map keeps this machine's paths out of the binaries.
        env.Append(CCFLAGS=["-fno-sanitize=undefined", "-ffile-prefix-map=%s=." % env.Dir("#").abspath])
    if env["dev_build"]:
        env.Append(CCFLAGS=["-Og", "-g3"])
        return
    env.Append(CCFLAGS=["-O3" if release else "-O2"])
    if env["ship"]:
        env.Append(CCFLAGS=["-g1", "-gdwarf-4", "-ffunction-sections", "-fdata-sections"])
    elif release or env["use_zig"]:
        env.Append(CCFLAGS=["-g0"], LINKFLAGS=["-s"])
    else:
        env.Append(CCFLAGS=["-g1"])


# Rooms whose code is large and whose speed does not matter, because it does not run in every frame, but only when a
# property is set, a scene is read or a script calls it.
OPTIMIZED_FOR_SIZE = ["nodes/biome", "nodes/explain", "nodes/impostor", "nodes/layer", "nodes/model", "nodes/region", "nodes/sampler"]


def objects_of(env, room, sources):
    """Returns the objects of a room's sources. In rooms where speed does not matter, -Os replaces -O2 and -O3, except
    with Microsoft's compiler."""
    flags = env["CCFLAGS"]
    if room in OPTIMIZED_FOR_SIZE and not is_msvc(env):
        flags = ["-Os" if flag in ("-O2", "-O3") else flag for flag in flags]
    return env.SharedObject(sources, CCFLAGS=flags)


def configure_msvc(env, release):
    """Adds flags according to Microsoft's documentation. Not tested yet (docs/howto/build.md)."""
    env.Append(
        CXXFLAGS=["/std:c++20", "/EHsc", "/permissive-", "/Zc:__cplusplus", "/Zc:preprocessor", "/utf-8", "/bigobj"],
        CCFLAGS=["/W4"] + (["/WX"] if env["werror"] else []) + ["/fp:precise", "/GS", "/guard:cf"],
        LINKFLAGS=["/DYNAMICBASE", "/NXCOMPAT", "/HIGHENTROPYVA", "/guard:cf"],
        CPPDEFINES=["NOMINMAX", "_USE_MATH_DEFINES"],
    )
    env["STATIC_AND_SHARED_OBJECTS_ARE_THE_SAME"] = 1
    env.Append(CCFLAGS=["/Od", "/Zi"] if env["dev_build"] else ["/O2"])
    # Links the C++ library statically, as on all platforms.
    env.Append(CCFLAGS=["/MT"])


def shared_flags(env):
    """Adds the flags for a library that a running Godot can load, unload and reload. Microsoft's compiler gets none."""
    if is_msvc(env):
        return
    platform, release = env["platform"], is_release(env)
    if platform in ("linux", "android"):
        # Templates of the standard library are visible regardless of -fvisibility. The version script also hides these
        # templates, so that only the entry point is exported and no symbol can clash with one of Godot's.
        exports = env.File("#tools/scons/exports.map")
        env.Append(LINKFLAGS=["-Wl,--no-undefined", "-Wl,--version-script=" + exports.abspath])
        env.Append(LINKFLAGS=["-Wl,-z,relro", "-Wl,-z,now", "-Wl,-z,noexecstack", "-Wl,--build-id=sha1", "-Wl,--gc-sections"])
    if platform == "windows":
        # Prevents the linker from writing the build time into the library.
        env.Append(LINKFLAGS=["-Wl,/Brepro" if env["use_zig"] else "-Wl,--no-insert-timestamp"])
    if platform == "macos":
        env.Append(LINKFLAGS=["-Wl,-dead_strip", "-Wl,-install_name,@rpath/${TARGET.file}"])
    if platform == "web":
        env.Append(LINKFLAGS=["-sSIDE_MODULE=2", "-sEXPORTED_FUNCTIONS=_thicket_library_init", "-sWASM_BIGINT"])
        # emscripten's linker only warns if two objects declare a function differently, but a call to that function
        # would trap.
        env.Append(LINKFLAGS=["-sSUPPORT_LONGJMP=wasm", "-Wl,--fatal-warnings"])
        return
    if env["use_zig"]:
        return  # zig links its own C++ library and creates no unique symbols.
    gnu = is_gnu(env)
    if gnu:
        # A library with a unique symbol is never unloaded, so a reload would still run the old code.
        env.Append(CXXFLAGS=["-fno-gnu-unique"])
    if gnu and platform == "windows":
        env.Append(LINKFLAGS=["-static"])  # Includes the threading library, which Windows does not have.
    elif release and not env["sanitize"] and (gnu or platform == "linux"):
        env.Append(LINKFLAGS=["-static-libstdc++", "-static-libgcc"])


def extra_sources(env):
    """Returns additional sources that the extension needs on this platform with this compiler."""
    # zig's start files do not call destructors when a library is closed, so its static objects would outlive its code.
    return ["tools/scons/unload.cpp"] if env["use_zig"] and env["platform"] == "linux" else []
