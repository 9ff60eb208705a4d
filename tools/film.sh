#!/usr/bin/env bash
# Makes the film of README.md and of the documentation: flights over the demo, and the steps of README.md in the editor. Everything is
# rendered in software, which takes about ten minutes on an idle machine:
#   bash tools/film.sh              writes demo_project/pictures/film.webp, film.mp4 and film.jpg
#   bash tools/film.sh --built ...  uses the extension that is already built
#   bash tools/film.sh --short OUT  writes a film with two frames per flight, without the editor, into the folder OUT
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

built=
if [[ ${1:-} == --built ]]; then
	built=yes
	shift
fi
out=demo_project/pictures
frames=$PWD/build/film/frames
flight=()
if [[ ${1:-} == --short ]]; then
	out=$(mkdir -p "$2" && cd "$2" && pwd)
	frames=$out/frames
	flight=(2)
fi

setup_python
setup_godot
setup_ffmpeg
command -v ffmpeg >/dev/null || exit 1
if [[ -z $built ]]; then
	setup_compiler
	say "building the extension"
	scons -Q -j"$(core_count)" extension
fi
import_demo

python=$(python_venv)/bin/python
rm -rf "$frames"
say "rendering the flights"
time_limit 7200 tools/godot --xvfb --fixed-fps 12 --path demo_project --script "$PWD/tools/film/flight.gd" -- \
	"$frames" ${flight[@]+"${flight[@]}"} </dev/null
if ((${#flight[@]} == 0)); then
	say "performing the steps in the editor"
	"$python" -m pytest -q -n 0 --full tests/docs/test_newcomer.py -k frames_of_the_film </dev/null
fi
say "encoding"
"$python" tools/film/encode.py "$frames" "$out"
