# Where things are, for tools/godot and tools/setup.sh, which source this.

# The folder for what is installed once and used by every checkout.
cache_folder() {
	echo "${THICKET_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/thicket}"
}

# The Debian root in which Godot lies, whether it is there or not.
godot_root() {
	echo "$(cache_folder)/godot-root"
}

# The Debian root in which emscripten lies, whether it is there or not.
emscripten_root() {
	echo "$(cache_folder)/emscripten-root"
}

# Prints the version of the Python that the package is built for, as 3.12.
wheel_python() {
	"${PYTHON:-python3}" -c 'import sys; print("%d.%d" % sys.version_info[:2])'
}

# Prints the folder of the virtual environment in which the package is built.
wheel_venv() {
	echo "$(cache_folder)/wheel-python$(wheel_python)"
}

# Print the folders of the virtual environments of the tests and of the bake.
python_venv() {
	echo "$(cache_folder)/venv"
}

bake_venv() {
	echo "$(cache_folder)/bake-venv"
}

# True for a program that says that it is Godot 4.4 or newer.
is_new_godot() {
	local version
	version=$("$1" --version 2>/dev/null </dev/null | tail -n 1) || return 1
	[[ $version =~ ^([0-9]+)\.([0-9]+) ]] || return 1
	((BASH_REMATCH[1] > 4 || (BASH_REMATCH[1] == 4 && BASH_REMATCH[2] >= 4)))
}

# Prints the path of a Godot that runs as it is: $GODOT, or godot or godot4 on the PATH; nothing if there is none.
# A $GODOT that cannot be used is an error, not a reason to take another.
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
		# This wrapper itself may be on the PATH.
		[[ $(readlink -f "$candidate") != "$(readlink -f "$0")" ]] || continue
		if is_new_godot "$candidate"; then
			echo "$candidate"
			return
		fi
	done
}

# enter_root ROOT: sets the array `enter` to the command behind which programs of a Debian root run, with our folders under the
# paths that they have here.
enter_root() {
	local root=$1 repo folder
	repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
	enter=(bwrap --die-with-parent --unshare-pid --bind "$root" / --dev-bind /dev /dev --proc /proc --ro-bind-try /sys /sys)
	enter+=(--ro-bind-try /etc/ssl/certs /etc/ssl/certs)
	for folder in /tmp /run "$HOME" "$(cache_folder)" "$repo" "$PWD"; do
		case $folder/ in
			/ | // | /usr/* | /etc/* | /bin/* | /sbin/* | /lib* | /dev/* | /proc/* | /sys/*) ;; # the root has its own
			*) [[ ! -d $folder ]] || enter+=(--bind "$folder" "$folder") ;;
		esac
	done
	enter+=(--chdir "$PWD")
}

# Lets Godot import what is new in the demo project, which it does not do by itself when it runs a project.
import_demo() {
	local repo stamp
	repo=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
	stamp=$repo/demo_project/.godot/thicket_imported
	if [[ -f $stamp && -z $(find "$repo/demo_project" -name .godot -prune -o -newer "$stamp" -print -quit) ]]; then
		return
	fi
	# Godot lists a new extension only after it has read all scripts, and would complain about those that use it.
	mkdir -p "${stamp%/*}"
	[[ -f ${stamp%/*}/extension_list.cfg ]] ||
		echo res://addons/thicket/thicket.gdextension >"${stamp%/*}/extension_list.cfg"
	"$repo/tools/godot" --headless --path "$repo/demo_project" --import </dev/null
	touch "$stamp"
}
