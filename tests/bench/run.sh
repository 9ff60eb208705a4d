#!/usr/bin/env bash
# Builds the benches for release, runs them, and prints one Markdown table. Arguments: [rounds = 9] [seconds = 0.25].
# Times are processor time and contenders take turns within each round, so that a busy machine disturbs all alike; only
# the main thread's share of a frame and the response to a change are time on the clock, which a busy machine lengthens.
# Streaming, flight, views, response, terrains, workers, gameplay, spikes, collision, navigation, import, load and soak run in the
# engine, with the extension of template_debug, as Godot's editor binary loads it.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh
setup_compiler >&2
setup_baselines >&2
setup_godot >&2
scons -Q -j"$(nproc)" target=template_release bench >&2

shopt -s nullglob
folders=(build/*.template_release.*/bench)
processor=$(sed -n 's/^model name[[:space:]]*: //p;T;q' /proc/cpuinfo 2>/dev/null || true)
echo "Measured on one core of ${processor:-$(uname -m)}, $("${CXX:-g++}" --version | head -n 1), -O3, $(date +%F)."
echo
echo "| what | median | lowest to highest round | rounds |"
echo "|---|---|---|---|"
for program in bench_sampler bench_tile bench_fields bench_shapes; do
	"${folders[0]}/$program" "$@"
done

scons -Q -j"$(nproc)" extension >&2
import_demo >&2
tools/godot --xvfb --path demo_project --script "$PWD/tests/bench/streaming.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/flight.gd" </dev/null | grep '^|'
tools/godot --xvfb --path demo_project --script "$PWD/tests/bench/views.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/response.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/terrains.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/workers.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/gameplay.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/spikes.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/collision.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/navigation.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/import.gd" </dev/null | grep '^|'
tools/godot --headless --path demo_project --script "$PWD/tests/bench/load.gd" </dev/null | grep '^|'
# Ends with 1, and so does this, where something grew.
tools/godot --headless --path demo_project --script "$PWD/tests/bench/soak.gd" -- 180 </dev/null | tee /dev/stderr | grep '^|'
