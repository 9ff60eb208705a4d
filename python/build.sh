#!/usr/bin/env bash
# Builds the Python package into build/python, for this machine's Python ($PYTHON, else python3), and installs the required tools:
#   bash python/build.sh             build/python/thicket-VERSION-....whl
#   bash python/build.sh --install   also installs it into that Python: activate a virtual environment first
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_core_sources
setup_wheel
out=build/python
mkdir -p "$out"
partial=$(mktemp --directory "$out/partial.XXXXXX")
trap 'rm -rf "$partial"' EXIT
say "building the Python package"
# The environment already contains everything, so pip needs no network.
PATH=$(wheel_venv)/bin:$PATH "$(wheel_venv)/bin/python" -m pip wheel ./python --quiet --disable-pip-version-check --no-deps \
	--no-build-isolation --wheel-dir "$partial" --config-settings=cmake.define.THICKET_HIGHWAY="$(cache_folder)/highway-$highway_version"
wheel=$(basename "$partial"/thicket-*.whl)
mv "$partial/$wheel" "$out/$wheel"
say "$out/$wheel"
if [[ ${1:-} == --install ]]; then
	"${PYTHON:-python3}" -m pip install --disable-pip-version-check --force-reinstall --no-deps "$out/$wheel"
	"${PYTHON:-python3}" -m pip install --disable-pip-version-check "$out/$wheel"
fi
