"""Defines the platforms for which Thicket is built, with the names that godot-cpp and the compilers use for them."""

import platform as host
from dataclasses import dataclass


@dataclass(frozen=True)
class Platform:
    """The properties of a platform."""

    archs: tuple[str, ...]
    suffix: str  # The file name suffix of a library.
    program: str = ""  # The file name suffix of a program.
    defines: tuple[str, ...] = ()  # The same definitions as in godot-cpp, which code that is linked with it needs.


PLATFORMS = {
    "linux": Platform(("x86_64", "arm64", "x86_32", "rv64"), ".so", defines=("LINUX_ENABLED", "UNIX_ENABLED")),
    "windows": Platform(("x86_64", "arm64", "x86_32"), ".dll", ".exe", ("WINDOWS_ENABLED",)),
    "macos": Platform(("x86_64", "arm64", "universal"), ".dylib", defines=("MACOS_ENABLED", "UNIX_ENABLED")),
    "web": Platform(("wasm32",), ".wasm", ".js", ("WEB_ENABLED", "UNIX_ENABLED")),
    "android": Platform(("arm64", "x86_64"), ".so", defines=("ANDROID_ENABLED", "UNIX_ENABLED")),
}

# zig's names for a platform and an architecture, with the oldest supported system. glibc 2.17 was released in 2012.
# riscv64 needs 2.27.
ZIG_TARGETS = {
    ("linux", "x86_64"): "x86_64-linux-gnu.2.17",
    ("linux", "arm64"): "aarch64-linux-gnu.2.17",
    ("linux", "x86_32"): "x86-linux-gnu.2.17",
    ("linux", "rv64"): "riscv64-linux-gnu.2.27",
    ("windows", "x86_64"): "x86_64-windows-gnu",
    ("windows", "arm64"): "aarch64-windows-gnu",
    ("windows", "x86_32"): "x86-windows-gnu",
    ("macos", "x86_64"): "x86_64-macos.11.0",
    ("macos", "arm64"): "aarch64-macos.11.0",
}


def native_platform():
    return {"Linux": "linux", "Darwin": "macos", "Windows": "windows"}.get(host.system(), host.system().lower())


def native_arch():
    machine = host.machine().lower()
    return {"amd64": "x86_64", "aarch64": "arm64", "i686": "x86_32", "riscv64": "rv64"}.get(machine, machine)


def problem(env):
    """Returns a message that explains why these options are invalid, or None if they are valid."""
    platform, arch = env["platform"], env["arch"]
    if platform not in PLATFORMS:
        return "platform must be one of %s, got %s" % (", ".join(PLATFORMS), platform)
    known = PLATFORMS[platform].archs
    if arch not in known:
        return "arch=%s is not one of %s, the architectures of platform=%s" % (arch, ", ".join(known), platform)
    if env["use_zig"] and (platform, arch) == ("macos", "universal"):
        return "arch=universal: zig builds one architecture at a time; tools/package.sh merges x86_64 and arm64"
    if env["use_zig"] and (platform, arch) not in ZIG_TARGETS:
        return "use_zig=yes cannot build for platform=%s: set CXX to a compiler that can" % platform
    if not env["threads"] and platform != "web":
        return "threads=no is for platform=web only"
    return None


def zig_target(env):
    return ZIG_TARGETS[env["platform"], env["arch"]]


def is_native(env):
    """Returns whether the platform and the architecture match this machine. arch=universal is treated as another
    architecture."""
    return (env["platform"], env["arch"]) == (native_platform(), native_arch())


def precision_suffix(precision):
    """Returns the part of a folder's or library's name that depends on the precision."""
    return ".double" if precision == "double" else ""


def folder_name(env, kind, precision, compiler):
    """Returns the name of the build folder. `kind` is a target, or "ship" for a release. `compiler` is "" for the
    default compiler."""
    name = "%s.%s.%s" % (env["platform"], kind, env["arch"]) + precision_suffix(precision)
    name += "" if env["threads"] else ".nothreads"
    return name + ("." + compiler if compiler else "")


def library_name(env, target):
    """Returns the name of a library with these options, in godot-cpp's style, without `lib` and the suffix:
    thicket.linux.template_debug.x86_64."""
    name = "%s.%s" % (env["platform"], target) + precision_suffix(env["precision"])
    name += "" if env["arch"] == "universal" else ".%s" % env["arch"]
    return "thicket." + name + ("" if env["threads"] else ".nothreads")
