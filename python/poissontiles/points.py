"""The point sets that the samplers return."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from typing import Any, SupportsIndex, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _core

List = TypeVar("List", bound="_List")


@dataclass(frozen=True, eq=False, repr=False)
class _List:
    """The members that the points of all sets have. Entry i of every array belongs to the same point. The arrays are contiguous and
    read-only, and each has memory of its own."""

    positions: NDArray[np.float64]
    ids: NDArray[np.uint64]
    ranks: NDArray[np.uint32]
    levels: NDArray[np.uint32]
    seed: int

    def __post_init__(self) -> None:
        for array in self._arrays():
            array.flags.writeable = False

    def _arrays(self) -> list[NDArray[Any]]:
        return [getattr(self, field.name) for field in fields(self) if field.name != "seed"]

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        return f"<poissontiles.{type(self).__name__} of {len(self)} points>"

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Returns the positions. They are copied only if `copy` is True or another type than float64 is requested."""
        if dtype is None or np.dtype(dtype) == self.positions.dtype:
            return self.positions.copy() if copy else self.positions
        if copy is False:
            raise ValueError(f"positions are float64, so an array of {np.dtype(dtype)} requires a copy")
        return self.positions.astype(dtype)

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        """Iterates over the positions."""
        return iter(self.positions)

    @overload
    def __getitem__(self, key: int | np.integer[Any]) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self: List, key: slice | NDArray[Any] | list[int] | list[bool]) -> List: ...
    def __getitem__(self, key: Any) -> Any:
        """Returns the position of one point for an integer. For a slice, a mask, or an array of indices, returns these points."""
        if isinstance(key, SupportsIndex) and not isinstance(key, (np.ndarray, bool)):
            return self.positions[key]
        if isinstance(key, tuple) or np.ndim(np.empty(0) if isinstance(key, slice) else key) != 1:
            raise IndexError(f"points must be indexed by an integer, a slice, a mask or an array of indices, got {key!r}")
        return type(self)(**{field.name: getattr(self, field.name)[key] for field in fields(self) if field.name != "seed"}, seed=self.seed)

    def first(self: List, count: int) -> List:
        """Returns the first points in the progressive order, in the order of this list. Points with equal ranks are ordered by ID.

        Args:
            count: the number of points, 0 to len(points).

        Raises:
            ValueError: there are fewer points.
        """
        if not 0 <= count <= len(self):
            raise ValueError(f"count must be between 0 and {len(self)}, the number of points, got {count}")
        return self[np.sort(np.lexsort((self.ids, self.ranks))[:count])]

    def thin(self: List, density: ArrayLike | Callable[[NDArray[np.float64]], ArrayLike]) -> List:
        """Returns the points whose rank is below a density: rank / 2**32 < density. With several levels, the remaining points are well
        spaced wherever the density varies slowly. A point is kept or removed regardless of all other points, so tiles still fit
        together.

        Args:
            density: the fraction of points to keep, 0 to 1: a number, one number for each point, or a function that receives the
                positions, float64 of shape (n, axes), and returns such numbers, for example the values of an image.

        Raises:
            ValueError: the density has the wrong shape, or a value is not between 0 and 1.
        """
        values = np.asarray(density(self.positions) if callable(density) else density, dtype=np.float64)
        if values.ndim != 0 and values.shape != (len(self),):
            raise ValueError(f"density must be a number, or have shape ({len(self)},), got shape {values.shape}")
        invalid = ~((values >= 0) & (values <= 1))
        if invalid.any():
            raise ValueError(f"density must be between 0 and 1, got {np.ravel(values)[np.ravel(invalid)][0]}")
        return self[self.ranks < values * 2.0**32]

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), tuple(getattr(self, field.name) for field in fields(self))


@dataclass(frozen=True, eq=False, repr=False)
class Points(_List):
    """The points of a set in a rectangle, returned by sample().

    numpy.asarray(points) returns the positions. An integer index returns one position; a slice, a mask or an array of indices returns
    Points. Objects can be pickled, for example for process pools.

    Attributes:
        positions: float64 of shape (n, 2): x and y of each point in meters, with the same accuracy at any distance from the origin.
        ids: uint64 of shape (n,): permanent IDs, the same in all rectangles. An ID has 16 bits for the layer, and 24 bits each for the x
            and y of the point's cell.
        ranks: uint32 of shape (n,): rank / 2**32 is the fraction of the set that precedes the point in the progressive order, at least 0
            and below 1. The points with a rank below q * 2**32 are a fraction q of all points. With several levels, these points are well
            spaced.
        levels: uint32 of shape (n,): 0 for the finest level; the points of level l and above form a set with the minimum distance
            radius * 2**l.
        seed: the seed of the set, 0 to 2**64 - 1. It is useful if sample() chose one.
    """

    def digest(self) -> tuple[int, int]:
        """Returns two 64-bit numbers for comparing points across machines: a digest of positions, IDs and levels, and one of ranks.

        The digests do not depend on the order of the points. The tests of the core use the same digests (tests/golden/core.json).

        Raises:
            MemoryError: 40 bytes for each point cannot be allocated.
        """
        return _core.digest(self.positions, self.ids, self.ranks, self.levels)


@dataclass(frozen=True, eq=False, repr=False)
class SurfacePoints(_List):
    """The points of a set on a surface, returned by sample_surface(). They can be converted, indexed and pickled like Points.

    Attributes:
        positions: float64 of shape (n, 3): the position of each point in meters, less than radius / 500,000 from its face.
        ids: uint64 of shape (n,): permanent IDs. An ID has 16 bits for the layer, and 17, 14 and 17 bits for the x, y and z of the
            point's cell, a cube with edges of radius / sqrt(3). IDs repeat after 131,072 cells along x and z, and after 16,384 along y.
        ranks: uint32 of shape (n,): the ranks, as in Points.
        levels: uint32 of shape (n,): the levels, as in Points.
        seed: the seed of the set, 0 to 2**64 - 1.
        normals: float64 of shape (n, 3): the unit normal of the face, on the side from which its vertices run counterclockwise.
        faces: uint32 of shape (n,): the face of each point, an index in the argument `faces` of sample_surface().
    """

    normals: NDArray[np.float64]
    faces: NDArray[np.uint32]
