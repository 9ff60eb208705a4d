#!/usr/bin/env bash
# Builds the benchmarks and the extension for release, runs them, and prints one Markdown table. Takes a quarter of an
# hour after building, on two otherwise idle cores. Arguments: [rounds = 9] [seconds = 0.25] for the C++ programs,
# preceded by options:
#   --write        also store the rows in tests/bench/data/speed.json, and write the tables of docs/benchmarks.md from them (speed_table.py)
#   --only A,B     measure only these parts; with --write, keep the rows of the other parts
# Times are CPU time, and contenders take turns within each round, so that a busy machine affects all equally. Only the times of
# the main thread, of workers and of the response to a change are wall time, which a busy machine increases. The parts from
# streaming on run in the engine, in the editor's binary with the release library.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh

parts=" sampler tile fields shapes streamer library streaming drawn flight views workers response terrains rules rectangles gameplay spikes cancel"
parts+=" collision navigation import load soak "
write=
only=
while [[ ${1:-} == --* ]]; do
	case $1 in
	--write) write=yes ;;
	--only)
		only=${2:?--only needs names of parts}
		shift
		;;
	*)
		say "no such option: $1"
		exit 2
		;;
	esac
	shift
done
for part in ${only//,/ }; do
	if [[ $parts != *" $part "* ]]; then
		say "--only must be followed by some of$parts, got $part"
		exit 2
	fi
done
effort=("$@")
root=$PWD
rows=$root/build/bench/rows
project=$root/build/bench/project
rm -rf "$rows" "$project"
mkdir -p "$rows"

setup_compiler >&2
setup_compiler_cache >&2
setup_baselines >&2
setup_godot >&2
scons -Q -j"$(nproc)" target=template_release bench >&2
shopt -s nullglob
programs=(build/*.template_release.*/bench)
sampler=$root/${programs[0]}/bench_sampler

# Creates a copy of the demo with only the release library, which its manifest then uses for all features.
release_project() {
	scons -Q -j"$(nproc)" target=template_release extension >&2
	import_demo >&2
	cp --recursive --symbolic-link "$root/demo_project" "$project"
	local addon=$project/addons/thicket
	rm -rf "$addon/bin" "$addon/thicket.gdextension"
	mkdir "$addon/bin"
	cp demo_project/addons/thicket/bin/libthicket.*.template_release.* "$addon/bin"
	sed 's/template_debug/template_release/' demo_project/addons/thicket/thicket.gdextension >"$addon/thicket.gdextension"
}

wanted() {
	[[ -z $only || ,$only, == *",$1,"* ]]
}

# measure PART COMMAND...: runs a part and prints and stores its rows.
measure() {
	local part=$1
	shift
	wanted "$part" || return 0
	say "measuring $part"
	"$@" </dev/null | { grep '^|' || true; } | tee "$rows/$part"
}

in_engine() {
	local script=$1
	shift
	[[ -d $project ]] || release_project
	tools/godot "${display:---headless}" --path "$project" --script "$root/tests/bench/$script.gd" -- "$@"
}

processor=$(sed -n 's/^model name[[:space:]]*: //p;T;q' /proc/cpuinfo 2>/dev/null || true)
machine="$(nproc) cores of ${processor:-$(uname -m)}, $("${CXX:-g++}" --version | head -n 1), -O3"
echo "Measured on $machine, $(date +%F)."
echo
echo "| measurement | median | lowest to highest round | rounds |"
echo "|---|---|---|---|"
sampler_rows() {
	"$sampler" "${effort[@]}"
	"$sampler" 1 1 counts
}
measure sampler sampler_rows
for part in tile fields shapes; do
	measure "$part" "${programs[0]}/bench_$part" "${effort[@]}"
done
measure streamer "${programs[0]}/bench_streamer"
if wanted library; then
	bash tools/package.sh windows.x86_64 >&2
	measure library python3 tests/bench/library.py
fi
measure streaming in_engine streaming
display=--xvfb measure drawn in_engine streaming
measure flight in_engine flight
display=--xvfb measure views in_engine views
measure workers in_engine workers 5 "$sampler"
for part in response terrains rules rectangles gameplay spikes cancel collision navigation import load; do
	measure "$part" in_engine "$part"
done
# Like the soak test, this fails with 1 if anything grew. malloc returns free memory immediately, as in test_soak.py.
MALLOC_ARENA_MAX=1 MALLOC_MMAP_THRESHOLD_=131072 MALLOC_TRIM_THRESHOLD_=131072 measure soak in_engine soak 180
[[ -z $write ]] || python3 tests/bench/speed_table.py --machine "$machine" "$rows"
