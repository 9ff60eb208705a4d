#!/usr/bin/env bash
# Sets up, builds the extension, and runs a scene of the demo: in a window where there is a display; without one, drawn
# in software at fixed places, with pictures in build/demo and figures on the terminal. The scene's name comes first, demo
# if there is none; other arguments go to the scene, which tells of them in demo/stage.gd:
#   bash demo_project/run.sh --seed=7
#   bash demo_project/run.sh script_terrain
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

scene=demo
if [[ ${1:-} =~ ^[^-] ]]; then
	scene=$1
	shift
fi
if [[ ! -f demo_project/$scene.tscn ]]; then
	scenes=$(cd demo_project && echo *.tscn)
	say "the demo has no scene '$scene'; it has: ${scenes//.tscn/}"
	exit 2
fi
pictures=$PWD/build/demo
[[ $scene == demo ]] || pictures+=/$scene

setup_compiler
setup_godot
say "building the extension"
scons -Q -j"$(nproc)" extension
import_demo

if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} && -z ${CI:-} ]]; then
	exec tools/godot --path demo_project "res://$scene.tscn" -- "$@"
fi
say "no display: drawing in software, which takes a few minutes"
rm -f "$pictures"/*.png
# A demo that cannot start does not end by itself.
timeout 1200 tools/godot --xvfb --path demo_project "res://$scene.tscn" -- --screenshots="$pictures" "$@" </dev/null
say "the pictures lie in ${pictures#"$PWD"/}"
