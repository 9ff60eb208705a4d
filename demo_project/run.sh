#!/usr/bin/env bash
# Installs missing dependencies, builds the extension, and runs a scene of the demo in a window. Without a display, renders in software
# from fixed camera positions, writes screenshots to build/demo and prints statistics. The first argument is the scene's
# name, demo by default. The other arguments are passed to the scene; demo/stage.gd describes them:
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

setup_check godot
setup_compiler
setup_godot
say "building the extension"
scons -Q -j"$(core_count)" extension
import_demo

if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} && -z ${CI:-} ]]; then
	exec tools/godot --path demo_project "res://$scene.tscn" -- "$@"
fi
say "no display: rendering in software, which takes a few minutes"
rm -f "$pictures"/*.png
# The timeout ends a demo that cannot start, because it does not exit on its own.
time_limit 1200 tools/godot --xvfb --path demo_project "res://$scene.tscn" -- --screenshots="$pictures" "$@" </dev/null
say "the screenshots are in ${pictures#"$PWD"/}"
