"""Polygons, and maps of densities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import RECT, Numbers, numbers


def _shape_of(geometry: Any) -> Any:
    from shapely import union_all  # type: ignore[import-not-found,import-untyped,unused-ignore]
    from shapely.geometry import shape  # type: ignore[import-not-found,import-untyped,unused-ignore]

    if not isinstance(geometry, Mapping):
        geometry = geometry.__geo_interface__
    if geometry.get("type") == "FeatureCollection":
        return union_all([_shape_of(feature) for feature in geometry["features"]])
    if geometry.get("type") == "Feature":
        return _shape_of(geometry["geometry"])
    return shape(geometry)


class Area:
    """The polygons of an argument `within`: a Shapely geometry, GeoJSON as a dictionary, or any object with a __geo_interface__."""

    def __init__(self, within: Any) -> None:
        try:
            import shapely  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError:
            raise ImportError("within requires the package shapely: pip install 'poissontiles[areas]'") from None
        if not isinstance(within, Mapping) and not hasattr(within, "__geo_interface__"):
            raise TypeError(f"within must be a Shapely geometry, a GeoJSON dictionary, or have a __geo_interface__, got {within!r}")
        try:
            self._shape = _shape_of(within)
        except (AttributeError, KeyError, TypeError, ValueError, shapely.errors.ShapelyError) as error:
            raise ValueError(f"within must be valid GeoJSON: {error}") from None
        if self._shape.geom_type not in ("Polygon", "MultiPolygon"):
            raise ValueError(f"within must be a polygon or several, got a {self._shape.geom_type}")
        if not self._shape.is_valid:
            raise ValueError(f"within must be a valid polygon: {shapely.is_valid_reason(self._shape)}")
        shapely.prepare(self._shape)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle around the area: (min_x, min_y, max_x, max_y); empty for an empty area."""
        return (0.0, 0.0, 0.0, 0.0) if self._shape.is_empty else tuple(self._shape.bounds)

    def contains(self, positions: NDArray[np.float64]) -> NDArray[np.bool_]:
        import shapely

        mask: NDArray[np.bool_] = shapely.contains_xy(self._shape, positions[:, 0], positions[:, 1])
        return mask


class DensityMap:
    """Densities from an image or any other two-dimensional array, for Points.thin(). Objects can be pickled.

    Args:
        values: array of shape (rows, columns). Floats are densities from 0 to 1; unsigned integers are divided by the maximum of their
            type, so that 8-bit and 16-bit images can be used directly; booleans are 0 or 1.
        rect: (min_x, min_y, max_x, max_y) in meters: the rectangle that the array covers. Outside of it, the nearest value is used.
        interpolation: 'linear' interpolates between the centers of pixels; 'nearest' uses the pixel around a position, for masks
            and classes.
        origin: 'upper' if the first row is at max_y, as in images; 'lower' if it is at min_y.

    Raises:
        TypeError: values is not two-dimensional or has another type.
        ValueError: a density is not between 0 and 1, or rect is empty.
    """

    def __init__(
        self,
        values: ArrayLike,
        rect: Numbers,
        *,
        interpolation: Literal["linear", "nearest"] = "linear",
        origin: Literal["upper", "lower"] = "upper",
    ) -> None:
        array = np.asarray(values)
        if array.ndim != 2 or array.size == 0 or array.dtype.kind not in "fub":
            raise TypeError(f"values must be floats, unsigned integers or booleans of shape (rows, columns), got {array.dtype} of shape {array.shape}")
        for name, value, allowed in (("interpolation", interpolation, ("linear", "nearest")), ("origin", origin, ("upper", "lower"))):
            if value not in allowed:
                raise ValueError(f"{name} must be {allowed[0]!r} or {allowed[1]!r}, got {value!r}")
        if array.dtype.kind == "u":
            array = array / np.iinfo(array.dtype).max
        invalid = ~((array >= 0) & (array <= 1))
        if invalid.any():
            raise ValueError(f"values must be between 0 and 1, got {array[invalid][0]}")
        self._corner = np.array(numbers("rect", rect, RECT)[:2])
        self._size = np.array(numbers("rect", rect, RECT)[2:]) - self._corner
        if not (np.isfinite(self._size).all() and (self._size > 0).all()):
            raise ValueError(f"rect must be finite and not empty, got {rect!r}")
        self._values = np.array(array if origin == "lower" else array[::-1], dtype=np.float64)
        self._linear = interpolation == "linear"

    def __call__(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the densities at positions of shape (n, 2)."""
        limits = np.array(self._values.shape)[::-1] - 1
        pixels = (positions - self._corner) / self._size * (limits + 1)
        if not self._linear:
            column, row = np.clip(np.floor(pixels), 0, limits).astype(np.intp).T
            nearest: NDArray[np.float64] = self._values[row, column]
            return nearest
        pixels = np.clip(pixels - 0.5, 0, limits)
        first = np.minimum(pixels.astype(np.intp), np.maximum(limits - 1, 0))
        column, row = first.T
        next_column, next_row = np.minimum(first + 1, limits).T
        weight_x, weight_y = (pixels - first).T
        low = (1 - weight_x) * self._values[row, column] + weight_x * self._values[row, next_column]
        high = (1 - weight_x) * self._values[next_row, column] + weight_x * self._values[next_row, next_column]
        densities: NDArray[np.float64] = np.clip((1 - weight_y) * low + weight_y * high, 0.0, 1.0)
        return densities
