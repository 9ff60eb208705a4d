"""The samplers. They check and convert the types of arguments; the core checks their ranges."""

from __future__ import annotations

import operator
import secrets
from collections.abc import Callable, Sequence
from typing import Any, Literal, SupportsFloat, SupportsIndex, TypeAlias, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .points import Points, SurfacePoints

Numbers: TypeAlias = Union[Sequence[float], NDArray[Any]]
Seed: TypeAlias = Union[SupportsIndex, np.random.Generator, np.random.BitGenerator, np.random.SeedSequence, None]
ProgressFunction: TypeAlias = Callable[[float, int], object]
Method: TypeAlias = Literal["naive", "hierarchical", "accumulator", "wavefront"]


def seed_of(seed: Seed) -> int:
    """Returns a seed from 0 to 2**64 - 1."""
    if seed is None:
        return secrets.randbits(64)
    if isinstance(seed, np.random.SeedSequence):
        return int(seed.generate_state(1, np.uint64)[0])
    if isinstance(seed, np.random.BitGenerator):
        seed = np.random.Generator(seed)
    if isinstance(seed, np.random.Generator):
        return int(seed.integers(2**64, dtype=np.uint64))
    try:
        number = operator.index(seed)
    except TypeError:
        raise TypeError(f"seed must be an integer, None, or a NumPy Generator, BitGenerator or SeedSequence, got {seed!r}") from None
    if not -(2**63) <= number < 2**64:
        raise ValueError(f"seed must have 64 bits, got {number}")
    return number % 2**64


def _numbers(name: str, value: Numbers, parts: tuple[str, ...]) -> tuple[float, ...]:
    try:
        numbers = tuple(float(each) for each in value)
    except (TypeError, ValueError):
        numbers = ()
    if len(numbers) != len(parts):
        words = {2: "two", 4: "four", 6: "six"}
        raise TypeError(f"{name} must be {words[len(parts)]} numbers, ({', '.join(parts)}), got {value!r}")
    return numbers


def _number(name: str, value: SupportsFloat | SupportsIndex) -> float:
    if not isinstance(value, (SupportsFloat, SupportsIndex)):
        raise TypeError(f"{name} must be a number, got {value!r}")
    return float(value)


def _integer(name: str, value: SupportsIndex) -> float:
    """Returns an integer as a float, which the core compares with its range. All accepted integers are small enough to be exact."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, got {value!r}") from None
    return float(min(max(number, -(2**63)), 2**63))


def _method(value: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"method must be a string, got {value!r}")
    return value


def _watched(progress: ProgressFunction | None, cancel: _core.Cancel | None) -> tuple[ProgressFunction | None, _core.Cancel | None]:
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be callable or None, got {progress!r}")
    if cancel is not None and not isinstance(cancel, _core.Cancel):
        raise TypeError(f"cancel must be a Cancel or None, got {cancel!r}")
    return progress, cancel


def _triples(name: str, value: ArrayLike, kinds: str, words: str, dtype: type) -> NDArray[Any]:
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != 3 or (array.dtype.kind not in kinds and array.size > 0):
        raise TypeError(f"{name} must be an array of {words} of shape (n, 3), got {array.dtype} of shape {array.shape}")
    return np.ascontiguousarray(array, dtype=dtype)


def sample(
    rect: Numbers,
    radius: float,
    seed: Seed = 0,
    *,
    levels: int = 1,
    layer: int = 0,
    threads: int = 1,
    n: int | None = None,
    progress: ProgressFunction | None = None,
    cancel: _core.Cancel | None = None,
) -> Points:
    """Returns the points of an infinite Poisson-disk set in a rectangle: no two points are closer than the radius, and no
    additional point fits.

    Seed, radius, levels and layer determine the set. A point is bit-identical in every rectangle that contains it, on every
    machine and in all versions, so tiles fit together. The call takes O(points) time and releases the interpreter's lock.

    Args:
        rect: (min_x, min_y, max_x, max_y) in meters, half-open: points p have min <= p < max. The rectangle must lie
            within 2**23 * radius / sqrt(2) meters of the origin. An empty rectangle has no points.
        radius: the minimum distance between two points in meters; 0.001 to 1e6.
        seed: any 64-bit integer, signed or not: -1 and 2**64 - 1 are the same seed. Different seeds produce unrelated sets. None chooses
            a random seed. A NumPy Generator, BitGenerator or SeedSequence provides one, and a generator thereby advances.
        levels: the levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest.
        layer: 0 to 65535; part of the IDs. Different layers are different sets.
        threads: the number of threads for a rectangle wider than 90 radii, 1 to 256; 0 for one per core. The number does not change
            the points or their order.
        n: return only the first n points in the progressive order, well spaced with several levels; None for all. These points depend on
            the rectangle. Raises ValueError if there are fewer.
        progress: called with the finished fraction (0 to 1, never decreasing) and the number of points so far, about every
            15 milliseconds, on the calling thread, and with 1 at the end. An exception in it ends the call.
        cancel: an object with which another thread can end the call.

    Raises:
        TypeError: an argument has the wrong type; the message has the argument and its value.
        ValueError: an argument is out of range, or there are more than 1e8 points; the message has the argument and its value.
        MemoryError: the points do not fit into memory.
        Cancelled: `cancel` was cancelled.
    """
    number = seed_of(seed)
    arrays = _core.sample(
        _numbers("rect", rect, ("min_x", "min_y", "max_x", "max_y")),
        _number("radius", radius),
        number,
        _integer("levels", levels),
        _integer("layer", layer),
        _integer("threads", threads),
        *_watched(progress, cancel),
    )
    points = Points(*arrays, number)
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
    number = seed_of(seed)
    positions, ids, ranks, point_levels, normals, point_faces = _core.sample_surface(
        _triples("vertices", vertices, "fiu", "numbers", np.float64),
        _triples("faces", faces, "iu", "integers", np.int64),
        _number("radius", radius),
        number,
        None if window is None else _numbers("window", window, ("min_x", "min_y", "min_z", "max_x", "max_y", "max_z")),
        _integer("levels", levels),
        _integer("layer", layer),
        *_watched(progress, cancel),
    )
    return SurfacePoints(positions, ids, ranks, point_levels, number, normals, point_faces)


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
            domain, for comparison: it is slow and leaves small gaps. With all other methods, no additional point fits.
        toroidal: True to connect opposite edges, so that the set repeats without a seam.
        precision: the precision of coordinates and distances; 'single' takes half the memory and produces a different set.
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
    fill: Callable[..., NDArray[Any]] = _core.sample_domain_single if precision == "single" else _core.sample_domain_double
    return fill(
        _numbers("size", size, ("width", "height")),
        _number("radius", radius),
        seed_of(seed),
        _method(method),
        bool(toroidal),
        _number("cell_size", cell_size),
        _number("darts_each", darts_each),
        *_watched(progress, cancel),
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
