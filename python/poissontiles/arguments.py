"""Checks and converts the types of arguments. The core checks their ranges."""

from __future__ import annotations

import math
import operator
import secrets
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, SupportsFloat, SupportsIndex, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Numbers: TypeAlias = Union[Sequence[float], NDArray[Any]]
Seed: TypeAlias = Union[SupportsIndex, np.random.Generator, np.random.BitGenerator, np.random.SeedSequence, None]
ProgressFunction: TypeAlias = Callable[[float, int], object]

RECT = ("min_x", "min_y", "max_x", "max_y")


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
        value = operator.index(seed)
    except TypeError:
        raise TypeError(f"seed must be an integer, None, or a NumPy Generator, BitGenerator or SeedSequence, got {seed!r}") from None
    if not -(2**63) <= value < 2**64:
        raise ValueError(f"seed must have 64 bits, got {value}")
    return value % 2**64


def numbers(name: str, value: Numbers, parts: tuple[str, ...]) -> tuple[float, ...]:
    try:
        converted = tuple(float(item) for item in value)
    except (TypeError, ValueError):
        converted = ()
    if len(converted) != len(parts):
        count_words = {2: "two", 4: "four", 6: "six"}
        raise TypeError(f"{name} must be {count_words[len(parts)]} numbers, ({', '.join(parts)}), got {value!r}")
    return converted


def number(name: str, value: SupportsFloat | SupportsIndex) -> float:
    if not isinstance(value, (SupportsFloat, SupportsIndex)):
        raise TypeError(f"{name} must be a number, got {value!r}")
    return float(value)


def integer(name: str, value: SupportsIndex) -> float:
    """Returns an integer as a float, which the core compares with its range. All accepted integers are small enough to be exact."""
    try:
        converted = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be an integer, got {value!r}") from None
    return float(min(max(converted, -(2**63)), 2**63))


def text(name: str, value: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a string, got {value!r}")
    return value


def checked_callbacks(progress: ProgressFunction | None, cancel: _core.Cancel | None) -> tuple[ProgressFunction | None, _core.Cancel | None]:
    """Checks the types of `progress` and `cancel`, and returns both."""
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be callable or None, got {progress!r}")
    if cancel is not None and not isinstance(cancel, _core.Cancel):
        raise TypeError(f"cancel must be a Cancel or None, got {cancel!r}")
    return progress, cancel


def triples(name: str, value: ArrayLike, kinds: str, words: str, dtype: type) -> NDArray[Any]:
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != 3 or (array.dtype.kind not in kinds and array.size > 0):
        raise TypeError(f"{name} must be an array of {words} of shape (n, 3), got {array.dtype} of shape {array.shape}")
    return np.ascontiguousarray(array, dtype=dtype)


def _period_cells(sizes: tuple[float, ...], radius: float, levels: int) -> tuple[int, int] | None:
    """Returns the numbers of cells that are closest to a period, or None if no multiple of the step has its proportions."""
    step = _core.period_step(levels) * radius / math.sqrt(2)
    positive = [size for size in sizes if size > 0]
    ratio = Fraction(positive[-1] / positive[0]).limit_denominator(1000)
    if not math.isclose(positive[0] * ratio, positive[-1], rel_tol=1e-12):
        return None
    steps = max(round(positive[0] / (step * ratio.denominator)), 1)
    counts = [steps * ratio.denominator, steps * ratio.numerator]
    cells = [_core.period_step(levels) * (counts.pop(0) if size > 0 else 0) for size in sizes]
    return cells[0], cells[1]


def _period_sizes(period: float | Numbers) -> tuple[float, ...]:
    sides: Any = [period, period] if np.ndim(period) == 0 else period
    sizes = numbers("period", sides, ("width", "height"))
    if not all(math.isfinite(size) and size >= 0 for size in sizes) or max(sizes) == 0:
        raise ValueError(f"period must be positive, or 0 on one axis without an end, got {period!r}")
    return sizes


def torus_radius(period: float | Numbers, radius: float, levels: int = 1) -> float:
    """Returns the radius closest to `radius` with which a set can repeat after `period`, for sample(): the period is then a multiple of
    5 * 2**(levels - 1) cells of radius / sqrt(2).

    Args:
        period: the width and height in meters, or one number for both.
        radius: the desired minimum distance in meters.
        levels: the levels of the progressive order, 1 to 8.

    Raises:
        ValueError: no radius fits, because width / height is not a ratio of small integers.
    """
    sizes = _period_sizes(period)
    cells = _period_cells(sizes, radius, levels)
    if cells is None:
        raise ValueError(f"period must have a width and height in a ratio of integers up to 1000, got {period!r}")
    return max(sizes) * math.sqrt(2) / max(cells)


def period_cells(period: float | Numbers | None, radius: float, levels: int) -> tuple[int, int]:
    """Returns a period in cells; (0, 0) for None."""
    if period is None:
        return 0, 0
    sizes = _period_sizes(period)
    cells = _period_cells(sizes, radius, levels)
    side = radius / math.sqrt(2)
    if cells is None or not all(math.isclose(count * side, size, rel_tol=1e-9) for count, size in zip(cells, sizes)):
        step = _core.period_step(levels) * side
        raise ValueError(f"period must be a multiple of {step:.10g} for this radius, got {period!r}. Use the radius that torus_radius() returns")
    return cells


def disks(name: str, value: ArrayLike, radius: float) -> NDArray[np.float64]:
    """Returns rows of x, y and radius. Rows without a radius get the default."""
    array = np.asarray(value)
    if array.size == 0:
        return np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] not in (2, 3) or array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be an array of numbers of shape (n, 2) or (n, 3), got {array.dtype} of shape {array.shape}")
    rows = np.full((len(array), 3), float(radius))
    rows[:, : array.shape[1]] = array
    invalid = ~np.isfinite(rows).all(axis=1) | (rows[:, 2] < 0)
    if invalid.any():
        raise ValueError(f"{name} must be finite, with radii of at least 0, got {rows[invalid][0]}")
    return rows
