"""Takes a bake elsewhere: into a world of Godot, into glTF, onto maps. `bash demo_project/bake_export.sh` runs it; READERS.md beside this
folder says what it writes."""
