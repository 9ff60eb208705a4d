#!/usr/bin/env bash
# Sets up, builds the extension, and runs the demo: in a window where there is a display; without one, drawn in
# software along a fixed path, with pictures in build/demo and figures on the terminal. Arguments go to the demo, which
# tells of them in demo/main.gd:
#   bash demo_project/run.sh --seed=7
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_compiler
setup_godot
say "building the extension"
scons -Q -j"$(nproc)" extension
import_demo

if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} && -z ${CI:-} ]]; then
	exec tools/godot --path demo_project -- "$@"
fi
say "no display: drawing in software, which takes a few minutes"
rm -f build/demo/*.png
# A demo that cannot start does not end by itself.
timeout 1200 tools/godot --xvfb --path demo_project -- --screenshots="$PWD/build/demo" "$@" </dev/null
say "the pictures lie in build/demo"
