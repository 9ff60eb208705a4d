#!/usr/bin/env bash
# Downloads the official Godot for this runner, at the version that the tests are made for, and sets GODOT for the following steps. Needs
# GitHub's program gh and its token in $GH_TOKEN. Only workflows use this script: tools/setup.sh installs Debian's Godot.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
version=$(sed -n 's/^godot_version=//p' tools/setup.sh)

case $(uname -s) in
	Linux) file=linux.x86_64.zip program=Godot_v$version-stable_linux.x86_64 ;;
	Darwin) file=macos.universal.zip program=Godot.app/Contents/MacOS/Godot ;;
	*) file=win64.exe.zip program=Godot_v$version-stable_win64_console.exe ;;
esac
folder=$RUNNER_TEMP/godot
mkdir -p "$folder"
cd "$folder"
gh release download "$version-stable" --repo godotengine/godot-builds --pattern "Godot_v$version-stable_$file" --pattern SHA512-SUMS.txt
# Windows has sha512sum in Git's bash, macOS only has shasum.
grep " Godot_v$version-stable_$file\$" SHA512-SUMS.txt | if command -v sha512sum >/dev/null; then sha512sum --check; else shasum -a 512 --check; fi
unzip -q "Godot_v$version-stable_$file"
chmod +x "$program"
echo "GODOT=$folder/$program" >>"$GITHUB_ENV"
