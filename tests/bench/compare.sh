#!/usr/bin/env bash
# Builds the benchmarks of two commits, runs them alternately, and reports rows that differ by more than the noise (see
# compare.py):
#   bash tests/bench/compare.sh HEAD~1
#   bash tests/bench/compare.sh 1c96ef9 main --turns 12 --programs bench_sampler
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh
setup_compiler >&2
setup_baselines >&2
[[ " $* " != *" --engine"* ]] || setup_godot >&2
exec python3 tests/bench/compare.py "$@"
