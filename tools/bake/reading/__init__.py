"""Exports a bake to Godot, to glTF, to GeoParquet and to maps. `bash demo_project/bake_export.sh` runs this package. ../READERS.md
describes the files."""
