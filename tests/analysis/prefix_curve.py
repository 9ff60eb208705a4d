"""Prints how well every prefix of the progressive order keeps its distance, as a Markdown table. Needs the packages poissontiles and scipy:
`python tests/analysis/prefix_curve.py`, in about a minute.

A prefix is compared with a maximal set of equal density: 1 means that its least distance is the radius of such a set. The last column orders the
same points by weighted sample elimination (Yuksel, Sample Elimination for Generating Poisson Disk Sample Sets, 2015), which needs all points at once."""

from __future__ import annotations

import heapq

import numpy as np
import poissontiles
from scipy.spatial import cKDTree

LEVELS = 4
SIDE = 120.0
JAMMED_DENSITY = 0.547070 * 4.0 / np.pi
FRACTIONS = [0.0625, 0.065, 0.08, 0.1, 0.125, 0.16, 0.2, 0.25, 0.26, 0.3, 0.35, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0]


def eliminated(points: np.ndarray, count: int, area: float) -> tuple[np.ndarray, list[int]]:
    """Returns the indices of `count` points that remain, and those of the others in the order of their elimination."""
    radius = 2.0 * np.sqrt(area / (2.0 * np.sqrt(3.0) * count))
    neighbor_lists = cKDTree(points).query_ball_point(points, radius)
    weights = np.zeros(len(points))
    share: list[dict[int, float]] = []
    for index, neighbors in enumerate(neighbor_lists):
        distance = np.hypot(*(points[neighbors] - points[index]).T)
        share.append({other: (1.0 - d / radius) ** 8 for other, d in zip(neighbors, distance, strict=True) if other != index})
        weights[index] = sum(share[-1].values())
    heap = [(-weight, index) for index, weight in enumerate(weights)]
    heapq.heapify(heap)
    removed: list[int] = []
    is_removed = np.zeros(len(points), bool)
    while len(points) - len(removed) > count:
        weight, index = heapq.heappop(heap)
        if is_removed[index] or -weight != weights[index]:
            continue
        is_removed[index] = True
        removed.append(index)
        for other, fraction in share[index].items():
            if not is_removed[other]:
                weights[other] -= fraction
                heapq.heappush(heap, (-weights[other], other))
    return np.flatnonzero(~is_removed), removed


def elimination_order(points: np.ndarray, area: float) -> np.ndarray:
    """Orders points by halving their number again and again."""
    remaining = np.arange(len(points))
    order: list[int] = []
    while len(remaining) > 64:
        kept, removed = eliminated(points[remaining], len(remaining) // 2, area)
        order.extend(remaining[removed])
        remaining = remaining[kept]
    return np.array([*remaining, *order[::-1]])


def relative_radius(points: np.ndarray, order: np.ndarray, fraction: float) -> float:
    """Returns the least distance in the first part of an order, in radii of a maximal set of equal density."""
    prefix = points[order[: round(fraction * len(order))]]
    min_distance = cKDTree(prefix).query(prefix, k=2)[0][:, 1].min()
    return float(min_distance * np.sqrt(len(prefix) / SIDE**2 / JAMMED_DENSITY))


def main() -> None:
    options = {"radius": 1.0, "seed": 7, "levels": LEVELS}
    rect = (0.0, 0.0, SIDE, SIDE)
    usual, even = (poissontiles.sample(rect, even=order, **options) for order in (False, True))
    points = usual.positions
    orders = [np.argsort(usual.ranks), np.argsort(even.ranks), elimination_order(points, SIDE**2)]
    print("| fraction of the points | levels | even order | sample elimination |\n| --- | ---: | ---: | ---: |")
    for fraction in FRACTIONS:
        print(f"| {fraction} | " + " | ".join(f"{relative_radius(points, order, fraction):.2f}" for order in orders) + " |")
    fine = np.geomspace(4.0 ** -(LEVELS - 1), 1.0, 300)
    print("| lowest | " + " | ".join(f"{min(relative_radius(points, order, q) for q in fine):.2f}" for order in orders) + " |")


if __name__ == "__main__":
    main()
