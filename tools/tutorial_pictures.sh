#!/usr/bin/env bash
# Regenerates the images of the add-on's tutorials and of the steps in README.md. The tests of these pages take the screenshots of the
# editor and the server, and the demo takes the screenshots of the game. Everything is rendered in software, which takes four
# minutes:
#   bash tools/tutorial_pictures.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_compiler
setup_python
setup_godot
say "building the extension"
scons -Q -j"$(core_count)" extension
import_demo

python=$(python_venv)/bin/python
game=build/tutorials
say "running the steps of the tutorials"
"$python" -m pytest -q -n 0 tests/docs/test_tutorials.py -k "steps or players" </dev/null
say "running the steps of README.md"
"$python" -m pytest -q -n 0 tests/docs/test_newcomer.py -k "steps or grows" </dev/null
say "running the demo"
time_limit 600 tools/godot --xvfb --path demo_project res://gameplay.tscn -- --screenshots="$PWD/$game" </dev/null
"$python" tools/tutorial_pictures.py build/editor "$game" demo_project/addons/thicket/tutorials demo_project/pictures
