"""The seed paper's figures, measured again: `bash tests/bench/figures.sh`."""
