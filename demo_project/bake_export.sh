#!/usr/bin/env bash
# Installs the required programs and exports a bake:
#   bash demo_project/bake_export.sh BAKE godot FOLDER   a world in a project, which ScatterBakedWorld streams without the extension
#   bash demo_project/bake_export.sh BAKE gltf FOLDER    a .glb for each tile, with EXT_mesh_gpu_instancing
#   bash demo_project/bake_export.sh BAKE usd FOLDER     a USD stage with point instancers and a payload for each tile
#   bash demo_project/bake_export.sh BAKE geoparquet FOLDER   a GeoParquet file for each tile
#   bash demo_project/bake_export.sh BAKE maps FOLDER    a gray PNG for each layer, in plan view
# Options come last; --help instead of FOLDER lists them. tools/bake/READERS.md describes all exports.
set -euo pipefail
repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
source "$repo/tools/setup.sh"

if (($# < 3)) || [[ ! $2 =~ ^(godot|gltf|usd|geoparquet|maps)$ ]]; then
	sed -n '2,8s/^# \?//p' "${BASH_SOURCE[0]}" >&2
	exit 2
fi
[[ ! $1 =~ ^(s3|gs|az):// ]] || setup_stores
if [[ $2 =~ ^(usd|geoparquet)$ ]]; then
	setup_exports
else
	setup_bake
fi
[[ $2 =~ ^(geoparquet|maps)$ ]] || setup_godot
# Prevents Python from importing files of the caller's folder as modules.
PYTHONSAFEPATH=1 PYTHONPATH=$repo/tools/bake exec "$(bake_venv)/bin/python" -m reading "$@"
