#!/usr/bin/env bash
# Builds Thicket for every platform and packs the release files into build/dist:
#   thicket-VERSION.zip          the add-on: libraries, editor tools, shaders, presets, C# wrappers, licenses
#   thicket-demo-VERSION.zip     the demo project with the add-on in it
#   symbols/                     the libraries with their debug symbols, for crash reports
#   SHA256SUMS                   the checksums of the zips
# Identical sources produce identical zips. Takes about 20 minutes on two cores. The arguments are names of builds, as in the
# names of the libraries. Without arguments, builds all of them:
#   bash tools/package.sh linux.x86_64 windows.x86_64.double
#   bash tools/package.sh --list
#   bash tools/package.sh --engine-api build/engine linux.x86_64   build without Godot
#   bash tools/package.sh --built                                  pack what is built
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh
export PYTHONDONTWRITEBYTECODE=1

if [[ ${1:-} != --list ]]; then
	setup_compiler
	setup_llvm
	setup_zig
	# Packing does not need Godot, nor does a build for which Godot has already written its API.
	[[ " $* " == *" --built "* || " $* " == *" --engine-api"* ]] || setup_godot
	[[ " $* " == *" --built "* ]] ||
		[[ $'\n'$(python3 tools/package/package.py --list "$@") != *$'\n'web.* ]] || setup_emscripten
fi
exec python3 tools/package/package.py "$@"
