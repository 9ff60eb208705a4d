#!/usr/bin/env bash
# Makes the pictures of the add-on's tutorials anew: those of the editor and of the server by taking the pages' steps, as the tests do,
# and that of the game by playing the demo. All is drawn in software, in two minutes:
#   bash tools/tutorial_pictures.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_compiler
setup_python
setup_godot
say "building the extension"
scons -Q -j"$(nproc)" extension
import_demo

python=$(python_venv)/bin/python
game=build/tutorials
say "taking the steps of the pages"
"$python" -m pytest -q -n 0 tests/test_tutorials.py -k "steps or players" </dev/null
say "playing the demo"
timeout 600 tools/godot --xvfb --path demo_project res://gameplay.tscn -- --screenshots="$PWD/$game" </dev/null
"$python" tools/tutorial_pictures.py build/editor "$game" demo_project/addons/thicket/tutorials
