#!/usr/bin/env bash
# Sets up, builds the extension, and runs the demo: in a window where there is a display; without one, drawn in
# software along a fixed path, with pictures in build/demo and figures on the terminal. Arguments go to the demo:
#   bash demo_project/run.sh -- --screenshots=build/demo
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_compiler
setup_godot
say "building the extension"
scons -Q -j"$(nproc)" extension
import_demo

if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} && -z ${CI:-} ]]; then
	exec tools/godot --path demo_project "$@"
fi
say "no display: drawing in software, pictures go to build/demo"
mkdir -p build/demo
tools/godot --xvfb --path demo_project --resolution 1280x720 "$@" -- --screenshots="$PWD/build/demo" </dev/null
for picture in build/demo/*.png; do
	[[ -s $picture ]] || { say "the demo wrote no picture"; exit 1; }
	say "wrote $picture"
done
