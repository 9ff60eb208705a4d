"""Lists the point sets and domains of tests/analysis/golden.cpp with their digests, for tests in other languages."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

DIGESTS: dict[str, str] = json.loads((Path(__file__).parent / "core.json").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Set:
    """A rectangle (min x, min y, max x, max y) of a point set."""

    name: str
    seed: int
    rect: tuple[float, float, float, float]
    radius: float = 1.0
    levels: int = 1
    layer: int = 0

    @property
    def digests(self) -> tuple[int, int]:
        """Returns the digests of the positions and of the ranks."""
        return int(DIGESTS[self.name], 16), int(DIGESTS[f"{self.name}: ranks"], 16)


@dataclass(frozen=True)
class Domain:
    """A whole domain that is sampled with one of the methods."""

    name: str
    seed: int
    size: tuple[float, float]
    method: str
    radius: float = 1.0
    toroidal: bool = False
    cell_size: float = 0.0

    def digest(self, precision: str) -> int:
        """Returns the digest of the points. `precision` is "single" or "double"."""
        return int(DIGESTS[f"domain, {self.name}, {precision}"], 16)


SETS = [
    Set("plain, around the origin", 1, (-60.0, -45.0, 70.0, 52.5)),
    Set("plain, another seed and layer", 0xFEDCBA9876543210, (1.0, 2.0, 30.0, 40.0), 0.37, layer=65535),
    Set("plain, 5 000 km out", 2, (5.0e6, -4.9e6, 5.0e6 + 100.0, -4.9e6 + 130.0), 1.5, layer=7),
    Set("plain, the last cells of the world", 3, (5931.60, 5931.60, 5931.64, 5931.64), 1e-3),
    Set("plain, a strip of kilometers", 4, (-9.0e4, 100.0, 9.0e4, 400.0), 50.0),
    Set("two levels", 5, (-80.0, 10.0, 20.0, 90.0), levels=2),
    Set("four levels", 6, (-300.0, -300.0, -100.0, -100.0), 2.0, 4, 1),
    Set("eight levels, 5 000 km out", 7, (-5.0e6, 5.0e6, -5.0e6 + 90.0, 5.0e6 + 90.0), 1.0, 8, 2),
]

DOMAINS = [
    Domain("naive, torus", 9, (41.0, 33.0), "naive", toroidal=True),
    Domain("naive, bounded", 10, (9.0, 31.0), "naive", 0.3),
    Domain("hierarchical, torus", 11, (90.0, 70.0), "hierarchical", toroidal=True),
    Domain("hierarchical, bounded", 0xFEDCBA9876543210, (17.0, 51.5), "hierarchical", 0.37),
    Domain("hierarchical, strip of kilometers", 12, (3.0, 9000.0), "hierarchical", 2.5),
    Domain("accumulator, torus", 13, (33.3, 155.0), "accumulator", toroidal=True),
    Domain("accumulator, bounded", 14, (2.0, 0.5), "accumulator", 0.01),
    Domain("wavefront, torus", 15, (1e8, 7e7), "wavefront", 1e6, toroidal=True),
    Domain("wavefront, bounded", 16, (100.0, 75.5), "wavefront", cell_size=20.0),
]
