#!/usr/bin/env bash
# Prints the matrix of the same bits as a table; see matrix.py. Takes about an hour on two cores where nothing is compiled yet.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh

setup_compiler
setup_clang
setup_python
setup_zig
setup_emulators
exec "$(python_venv)/bin/python" tests/golden/matrix.py "$@"
