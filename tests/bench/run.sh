#!/usr/bin/env bash
# Builds the benches for release, runs them, and prints one Markdown table. Arguments: [rounds = 9] [seconds = 0.25].
# Times are processor time and contenders take turns within each round, so that a busy machine disturbs all alike.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh
setup_compiler >&2
scons -Q -j"$(nproc)" target=template_release bench >&2

shopt -s nullglob
folders=(build/*.template_release.*/bench)
processor=$(sed -n 's/^model name[[:space:]]*: //p;T;q' /proc/cpuinfo 2>/dev/null || true)
echo "Measured on one core of ${processor:-$(uname -m)}, $("${CXX:-g++}" --version | head -n 1), -O3, $(date +%F)."
echo
echo "| what | median | lowest to highest round | rounds |"
echo "|---|---|---|---|"
for program in bench_sampler bench_tile; do
	"${folders[0]}/$program" "$@"
done
