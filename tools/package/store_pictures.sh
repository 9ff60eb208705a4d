#!/usr/bin/env bash
# Takes the pictures in tools/package/store from the demo: five screenshots, the thumbnail and the icon. Renders in software, which
# takes several minutes. With --built, uses the extension that is already built:
#   bash tools/package/store_pictures.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh

setup_python
setup_godot
if [[ ${1:-} != --built ]]; then
	setup_compiler
	say "building the extension"
	scons -Q -j"$(core_count)" extension
fi
import_demo

taken=$PWD/build/store
rm -rf "$taken"
# take SCENE STOPS: takes a screenshot at each of these stops of a scene of the demo.
take() {
	say "rendering $1: $2"
	time_limit 1800 tools/godot --xvfb --resolution 1920x1080 --path demo_project "res://$1.tscn" -- \
		--screenshots="$taken/$1" --stops="$2" </dev/null
}
take demo overview,walk
take presets forest
take surfaces gorge
take rules shore
tools/godot --headless --script tools/package/store_icon.gd -- "$PWD/demo_project/icon.svg" "$taken/icon.png" </dev/null
"$(python_venv)/bin/python" tools/package/store_pictures.py "$taken" tools/package/store
