"""Exact Poisson-disk point sets, infinite and bounded, as NumPy arrays.

sample() returns a window of an infinite set, which the seed, the radius, the number of levels and the layer determine. sample_domain()
fills a rectangle with a separate set. sample_surface() returns a set on the triangles of any surface in 3D space. tiles() divides areas
that are too large for memory.
Lengths are in meters. All functions are thread-safe and release the GIL while they work.
"""

from importlib.metadata import version as _version

from ._core import Cancel, Cancelled
from .areas import DensityMap
from .arguments import torus_radius
from .points import Points, SurfacePoints
from .sampling import domain_digest, sample, sample_domain, sample_surface
from .tiling import tiles

__version__: str = _version("poissontiles")
__all__ = ["Cancel", "Cancelled", "DensityMap", "Points", "SurfacePoints", "domain_digest", "sample", "sample_domain", "sample_surface", "tiles", "torus_radius"]
