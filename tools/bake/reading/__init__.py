"""Exports a bake to Godot, to glTF and to maps. `bash demo_project/bake_export.sh` runs it; READERS.md beside this folder describes the
files."""
