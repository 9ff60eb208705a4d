"""Builds and packs a release. Run it through tools/package.sh, which installs the required tools."""

import argparse
import os
import shutil
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import archive
import binaries
import contents  # This import also extends sys.path, for the next import.
import platforms

REPO = Path(__file__).resolve().parents[2]
DIST = REPO / "build/dist"


@dataclass(frozen=True)
class Build:
    """A call to scons that builds libraries for a release."""

    platform: str
    arch: str
    precision: str = "single"
    threads: bool = True

    @property
    def name(self):
        """Returns the part of a library's name that identifies the build."""
        parts = [self.platform, self.arch]
        parts += ["double"] if self.precision == "double" else []
        return ".".join(parts + ([] if self.threads else ["nothreads"]))

    @property
    def compiler(self):
        """Returns the compiler's name for platforms.folder_name."""
        return "" if self.platform == "web" else "zig"

    def options(self):
        """Returns the options for scons."""
        options = ["%s=%s" % (name, {True: "yes", False: "no"}.get(value, value)) for name, value in asdict(self).items()]
        return ["ship=yes", "scu_build=yes", "use_zig=" + ("yes" if self.compiler else "no"), *options]

    def folder(self):
        """Returns the folder into which scons puts the libraries."""
        return REPO / "build" / (platforms.folder_name(asdict(self), "ship", self.precision, self.compiler) + ".scu") / "addon/bin"


DESKTOP = [("linux", "x86_64"), ("linux", "arm64"), ("windows", "x86_64"), ("windows", "arm64"), ("macos", "arm64"), ("macos", "x86_64")]
BUILDS = [
    *(Build(platform, arch) for platform, arch in DESKTOP),
    Build("web", "wasm32"),
    Build("web", "wasm32", threads=False),
    *(Build(platform, arch, "double") for platform, arch in DESKTOP),
]


def arguments():
    parser = argparse.ArgumentParser(prog="tools/package.sh", description=__doc__)
    parser.add_argument("names", nargs="*", help="the names of the builds; all by default")
    parser.add_argument("--list", action="store_true", help="print the names of these builds without building them")
    parser.add_argument("--built", action="store_true", help="pack the existing builds without building again")
    parser.add_argument("--engine-api", metavar="DIR", help="build without Godot, with the files that it wrote to this folder (see scons --help)")
    parser.add_argument("--out", type=Path, default=DIST, help="the folder for the zips")
    options = parser.parse_args()
    names = [build.name for build in BUILDS]
    unknown = [name for name in options.names if name not in names]
    if unknown:
        parser.error("no such build: %s (there are %s)" % (", ".join(unknown), ", ".join(names)))
    return options


def build(builds, engine_api):
    """Runs scons for each build. Builds only the extension, because releases do not contain tests."""
    api = ["engine_api=" + os.path.abspath(engine_api)] if engine_api else []
    for build_ in builds:
        print("thicket: building for %s" % build_.name, file=sys.stderr)
        subprocess.run(["scons", "-Q", "-j%d" % (os.cpu_count() or 1), *build_.options(), *api, "extension"], cwd=REPO, check=True)


def pack(builds, out):
    """Strips the libraries, assembles the add-on, and writes the zips, their checksums and the libraries with symbols.
    Returns the paths of the zips."""
    stage = out / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    addon = stage / "addon/addons/thicket"
    symbols = out / "symbols"
    shutil.rmtree(symbols, ignore_errors=True)
    binaries.collect([(build_, build_.folder()) for build_ in builds], addon / "bin", symbols)
    contents.addon(addon, builds[0].folder().parent)
    contents.beside_addons(stage / "addon")
    contents.demo(stage / "demo", addon)
    version = contents.version()
    zips = [
        archive.write(stage / "addon", out / ("thicket-%s.zip" % version)),
        archive.write(stage / "demo", out / ("thicket-demo-%s.zip" % version)),
    ]
    archive.write_sums(zips, out / "SHA256SUMS")
    shutil.rmtree(stage)
    return zips


def main():
    options = arguments()
    builds = [build_ for build_ in BUILDS if not options.names or build_.name in options.names]
    if options.list:
        print("\n".join(build_.name for build_ in builds))
        return
    if not options.built:
        build(builds, options.engine_api)
    for path in pack(builds, options.out.resolve()):
        print(path)


if __name__ == "__main__":
    main()
