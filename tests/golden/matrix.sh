#!/usr/bin/env bash
# Prints the matrix of bit-identical results as a table; see matrix.py. Takes about an hour on two cores if nothing has
# been compiled yet.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh

setup_compiler
setup_clang
setup_python
setup_zig
setup_emulators
exec "$(python_venv)/bin/python" tests/golden/matrix.py "$@"
