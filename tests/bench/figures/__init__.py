"""Reproduces the figures of the paper on which the sampler is based. Run it with `bash tests/bench/figures.sh`."""
