#!/usr/bin/env bash
# Measures the speedup of a bake with two workers, and the accuracy of its forecast (see bake.py). Arguments: [rounds =
# 3].
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh
setup_compiler >&2
setup_godot >&2
setup_bake >&2
scons -Q -j"$(nproc)" extension >&2
import_demo >&2
PYTHONPATH=tools/bake exec "$(bake_venv)/bin/python" tests/bench/bake.py "$@" </dev/null
