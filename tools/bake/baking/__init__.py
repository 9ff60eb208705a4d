"""Bakes the world of a scene: every tile of it as a Parquet file, made by as many engines as there are workers. `bash
demo_project/bake.sh` runs it; README.md beside this file says what it writes."""
