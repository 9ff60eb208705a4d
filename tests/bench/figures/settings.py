"""Defines how much to measure: FULL for the page, QUICK to check that everything works."""

from __future__ import annotations

from dataclasses import dataclass


def half_decades(first: int, last: int) -> list[int]:
    """Returns 10^first to 10^last points in steps of half a decade, rounded to two digits."""
    return [int(round(10 ** (step / 2), 1 - step // 2)) for step in range(2 * first, 2 * last + 1)]


@dataclass(frozen=True)
class Settings:
    sizes: list[int]  # For figures 4 and 6.
    most_rounds: int  # The maximum for every contender at every size.
    least_rounds: int  # The minimum for our methods, up to the size for which the loss is reported.
    # The time in seconds per contender and size, which determines the number of rounds between least_rounds and most_rounds.
    contender_seconds: float
    longest_run: float  # Seconds. A contender stops before the size at which one run would take longer.
    shortest_run: float  # Seconds. Small sets are repeated until they have taken this time in total.

    memory_points: int  # For sections 4.2 and 4.3.
    cells: list[float]  # Sizes of accelerator cells in radii.
    cell_rounds: int
    growth_sizes: list[int]  # Set sizes for the memory of wavefront sampling.

    spectrum_sets: int  # Number of sets for figure 5.
    spectrum_side: float  # Width of the windows in radii.
    spectrum_modes: int
    coverage_sets: int
    coverage_points: int

    large_sets: bool  # True to generate the sets of 95 and 750 million points.
    longest_large_run: float  # Seconds. A large set that would take longer is skipped.
    billion_points: float


LOSS_FROM, LOSS_TO = 10**5, 10**7

FULL = Settings(
    sizes=half_decades(3, 8),
    most_rounds=5,
    least_rounds=3,
    contender_seconds=6.0,
    longest_run=25.0,
    shortest_run=0.2,
    memory_points=1_000_000,
    cells=[1, 2, 3, 5, 10, 20, 40],
    cell_rounds=3,
    growth_sizes=[10**5, 10**6, 10**7],
    spectrum_sets=50,
    spectrum_side=96.0,
    spectrum_modes=240,
    coverage_sets=100,
    coverage_points=100_000,
    large_sets=True,
    longest_large_run=3600.0,
    billion_points=1e9,
)

QUICK = Settings(
    sizes=half_decades(3, 4) + [100_000],
    most_rounds=2,
    least_rounds=1,
    contender_seconds=0.5,
    longest_run=3.0,  # Jones' method takes 0.7 s for 100,000 points, and must also finish on a busy machine.
    shortest_run=0.02,
    memory_points=100_000,
    cells=[1, 5, 20],
    cell_rounds=1,
    growth_sizes=[10**4, 10**5],
    spectrum_sets=10,
    spectrum_side=48.0,
    spectrum_modes=120,
    coverage_sets=10,
    coverage_points=20_000,
    large_sets=False,
    longest_large_run=0.0,
    billion_points=1e6,
)
