"""Areas that are too large for memory, tile by tile."""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeAlias

from numpy.typing import ArrayLike

from . import _core
from .arguments import RECT, Numbers, Seed, integer, number, numbers, seed_of
from .points import Points
from .sampling import sample

Rect: TypeAlias = tuple[float, float, float, float]


def _rects(rect: Rect, size: float) -> Iterator[Rect]:
    min_x, min_y, max_x, max_y = rect
    for row in range(math.floor(min_y / size), math.ceil(max_y / size)):
        for column in range(math.floor(min_x / size), math.ceil(max_x / size)):
            yield (
                max(min_x, column * size),
                max(min_y, row * size),
                min(max_x, (column + 1) * size),
                min(max_y, (row + 1) * size),
            )


def tiles(
    rect: Numbers,
    size: float,
    radius: float,
    seed: Seed = 0,
    *,
    levels: int = 1,
    layer: int = 0,
    even: bool = False,
    threads: int = 1,
    within: Any = None,
    fixed: ArrayLike | None = None,
) -> Iterator[tuple[Rect, Points]]:
    """Iterates over the points of a rectangle of any size, tile by tile. All tiles together contain the same points as one call to
    sample(). At most 2 * threads tiles are in memory.

    Tile borders are multiples of `size`, so overlapping rectangles have the same tiles, except for those that they cut.

    Args:
        rect: as in sample(), but the number of points is not limited.
        size: the width and height of a tile in meters. Tiles of 64 radii or more are the fastest.
        radius, seed, levels, layer, even, within, fixed: as in sample().
        threads: the number of tiles that are generated concurrently, 1 to 256; 0 for one per core.

    Yields:
        The rectangle of each tile, (min_x, min_y, max_x, max_y), and its points: rows from min_y to max_y, each from min_x to max_x.

    Raises:
        TypeError, ValueError, MemoryError: as in sample().
    """
    area = numbers("rect", rect, RECT)
    width, count = number("size", size), integer("threads", threads)
    if not all(map(math.isfinite, area)):
        raise ValueError(f"rect must be finite, got {rect!r}")
    if not (math.isfinite(width) and width > 0):
        raise ValueError(f"size must be positive, got {size!r}")
    if not 0 <= count <= 256:
        raise ValueError(f"threads must be between 0 and 256, got {threads!r}")
    set_seed = seed_of(seed)

    def generate() -> Iterator[tuple[Rect, Points]]:
        workers = int(count) or os.cpu_count() or 1
        cancel = _core.Cancel()
        options: dict[str, Any] = {"levels": levels, "layer": layer, "even": even, "within": within, "fixed": fixed, "cancel": cancel}
        pending: deque[tuple[Rect, Future[Points]]] = deque()
        with ThreadPoolExecutor(workers) as pool:
            try:
                for tile in _rects((area[0], area[1], area[2], area[3]), width):
                    pending.append((tile, pool.submit(sample, tile, radius, set_seed, **options)))
                    if len(pending) == 2 * workers:
                        tile_rect, points = pending.popleft()
                        yield tile_rect, points.result()
                while pending:
                    tile_rect, points = pending.popleft()
                    yield tile_rect, points.result()
            finally:
                # The caller may stop before the last tile.
                cancel.cancel()
                pool.shutdown(cancel_futures=True)

    return generate()
