# Finds programs and folders. tools/godot and tools/setup.sh source this file. A Debian root is a folder with a minimal Debian
# system, in which a program runs that the machine's system does not provide.

# Prints the path of the folder for everything that is installed once and shared by all checkouts.
cache_folder() {
	echo "${THICKET_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/thicket}"
}

# Prints the number of CPU cores. macOS does not have nproc.
core_count() {
	getconf _NPROCESSORS_ONLN
}

# Reads from standard input or FILE... like sha256sum, which macOS does not have.
sha256() {
	if command -v sha256sum >/dev/null; then
		sha256sum "$@"
	else
		shasum -a 256 "$@"
	fi
}

# time_limit SECONDS COMMAND...: runs a command and ends it after a time. Without the program timeout, as on macOS, there is no limit.
time_limit() {
	if command -v timeout >/dev/null; then
		timeout "$@"
	else
		"${@:2}"
	fi
}

# Prints the path of the Debian root of Godot, which may not exist.
godot_root() {
	echo "$(cache_folder)/godot-root"
}

# Prints the path of the Debian root of emscripten, which may not exist.
emscripten_root() {
	echo "$(cache_folder)/emscripten-root"
}

# Prints the version of the Python that the package is built for, such as 3.12, or 3.14t for a free-threaded one.
wheel_python() {
	"${PYTHON:-python3}" -c 'import sys, sysconfig; print("%d.%d%s" % (*sys.version_info[:2], "t" if sysconfig.get_config_var("Py_GIL_DISABLED") else ""))'
}

# Prints the folder of the virtual environment that builds the package.
wheel_venv() {
	echo "$(cache_folder)/wheel-python$(wheel_python)"
}

# Prints the folder of the virtual environment for the tests.
python_venv() {
	echo "$(cache_folder)/venv"
}

# Prints the folder of the virtual environment that builds the documentation.
docs_venv() {
	echo "$(cache_folder)/docs-venv"
}

# Prints the folder of the virtual environment for world bakes.
bake_venv() {
	echo "$(cache_folder)/bake-venv"
}

# Succeeds if the program's version is Godot 4.4 or newer.
is_new_godot() {
	local version
	version=$("$1" --version 2>/dev/null </dev/null | tail -n 1) || return 1
	[[ $version =~ ^([0-9]+)\.([0-9]+) ]] || return 1
	((BASH_REMATCH[1] > 4 || (BASH_REMATCH[1] == 4 && BASH_REMATCH[2] >= 4)))
}

# Prints the path of a Godot 4.4 or newer that runs without a Debian root: $GODOT, otherwise godot or godot4 on the
# PATH. Prints nothing if there is none. If $GODOT is set but unusable, fails instead of using another Godot.
find_native_godot() {
	local candidate
	if [[ -n ${GODOT:-} ]]; then
		candidate=$(command -v "$GODOT") && is_new_godot "$candidate" || {
			echo "thicket: GODOT=$GODOT is not Godot 4.4 or newer" >&2
			return 1
		}
		echo "$candidate"
		return
	fi
	for candidate in godot godot4; do
		candidate=$(command -v "$candidate") || continue
		# Skip this wrapper, which may itself be on the PATH.
		[[ $(readlink -f "$candidate") != "$(readlink -f "$0")" ]] || continue
		if is_new_godot "$candidate"; then
			echo "$candidate"
			return
		fi
	done
}

# Succeeds if bubblewrap may create the namespaces that enter_root needs. Many containers forbid it.
can_enter_roots() {
	bwrap --unshare-pid --bind / / --proc /proc true 2>/dev/null </dev/null
}

# direct_command ROOT PROGRAM: sets the array `run` to a command that starts a program of a Debian root without bubblewrap. The program
# uses the root's loader, libraries, drivers and fonts. All other paths are those of the machine.
direct_command() {
	local root=$1 loader libraries
	loader=$(compgen -G "$root/usr/lib*/ld-linux*.so.*" | head -n 1)
	libraries=$(printf '%s:' "$root"/usr/lib/*-linux-gnu "$root"/usr/lib/*-linux-gnu/pulseaudio)
	run=(env FONTCONFIG_FILE="$root/etc/fonts/fonts.conf" FONTCONFIG_SYSROOT="$root"
		LIBGL_DRIVERS_PATH="$(printf '%s' "$root"/usr/lib/*-linux-gnu/dri)"
		"$loader" --library-path "${libraries%:}" "$root$2")
}

# enter_root ROOT: sets the array `enter` to a command prefix that runs a program inside a Debian root. The home, cache,
# repository and working folders have the same paths there.
enter_root() {
	local root=$1 repo folder
	repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
	enter=(bwrap --die-with-parent --unshare-pid --bind "$root" / --dev-bind /dev /dev --proc /proc --ro-bind-try /sys /sys)
	enter+=(--ro-bind-try /etc/ssl/certs /etc/ssl/certs)
	for folder in /tmp /run "$HOME" "$(cache_folder)" "$repo" "$PWD"; do
		case $folder/ in
			/ | // | /usr/* | /etc/* | /bin/* | /sbin/* | /lib* | /dev/* | /proc/* | /sys/*) ;; # The Debian root has its own system folders.
			*) [[ ! -d $folder ]] || enter+=(--bind "$folder" "$folder") ;;
		esac
	done
	enter+=(--chdir "$PWD")
}

# Imports new files of the demo project, because Godot does not import files when it only runs a project.
import_demo() {
	local repo stamp
	repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
	stamp=$repo/demo_project/.godot/thicket_imported
	if [[ -f $stamp && -z $(find "$repo/demo_project" -name .godot -prune -o -newer "$stamp" -print -quit) ]]; then
		return
	fi
	# List the extension in advance. Godot would list a new extension only after parsing all scripts, and would report
	# errors in those that use it.
	mkdir -p "${stamp%/*}"
	[[ -f ${stamp%/*}/extension_list.cfg ]] ||
		echo res://addons/thicket/thicket.gdextension >"${stamp%/*}/extension_list.cfg"
	"$repo/tools/godot" --headless --path "$repo/demo_project" --import </dev/null
	touch "$stamp"
}
