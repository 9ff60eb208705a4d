#!/usr/bin/env bash
# Builds the Python package into build/python, for this machine's Python ($PYTHON, else python3), and installs the required tools:
#   bash python/build.sh             build/python/poissontiles-VERSION-....whl
#   bash python/build.sh --install   also installs it into that Python: activate a virtual environment first
#   bash python/build.sh --manylinux wheels for any Linux since 2014 on x86-64 and ARM; needs Python 3.12 or newer
#   bash python/build.sh --sdist     build/python/poissontiles-VERSION.tar.gz instead, which contains all sources and builds anywhere
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."
source tools/setup.sh

setup_core_sources
setup_wheel
out=build/python
mkdir -p "$out"
partial=$(mktemp --directory "$out/partial.XXXXXX")
trap 'rm -rf "$partial"' EXIT
# Copies everything that the package consists of into one folder, as a source distribution requires.
collect_sources() {
	local sources=$1 highway glm
	mkdir -p "$sources/extension/core" "$sources/vendor/highway/hwy" "$sources/vendor/glm"
	cp -r python/{CMakeLists.txt,README.md,plugin_cfg.py,pyproject.toml,src,poissontiles} LICENSE demo_project/addons/thicket/plugin.cfg "$sources"
	cp -r extension/core/{base,sampling,surface,terrain} "$sources/extension/core"
	highway=$(cache_folder)/highway-$highway_version
	cp -r "$highway"/LICENSE* "$sources/vendor/highway"
	cp -r "$highway"/hwy/{*.h,*.cc,ops} "$sources/vendor/highway/hwy"
	glm=$("${CXX:-g++}" -std=c++20 -x c++ -M - <<<'#include <glm/glm.hpp>' | grep -o '[^ ]*/glm/glm\.hpp' | head -n 1)
	glm=${glm%/glm.hpp}
	cp -r "$glm" "$sources/vendor/glm"
	cp "${glm%/include/glm}/share/doc/libglm-dev/copyright" "$sources/vendor/glm/LICENSE"
	find "$sources" -name __pycache__ -prune -exec rm -r {} +
}

if [[ ${1:-} == --sdist ]]; then
	say "collecting the sources of the Python package"
	collect_sources "$partial/sources"
	(cd "$partial/sources" && "$(wheel_venv)/bin/python" -c 'from scikit_build_core.build import build_sdist; build_sdist("..")') >/dev/null
	source=$(basename "$partial"/poissontiles-*.tar.gz)
	mv "$partial/$source" "$out/$source"
	say "$out/$source"
	exit
fi
say "building the Python package"
# The environment already contains everything, so pip needs no network.
PATH=$(wheel_venv)/bin:$PATH "$(wheel_venv)/bin/python" -m pip wheel ./python --quiet --disable-pip-version-check --no-deps \
	--no-build-isolation --wheel-dir "$partial" --config-settings=cmake.define.THICKET_HIGHWAY="$(cache_folder)/highway-$highway_version"
wheel=$(basename "$partial"/poissontiles-*.whl)
mv "$partial/$wheel" "$out/$wheel"
say "$out/$wheel"
if [[ ${1:-} == --manylinux ]]; then
	setup_zig
	"$(wheel_venv)/bin/python" python/manylinux.py "$out/$wheel" "$out" | while read -r each; do say "$each"; done
fi
if [[ ${1:-} == --install ]]; then
	"${PYTHON:-python3}" -m pip install --disable-pip-version-check --force-reinstall --no-deps "$out/$wheel"
	"${PYTHON:-python3}" -m pip install --disable-pip-version-check "$out/$wheel"
fi
