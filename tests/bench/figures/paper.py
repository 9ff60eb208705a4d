"""The numbers of the paper on which the sampler is based: White, Cline and Egbert, "Poisson Disk Point Sets by
Hierarchical Dart Throwing" (2007), with their locations in it. All other numbers of the page are measured."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Reported:
    """A value from the paper, and its section or figure."""

    value: float
    where: str


# Points per second at 100,000 points, on one core of a 2.13 GHz Core 2 Duo.
RATE_POINTS = 100_000
RATES = {
    "accumulator": Reported(211_000, "§4.1"),
    "jones": Reported(4_050, "§4.1"),
    "scalloped": Reported(778, "§4.1"),
}
# The accumulator's points per second, relative to boundary sampling.
OVER_BOUNDARY = Reported(1.0, "§4.1")

# Figure 6: active squares per accepted dart, and list checks per selection.
SQUARES_LEAST = Reported(9.0, "§4.2, figure 6")
SQUARES_MOST = Reported(10.0, "§4.2, figure 6")
LIST_CHECKS_MOST = Reported(3.0, "§3.3, figure 6")

# Bytes per point, not counting the points themselves.
BYTES = {
    ("hierarchical", "single"): Reported(120, "§4.2"),
    ("accumulator", "double"): Reported(416, "§4.2"),
}

# The duration with accelerator cells of this many radii, relative to cells of one radius.
LARGE_CELL = 20
LARGE_CELL_SLOWDOWN = Reported(2.5, "§4.3")

GIB = 2**30


@dataclass(frozen=True)
class LargeSet:
    """The number of points that a machine with this memory could generate and store."""

    points: float
    paper_bytes: float
    limit_bytes: float  # The limit of our run.
    cell: float  # Radii. The fastest size that fits the limit.
    where: str = "§4.3"


LARGE_SETS = [LargeSet(95e6, 2 * GIB, 2 * GIB, cell=10), LargeSet(750e6, 32 * GIB, 24 * GIB, cell=2.8)]

# Fraction of the plane that disks cover once no additional disk fits. This number is not from the paper, but from random sequential adsorption of
# disks, which is naive dart throwing until no dart fits.
JAMMED_COVERAGE = 0.547070
