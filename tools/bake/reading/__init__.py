"""Exports a bake to Godot, glTF, USD, GeoParquet and maps. `bash demo_project/bake_export.sh` runs this package. ../READERS.md
describes the files."""
