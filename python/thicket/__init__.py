"""Exact Poisson-disk point sets, infinite and bounded, as NumPy arrays.

sample() shows a window of an infinite set that seed and radius name; sample_domain() fills a rectangle with a set of its own. Lengths are
meters. Every function may be called from any thread, and lets others run while it works.
"""

from importlib.metadata import version as _version

from ._core import Cancel, Cancelled, Points, domain_digest, sample, sample_domain

__version__: str = _version("thicket")
__all__ = ["Cancel", "Cancelled", "Points", "domain_digest", "sample", "sample_domain"]
