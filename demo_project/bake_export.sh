#!/usr/bin/env bash
# Writes what bake.sh has baked for others, and installs what that takes:
#   bash demo_project/bake_export.sh OUT godot FOLDER [--cell METERS]   scenes that BakedWorld streams without the extension
# FOLDER lies in a project of Godot for the first. --help behind the format tells of all options.
set -euo pipefail
repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
source "$repo/tools/setup.sh"

if (($# < 3)) || [[ ! ${2:-} =~ ^(godot)$ ]]; then
	sed -n '2,4s/^# \?//p' "${BASH_SOURCE[0]}" >&2
	exit 2
fi
bake=$1 format=$2
shift 2
setup_bake
setup_godot
exec "$(bake_venv)/bin/python" "$repo/tools/bake/to_$format.py" "$bake" "$@"
