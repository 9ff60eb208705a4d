"""Bakes the world of a scene into Parquet files, one for each tile, with one engine for each worker. `bash
demo_project/bake.sh` runs this package. ../README.md describes the files."""
