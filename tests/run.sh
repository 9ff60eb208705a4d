#!/usr/bin/env bash
# Sets up the tools, builds everything, and runs all tests with one more worker than there are cores, at most four.
# Arguments are passed to pytest:
#   bash tests/run.sh -k sampler
#   bash tests/run.sh -n 0        runs one test after the other, in the order of their files
#   bash tests/run.sh --full      includes slow tests: longer soaks, fuzzers and sanitizers, and complete matrices
set -euo pipefail
from=$PWD
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_check godot tests
setup_compiler
setup_baselines
setup_clang
setup_compiler_cache
setup_mono
setup_python
setup_exports
setup_stores
setup_wheel
setup_docs
setup_browser
setup_godot
setup_qemu
if [[ " $* " == *" --full "* ]]; then
	setup_zig
	setup_llvm
	setup_coverage
	setup_emulators
	setup_descriptions
	setup_android_engines
	setup_godot_sources
	setup_gltf_validator
	setup_bake_tests
	setup_ffmpeg
	setup_web_engine
	setup_workflow_checkers
	setup_export_template
	setup_godot_arm64
fi
say "building"
scons -Q -j"$(core_count)"

arguments=()
for argument in "$@"; do
	# A path, possibly followed by ::test, is relative to the working directory of the caller.
	[[ $argument != /* && $argument != -* && -e $from/${argument%%::*} ]] && argument=$from/$argument
	arguments+=("$argument")
done
# One more worker than cores, because tests spend about a third of their time waiting for engine frames or timers.
workers=$(($(core_count) + 1))
((workers <= 4)) || workers=4
exec "$(python_venv)/bin/python" -m pytest -n "$workers" --dist loadgroup --no-loadscope-reorder ${arguments[@]+"${arguments[@]}"} </dev/null
