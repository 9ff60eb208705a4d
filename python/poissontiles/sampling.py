"""The samplers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .areas import Area
from .arguments import RECT, Numbers, ProgressFunction, Seed, checked_callbacks, disks, integer, number, numbers, period_cells, seed_of, text, triples
from .points import Points, SurfacePoints

Method: TypeAlias = Literal["naive", "hierarchical", "accumulator", "wavefront", "tiles"]


def sample(
    rect: Numbers | None,
    radius: float,
    seed: Seed = 0,
    *,
    levels: int = 1,
    layer: int = 0,
    even: bool = False,
    threads: int = 1,
    n: int | None = None,
    within: Any = None,
    fixed: ArrayLike | None = None,
    period: float | Numbers | None = None,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> Points:
    """Returns the points of an infinite Poisson-disk set in a rectangle: no two points are closer than the radius, and no
    additional point fits.

    Seed, radius, levels and layer determine the set. A point is bit-identical in every rectangle that contains it, on every
    machine and in all versions, so tiles fit together. The call takes O(points) time and releases the interpreter's lock.

    Args:
        rect: (min_x, min_y, max_x, max_y) in meters, half-open: points p have min <= p < max. The rectangle must lie
            within 2**23 * radius / sqrt(2) meters of the origin. An empty rectangle has no points. None for the smallest rectangle
            around `within`, or for one whole period.
        radius: the minimum distance between two points in meters; 0.001 to 1e6.
        seed: any 64-bit integer, signed or not: -1 and 2**64 - 1 are the same seed. Different seeds produce unrelated sets. None chooses
            a random seed. A NumPy Generator, BitGenerator or SeedSequence provides one, and a generator thereby advances.
        levels: the levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest. Each level is a maximal set of half
            the radius of the level before. A prefix that ends between two levels keeps only the finer radius.
        layer: 0 to 65535; part of the IDs. Different layers are different sets.
        even: True to order the points of each level by distance. A prefix that is not smaller than the coarsest level then keeps at least
            0.75 of the least distance of a maximal set of equal density, instead of 0.5. Changes only the ranks. With one level, this
            has no effect.
        threads: the number of threads for a rectangle wider than 90 radii, 1 to 256; 0 for one per core. The number does not change
            the points or their order.
        n: return only the first n points in the progressive order, see levels and even; None for all. These points depend on
            the rectangle. Raises ValueError if there are fewer.
        within: return only the points inside a polygon: a Shapely geometry, GeoJSON as a dictionary, or any object with a
            __geo_interface__, such as a GeoSeries, in meters. Points exactly on the boundary are left out. Requires Shapely.
        fixed: points that exist already, an array of shape (n, 2), or of shape (n, 3) with the distance to keep from each in the third
            column, otherwise `radius`. The new points keep their distance from them and fill the rest; the fixed points are not in the
            result. Windows fit together if all calls get the same fixed points, or at least those within 36 radii and their own
            distance of the window. With several levels, only the finest level fills: the coarser levels lose the points that are too
            close.
        period: the width and height in meters after which the set repeats, so that the plane becomes a torus; one number for both, 0 for
            an axis without an end. Only certain radii fit: see torus_radius(). IDs repeat with the points. It cannot be combined with
            `fixed`.
        progress: called with the finished fraction (0 to 1, never decreasing) and the number of points so far, about every
            15 milliseconds, on the calling thread, and with 1 at the end. An exception in it ends the call.
        cancel: an object with which another thread can end the call.

    Raises:
        TypeError: an argument has the wrong type; the message has the argument and its value.
        ValueError: an argument is out of range, or there are more than 1e8 points; the message has the argument and its value.
        MemoryError: the points do not fit into memory.
        Cancelled: `cancel` was cancelled.
    """
    set_seed = seed_of(seed)
    area = None if within is None else Area(within)
    if period is not None and fixed is not None:
        raise ValueError("period cannot be combined with fixed")
    cells = period_cells(period, number("radius", radius), levels)
    if rect is None and area is not None:
        rect = area.bounds
    elif rect is None:
        if min(cells) == 0:
            raise TypeError("rect must be four numbers, (min_x, min_y, max_x, max_y), or None together with within or period")
        # Half a lattice unit before the first cell, so that no rounding can add points of the next period.
        side = radius / math.sqrt(2)
        start = -side / 2**15
        rect = (start, start, cells[0] * side + start, cells[1] * side + start)
    arrays = _core.sample(
        numbers("rect", rect, RECT),
        number("radius", radius),
        set_seed,
        integer("levels", levels),
        integer("layer", layer),
        bool(even),
        integer("threads", threads),
        None if fixed is None else disks("fixed", fixed, radius),
        cells,
        *checked_callbacks(progress, cancel),
    )
    points = Points(*arrays, set_seed)
    if area is not None:
        points = points[area.contains(points.positions)]
    return points if n is None else points.first(n)


def sample_surface(
    vertices: ArrayLike,
    faces: ArrayLike,
    radius: float,
    seed: Seed = 0,
    *,
    window: Numbers | None = None,
    levels: int = 1,
    layer: int = 0,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> SurfacePoints:
    """Returns the points of a Poisson-disk set on triangles in 3D space: no two points are closer than the radius in a straight line,
    and no additional point fits on the surface.

    The points depend on the position and shape of the surface, but not on how it is divided into triangles. They are distributed
    evenly by area, regardless of the direction in which a triangle faces.
    Seed, radius, levels and layer determine the set of a surface. A point is bit-identical in every window that contains it, on
    every machine. The call takes O(points + triangles) time and releases the interpreter's lock. The method is Dart Throwing on Surfaces
    (Cline, Jeschke, White, Razdan and Wonka, 2009), with darts that belong to cells of 3D space instead of triangles.

    Args:
        vertices: array of shape (n, 3), in meters; converted to float64.
        faces: integer array of shape (m, 3): for each triangle, the indices of its three vertices. Triangles may lie in any
            arrangement, with any number of sheets above each other.
        radius: the minimum distance between two points in meters; 0.001 to 1e6.
        seed: as in sample().
        window: (min_x, min_y, min_z, max_x, max_y, max_z) in meters, half-open; None for the whole surface.
        levels: the levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest.
        layer: 0 to 65535; part of the IDs. Different layers are different sets.
        progress, cancel: as in sample().

    Raises:
        TypeError: an argument has the wrong type, or vertices or faces is not of shape (n, 3).
        ValueError: an argument is out of range, a vertex is not finite, a face refers to a missing vertex, or there are more than 1e8
            points; the message has the argument and its value.
        MemoryError: the points do not fit into memory.
        Cancelled: `cancel` was cancelled.
    """
    set_seed = seed_of(seed)
    positions, ids, ranks, point_levels, normals, point_faces = _core.sample_surface(
        triples("vertices", vertices, "fiu", "numbers", np.float64),
        triples("faces", faces, "iu", "integers", np.int64),
        number("radius", radius),
        set_seed,
        None if window is None else numbers("window", window, ("min_x", "min_y", "min_z", "max_x", "max_y", "max_z")),
        integer("levels", levels),
        integer("layer", layer),
        *checked_callbacks(progress, cancel),
    )
    return SurfacePoints(positions, ids, ranks, point_levels, set_seed, normals, point_faces)


@overload
def sample_domain(
    size: Numbers,
    radius: float,
    seed: Seed = 0,
    *,
    method: Method = "hierarchical",
    toroidal: bool = False,
    precision: Literal["double"] = "double",
    cell_size: float = 0.0,
    darts_each: float = 100.0,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> NDArray[np.float64]: ...
@overload
def sample_domain(
    size: Numbers,
    radius: float,
    seed: Seed = 0,
    *,
    method: Method = "hierarchical",
    toroidal: bool = False,
    precision: Literal["single"],
    cell_size: float = 0.0,
    darts_each: float = 100.0,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> NDArray[np.float32]: ...
def sample_domain(
    size: Numbers,
    radius: float,
    seed: Seed = 0,
    *,
    method: Method = "hierarchical",
    toroidal: bool = False,
    precision: Literal["single", "double"] = "double",
    cell_size: float = 0.0,
    darts_each: float = 100.0,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> NDArray[Any]:
    """Fills the rectangle from (0, 0) to (width, height), exclusive, with a separate Poisson-disk set.

    The methods are those of White, Cline and Egbert, Poisson Disk Point Sets by Hierarchical Dart Throwing (2007). Equal arguments produce
    bit-identical points on every machine. The call takes O(points) expected time and releases the interpreter's lock.

    Args:
        size: (width, height) in meters, positive; at least 4 radii each if toroidal, at most 131072 in single precision.
        radius: the minimum distance between two points in meters; 0.001 to 1e6.
        seed: as in sample().
        method: 'hierarchical' throws darts at squares that may be uncovered; 'accumulator' has the same distribution, with more memory
            and fewer searches; 'wavefront' spreads from one point and uses the least memory; 'naive' throws darts at the whole
            domain, for comparison: it is slow and leaves small gaps. With all other methods, no additional point fits. 'tiles' is by far
            the fastest: it returns the positions that sample() returns, in double precision; if toroidal, the radius must fit the size
            (torus_radius()).
        toroidal: True to connect opposite edges, so that the set repeats without a seam.
        precision: the precision of coordinates and distances; 'single' takes half the memory and produces a different set. Its coordinates
            are multiples of 2^-23 of the smallest power of two above the longer side (or above 8 radii), and no additional point fits at
            any such multiple.
        cell_size: the width of an accelerator cell in radii, up to 1000; 0 for the method's default. The width does not change the points.
        darts_each: for 'naive': the number of darts for each base square of radius / sqrt(2) in width, 1 to 1e6.
        progress, cancel: as in sample().

    Returns:
        An array of shape (n, 2), float32 or float64 depending on precision, in the order in which the points were accepted. It is a read-only
        view into the sampler's memory, without a copy.

    Raises:
        TypeError: an argument has the wrong type; the message has the argument and its value.
        ValueError: an argument is out of range, or there are more than 1e9 points; the message has the argument and its value.
        MemoryError: the points do not fit into memory.
        Cancelled: `cancel` was cancelled.
    """
    if precision not in ("single", "double"):
        raise ValueError(f"precision must be 'single' or 'double', got {precision!r}")
    if method == "tiles":
        if precision != "double":
            raise ValueError(f"precision must be 'double' with the method 'tiles', got {precision!r}")
        width, height = numbers("size", size, ("width", "height"))
        rect = None if toroidal else (0.0, 0.0, width, height)
        return sample(rect, radius, seed, period=size if toroidal else None, progress=progress, cancel=cancel).positions
    sampler: Callable[..., NDArray[Any]] = _core.sample_domain_single if precision == "single" else _core.sample_domain_double
    return sampler(
        numbers("size", size, ("width", "height")),
        number("radius", radius),
        seed_of(seed),
        text("method", method),
        bool(toroidal),
        number("cell_size", cell_size),
        number("darts_each", darts_each),
        *checked_callbacks(progress, cancel),
    )


def domain_digest(positions: NDArray[np.float32] | NDArray[np.float64]) -> int:
    """Returns a 64-bit digest of a domain, for comparing domains across machines. The digest depends on the positions and their order.

    Args:
        positions: an array from sample_domain(), or an equal contiguous array of float32 or float64.

    Raises:
        TypeError: positions is another type of array.
    """
    is_domain = isinstance(positions, np.ndarray) and positions.ndim == 2 and positions.shape[1] == 2 and positions.flags.c_contiguous
    if not is_domain or positions.dtype not in (np.float32, np.float64):
        raise TypeError(f"positions must be a contiguous array of float32 or float64 of shape (n, 2), got {positions!r}")
    return _core.domain_digest(positions)
