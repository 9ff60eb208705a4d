"""Prepares linked libraries for shipping: copies the symbols, strips the libraries, and merges the architectures of
macOS."""

import plistlib
import shutil
import subprocess

import contents
import signing

TARGETS = ("template_debug", "template_release")


def tool(name):
    """Returns the path of an LLVM tool. LLVM tools support the files of all platforms. In Debian, their names may end
    with a version."""
    path = shutil.which(name) or next(filter(None, (shutil.which("%s-%d" % (name, version)) for version in range(30, 13, -1))), None)
    if path is None:
        raise SystemExit("thicket: %s is missing: run bash tools/package.sh, which installs LLVM" % name)
    return path


def run(*command):
    subprocess.run([str(argument) for argument in command], check=True)


def collect(builds, folder, symbols):
    """Writes stripped libraries of all builds to `folder` and copies the originals with symbols to `symbols`.
    Libraries for the web are not stripped, and those for macOS become frameworks. `builds` is a list of pairs (build,
    its folder)."""
    folder.mkdir(parents=True, exist_ok=True)
    symbols.mkdir(parents=True, exist_ok=True)
    frameworks = {}
    for build, source in builds:
        for target in TARGETS:
            library = find(source, target)
            shutil.copy(library, symbols)
            if build.platform == "macos":
                frameworks.setdefault((target, build.precision), []).append(library)
                continue
            stripped = folder / library.name
            if build.platform == "web":
                shutil.copy(library, stripped)
            else:
                run(tool("llvm-strip"), "--strip-all", "-o", stripped, library)
            stripped.chmod(0o644)
    for (target, precision), libraries in frameworks.items():
        framework(target, precision, libraries, folder)


def find(folder, target):
    libraries = [path for path in folder.glob("libthicket.*.%s.*" % target) if path.suffix in (".so", ".dll", ".dylib", ".wasm")]
    if len(libraries) != 1:
        raise SystemExit("thicket: %s must contain one library for %s, got %d: build it first" % (folder, len(libraries), target))
    return libraries[0]


def framework(target, precision, libraries, folder):
    """Writes a framework with one library for all CPUs, as macOS requires. The part for each CPU gets an ad hoc signature.
    macOS then runs the library, but users who download it must allow it once."""
    name = "libthicket.macos." + target + (".double" if precision == "double" else "")
    identifier = "thicket." + target.replace("_", "-") + "." + precision
    bundle = folder / (name + ".framework")
    (bundle / "Resources").mkdir(parents=True, exist_ok=True)
    slices = []
    for index, library in enumerate(libraries):
        slices.append(bundle / ("part%d" % index))
        shutil.copy(library, slices[-1])
        run(tool("llvm-strip"), "-x", slices[-1])
        slices[-1].write_bytes(signing.sign(slices[-1].read_bytes(), identifier))
    run(tool("llvm-lipo"), "-create", *slices, "-output", bundle / name)
    for slice_ in slices:
        slice_.unlink()
    (bundle / name).chmod(0o755)
    info = {
        "CFBundleExecutable": name,
        "CFBundleIdentifier": identifier,
        "CFBundleInfoDictionaryVersion": "6.0",
        "CFBundleName": name,
        "CFBundlePackageType": "FMWK",
        "CFBundleShortVersionString": contents.version(),
        "CFBundleVersion": contents.version(),
        "LSMinimumSystemVersion": "11.0",
    }
    with open(bundle / "Resources/Info.plist", "wb") as file:
        plistlib.dump(info, file)
