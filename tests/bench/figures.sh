#!/usr/bin/env bash
# Reproduces the figures of the paper on which the sampler is based. Builds for release, measures, and writes tables,
# plots and a page into build/figures. Also writes the data of the page and plots into tests/bench/data/figures.json.
# Takes about an hour, half of it for the sets that fill the memory (--only large). Nothing else should run on the
# machine during that time. Options:
#   --render        measure nothing; write the page and plots into build/figures from tests/bench/data, in seconds
#   --quick         small sizes, to check that everything works; does not change tests/bench/data
#   --out DIR       the folder for tables and plots, instead of build/figures
#   --only PART     measure only one of speed, sets, memory, large, billion, and keep the other tables. Can be repeated
#   --minutes N     skip sets that fill the memory (--only large) if one would take longer. Default: an hour
#   --redraw        measure nothing; draw and write from the existing tables
#   --programs DIR  measure the programs in this build folder; build nothing
set -euo pipefail
from=$PWD
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tests/bench/peers/setup.sh

# in_callers_folder OPTION FOLDER: prints the absolute path of FOLDER, which is relative to the folder where the command
# was called.
in_callers_folder() {
	if [[ -z ${2:-} ]]; then
		say "$1 must be followed by a folder"
		return 2
	fi
	(cd "$from" && realpath --canonicalize-missing -- "$2")
}

arguments=()
programs=
redraw=
while (($#)); do
	case $1 in
	--quick) arguments+=("$1") ;;
	--only)
		if [[ ! ${2:-} =~ ^(speed|sets|memory|large|billion)$ ]]; then
			say "--only must be followed by one of speed, sets, memory, large, billion"
			exit 2
		fi
		arguments+=("$1" "$2")
		shift
		;;
	--minutes)
		if [[ ! ${2:-} =~ ^[0-9]+$ ]]; then
			say "--minutes must be an integer"
			exit 2
		fi
		arguments+=("$1" "$2")
		shift
		;;
	--redraw | --render) redraw=$1 && arguments+=("$1") ;;
	--out | --programs)
		folder=$(in_callers_folder "$@")
		if [[ $1 == --out ]]; then arguments+=("$1" "$folder"); else programs=$folder; fi
		shift
		;;
	*)
		say "no such option: $1 (see the head of tests/bench/figures.sh)"
		exit 2
		;;
	esac
	shift
done

setup_python
if [[ -z $programs && -z $redraw ]]; then
	setup_compiler
	setup_baselines
	setup_peers_python || true
	setup_peers_rust || true
	say "building for release"
	scons -Q -j"$(nproc)" target=template_release bench compiledb >&2
fi
if [[ -z $programs ]]; then
	shopt -s nullglob
	folders=(build/*.template_release.*/bench)
	programs=$(dirname "${folders[0]:-build/none/bench}")
fi
PYTHONPATH=tests PYTHONDONTWRITEBYTECODE=1 exec "$(python_venv)/bin/python" -m bench.figures --programs "$programs" \
	--peers-python "$(peers_python)" --peers-rust build/peers/faster_poisson "${arguments[@]}" </dev/null
