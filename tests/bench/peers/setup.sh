# Installs and builds the samplers of other projects that the benches compare with. tests/bench/figures.sh sources this.
#   setup_peers_python   the packages of requirements.txt, in their own virtual environment in the cache folder
#   setup_peers_rust     builds build/peers/faster_poisson, with the installed cargo if it is new enough
#   peers_python         prints the Python that runs run_python_peer.py
# Each prints its actions, and does nothing if everything is installed. If one cannot do its work, it prints the reason
# and fails, and the benches continue without that peer.

peers_folder=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
source "$peers_folder/../../../tools/setup.sh"

# faster_poisson is written in an edition of Rust that was introduced in 1.85.
peers_least_rust=1.85

peers_python() {
	echo "$(cache_folder)/peers/bin/python"
}

setup_peers_python() {
	local venv stamp wanted missing=()
	venv=$(cache_folder)/peers
	stamp=$venv/complete
	wanted=$(cat "$peers_folder/requirements.txt")
	if [[ -f $stamp && $(<"$stamp") == "$wanted" && -x $(peers_python) ]]; then
		return
	fi
	python3 -c 'import venv, ensurepip' 2>/dev/null || missing+=(python3 python3-venv)
	install_packages "to compare with Python packages" "${missing[@]}" || return
	say "creating a Python environment for the samplers to compare with in $venv"
	mkdir -p "$venv" && python3 -m venv --clear "$venv" || return
	if ! "$(peers_python)" -m pip install --quiet --disable-pip-version-check --only-binary :all: \
		--requirement "$peers_folder/requirements.txt"; then
		say "hdt_sampling and scipy could not be installed for $("$(peers_python)" --version): continuing without them"
		return 1
	fi
	echo "$wanted" >"$stamp"
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
	# In a folder of the build, so that nothing is written into the source folders.
	if ! cargo build --quiet --release --locked --manifest-path "$peers_folder/faster_poisson/Cargo.toml" \
		--target-dir "$out/target"; then
		say "faster_poisson could not be built: continuing without it"
		return 1
	fi
	cmp --silent "$out/target/release/faster_poisson_peer" "$out/faster_poisson" ||
		cp "$out/target/release/faster_poisson_peer" "$out/faster_poisson"
}

# True if the version printed by cargo or its package is new enough: "cargo 1.95.0 (...)", "1.96.0+dfsg1-1".
is_new_rust() {
	[[ $1 =~ ^(cargo )?1\.([0-9]+) ]] && ((BASH_REMATCH[2] >= ${peers_least_rust#1.}))
}

# Prints the Debian package with a new enough cargo, if there is one. Debian 12 has it under a second name.
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
