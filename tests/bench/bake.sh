#!/usr/bin/env bash
# Measures how a bake's speed grows with its workers, and whether the forecast is accurate; see bake.py. Arguments:
# [rounds = 3].
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh
setup_compiler >&2
setup_godot >&2
setup_bake >&2
scons -Q -j"$(nproc)" extension >&2
import_demo >&2
PYTHONPATH=tools/bake exec "$(bake_venv)/bin/python" tests/bench/bake.py "$@" </dev/null
