"""The contenders of figure 4. Turns within a round, tables and colors have this order."""

from __future__ import annotations

from dataclasses import dataclass

OURS, PAPER, TODAY = "ours", "of the paper", "of today"


@dataclass(frozen=True)
class Contender:
    """A method at one precision, and the arguments with which domain_run or a peer runs it."""

    method: str
    precision: str
    label: str
    family: str
    flags: tuple[str, ...] = ()
    is_peer: bool = False

    @property
    def key(self) -> str:
        return f"{self.method}-{self.precision}"


NAIVE_DARTS = 100  # Darts per base square of the naive method.

CONTENDERS = [
    Contender("naive", "double", "naive darts", OURS, ("torus", f"darts={NAIVE_DARTS}")),
    Contender("hierarchical", "single", "hierarchical", OURS, ("torus",)),
    Contender("hierarchical", "double", "hierarchical", OURS, ("torus",)),
    Contender("accumulator", "single", "accumulator", OURS, ("torus",)),
    Contender("accumulator", "double", "accumulator", OURS, ("torus",)),
    Contender("wavefront", "single", "wavefront", OURS, ("torus",)),
    Contender("wavefront", "double", "wavefront", OURS, ("torus",)),
    Contender("tile", "double", "exact tiles", OURS),
    Contender("scalloped", "double", "scalloped sectors", PAPER),
    Contender("boundary", "double", "boundary sampling", PAPER),
    Contender("jones", "double", "Jones, Voronoi tree", PAPER),
    Contender("plain_bridson", "single", "Bridson, plain", TODAY),
    Contender("bridson", "single", "Bridson, tuned", TODAY),
]
