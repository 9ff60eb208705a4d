#!/usr/bin/env bash
# Installs missing dependencies, builds the extension, and bakes the world of a scene. Writes a Parquet file for each
# tile, a map and a report. Continues an unfinished bake in the folder. tools/bake/README.md describes the files and the
# options; --help lists them:
#   bash demo_project/bake.sh demo.tscn out/ --rect -512,-512,1024,1024
#   bash demo_project/bake.sh ~/game/world.tscn out/ --workers 8
#   bash demo_project/bake.sh tiles/ out/     uses tiles that bake_world.gd has generated, and needs no engine
set -euo pipefail
from=$PWD
made=
store=
for argument; do
	[[ ! -f $argument/world.json ]] || made=yes
	[[ ! $argument =~ ^(s3|gs|az):// ]] || store=yes
done
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
repo=$PWD
source tools/setup.sh

setup_bake
[[ -z $store ]] || setup_stores
if [[ -z $made ]]; then
	setup_compiler
	setup_godot
	say "building the extension"
	scons -Q -j"$(nproc)" extension >&2
	import_demo >&2
fi
cd "$from"
PYTHONPATH=$repo/tools/bake exec "$(bake_venv)/bin/python" -m baking "$@"
