#!/usr/bin/env bash
# Writes the plants and stones of the presets to addons/thicket/presets/plants. Run it after changing the scripts in this folder.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."
source tools/setup.sh

setup_compiler
setup_godot
scons -Q -j"$(nproc)" extension
import_demo
exec tools/godot --headless --path demo_project --script res://meshes/save_models.gd </dev/null
