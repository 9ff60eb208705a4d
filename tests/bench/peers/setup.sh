# Installs and builds the samplers of other projects that the benchmarks compare with. tests/bench/figures.sh and
# surfaces.sh source this file.
#   setup_peers_python   installs the packages of requirements.txt into a virtual environment in the cache folder
#   setup_peers_rust     builds build/peers/faster_poisson with the installed cargo, or a newer one if that is too old
#   peers_python         prints the Python that runs run_python_peer.py
#   setup_peers_surface  installs the packages of surface_requirements.txt into a virtual environment
#   peers_surface_python prints the Python that runs surfaces.py
# Each function prints its actions and has no effect if everything is installed. If it fails, it prints the reason, and
# the benchmarks continue without that peer.

peers_folder=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
source "$peers_folder/../../../tools/setup.sh"

# faster_poisson uses a Rust edition that was introduced in 1.85.
peers_least_rust=1.85

peers_python() {
	echo "$(cache_folder)/peers/bin/python"
}

peers_surface_python() {
	echo "$(cache_folder)/peers_surface/bin/python"
}

setup_peers_python() {
	setup_peers_venv "$(cache_folder)/peers" requirements.txt
}

setup_peers_surface() {
	setup_peers_venv "$(cache_folder)/peers_surface" surface_requirements.txt
}

# setup_peers_venv FOLDER REQUIREMENTS: creates a virtual environment, unless it already has these packages.
setup_peers_venv() {
	local venv=$1 wanted missing=()
	wanted=$(cat "$peers_folder/$2")
	! has_venv "$venv" "$wanted" || return 0
	python3 -c 'import venv, ensurepip' 2>/dev/null || missing+=(python3 python3-venv)
	install_packages "to compare with Python packages" "${missing[@]}" || return
	say "creating a Python environment for the samplers to compare with in $venv"
	mkdir -p "$venv" && python3 -m venv --clear "$venv" || return
	if ! "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: --requirement "$peers_folder/$2"; then
		say "$(tr '\n' ' ' <"$peers_folder/$2")could not be installed for $("$venv/bin/python" --version): continuing without them"
		return 1
	fi
	echo "$wanted" >"$venv/complete"
}

setup_peers_rust() {
	local package out=$setup_repo/build/peers
	if ! is_new_rust "$(cargo --version 2>/dev/null)"; then
		package=$(newest_cargo_package)
		if [[ -z $package ]]; then
			say "faster_poisson needs Rust $peers_least_rust or newer with its cargo, and neither the PATH nor this" \
				"machine's packages have it: continuing without faster_poisson"
			return 1
		fi
		install_packages "to compare with a Rust crate" "$package" || return
	fi
	# Cargo builds in the build folder, so that nothing is written into the source folders.
	if ! cargo build --quiet --release --locked --manifest-path "$peers_folder/faster_poisson/Cargo.toml" \
		--target-dir "$out/target"; then
		say "faster_poisson could not be built: continuing without it"
		return 1
	fi
	cmp --silent "$out/target/release/faster_poisson_peer" "$out/faster_poisson" ||
		cp "$out/target/release/faster_poisson_peer" "$out/faster_poisson"
}

# Succeeds if a version of cargo or its package is new enough: "cargo 1.95.0 (...)", "1.96.0+dfsg1-1".
is_new_rust() {
	[[ $1 =~ ^(cargo )?1\.([0-9]+) ]] && ((BASH_REMATCH[2] >= ${peers_least_rust#1.}))
}

# Prints the name of the Debian package with a new enough cargo, if there is one. Debian 12 has it under another
# name.
newest_cargo_package() {
	local package
	command -v apt-cache >/dev/null || return 0
	for package in cargo cargo-web; do
		if is_new_rust "$(apt-cache policy "$package" | sed -nE 's/^ *Candidate: //p')"; then
			echo "$package"
			return
		fi
	done
}
