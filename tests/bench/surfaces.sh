#!/usr/bin/env bash
# Compares sample_surface with the samplers of trimesh and Open3D on triangle meshes (see surfaces.py). Arguments:
# [points = 20000] [rounds = 3].
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tests/bench/peers/setup.sh
setup_peers_surface
bash python/build.sh >&2
wheel=$(ls -t build/python/poissontiles-*.whl | head -n 1)
"$(peers_surface_python)" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps "$wheel"
exec "$(peers_surface_python)" tests/bench/surfaces.py "$@" </dev/null
