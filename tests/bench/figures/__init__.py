"""Reproduces the seed paper's figures: `bash tests/bench/figures.sh`."""
