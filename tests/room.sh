#!/usr/bin/env bash
# Builds and runs the tests of one room of the core in seconds. Compiles only that room and the rooms that it includes.
#   bash tests/room.sh rules              all cases of the room, except those in tests/core/long_cases.txt
#   bash tests/room.sh rules 'clumps*'    the cases whose names match the pattern
#   bash tests/room.sh --all sampling     all cases, including the long ones
#   bash tests/room.sh --dev rules        in a debug build: scons dev_build=yes
# The rooms are the folders of extension/core, and `domain` for core/sampling/domain. Any other argument is passed to doctest
# (--help lists them).
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

source tools/find.sh

options=()
folder=build/$(uname -s | tr '[:upper:]' '[:lower:]').template_debug.$(uname -m | sed 's/aarch64/arm64/')
patterns=()
while IFS= read -r line; do
	patterns+=("$line")
done < <(grep -v '^#' tests/core/long_cases.txt)
long=("--test-case-exclude=$(IFS=, && echo "${patterns[*]}")")
while [[ ${1:-} == --all || ${1:-} == --dev ]]; do
	case $1 in
		--all) long=() ;;
		--dev) options=(dev_build=yes) folder+=.dev ;;
	esac
	shift
done
room=${1:?a room of extension/core is needed, as in: bash tests/room.sh rules}
shift
[[ ! ${1:-} =~ ^[^-] ]] || { long=("--test-case=$1") && shift; }

scons -Q -j"$(core_count)" ${options[@]+"${options[@]}"} "core_tests_$room"
exec "$folder/core_tests_$room" --no-intro ${long[@]+"${long[@]}"} "$@"
