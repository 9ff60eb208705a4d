#!/usr/bin/env bash
# Builds the documentation site into build/docs/html, or into the folder in the first argument. A broken link, a missing
# image, or an unknown class or member is an error. Works offline once setup_docs has run.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_docs
setup_godot
out=${1:-build/docs/html}
python=$(docs_venv)/bin/python
"$python" docs/class_reference.py
"$python" docs/plots.py
"$python" -m sphinx --builder html --fail-on-warning --keep-going --nitpicky --fresh-env --quiet \
	--doctree-dir build/docs/doctrees docs "$out"
say "the documentation is in $out: open index.html"
