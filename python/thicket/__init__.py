"""Exact Poisson-disk point sets, infinite and bounded, as NumPy arrays.

sample() returns a window of an infinite set, which seed and radius determine. sample_domain() fills a rectangle with a set of its own.
Lengths are in meters. All functions are thread-safe, and release the GIL while they work.
"""

from importlib.metadata import version as _version

from ._core import Cancel, Cancelled, Points, domain_digest, sample, sample_domain

__version__: str = _version("thicket")
__all__ = ["Cancel", "Cancelled", "Points", "domain_digest", "sample", "sample_domain"]
