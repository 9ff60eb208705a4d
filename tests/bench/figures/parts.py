"""Defines the parts that can be measured separately, and the tables that they write."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.figures import billion, memory, point_sets, speed, tables
from bench.figures.programs import Programs
from bench.figures.settings import LOSS_FROM, LOSS_TO, Settings

ARRAYS = "figure5_pictures.npz"


def _speed(programs: Programs, settings: Settings, out: Path) -> None:
    runs = speed.measure(programs, programs.contenders, settings)
    rates = speed.summarise(runs)
    sizes = (LOSS_FROM, LOSS_TO) if LOSS_TO in settings.sizes else (settings.sizes[0], settings.sizes[-1])
    tables.write(out / "figure4_runs.csv", runs)
    tables.write(out / "figure4.csv", rates)
    tables.write(out / "figure6.csv", speed.counts(runs))
    tables.write(out / "losses.csv", speed.losses(rates, *sizes))


def _sets(programs: Programs, settings: Settings, out: Path) -> None:
    rows, whole, arrays = point_sets.measure_spectra(programs, settings)
    tables.write(out / "figure5_radial.csv", rows)
    tables.write(out / "figure5_spectra.csv", whole)
    np.savez_compressed(out / ARRAYS, **arrays)
    tables.write(out / "figure5_coverage.csv", point_sets.measure_coverage(programs, settings))


def _memory(programs: Programs, settings: Settings, out: Path) -> None:
    tables.write(out / "section42.csv", memory.measure_variants(programs, settings))
    tables.write(out / "section43_cells.csv", memory.measure_cells(programs, settings))
    tables.write(out / "section43_growth.csv", memory.measure_growth(programs, settings))


def _large(programs: Programs, settings: Settings, out: Path) -> None:
    if settings.large_sets:
        tables.write(out / "section43_large.csv", memory.measure_large(programs, settings))


def _billion(programs: Programs, settings: Settings, out: Path) -> None:
    tables.write(out / "billion.csv", billion.measure(programs, settings))


@dataclass(frozen=True)
class Part:
    """A part of the measurements. `measure` writes the files `tables` into a folder."""

    shows: str
    measure: Callable[[Programs, Settings, Path], None]
    tables: tuple[str, ...]


PARTS = {
    "speed": Part("figures 4 and 6", _speed, ("figure4_runs.csv", "figure4.csv", "figure6.csv", "losses.csv")),
    "sets": Part("figure 5", _sets, ("figure5_radial.csv", "figure5_spectra.csv", "figure5_coverage.csv")),
    "memory": Part("section 4.2, cells", _memory, ("section42.csv", "section43_cells.csv", "section43_growth.csv")),
    "large": Part("the sets that fill memory", _large, ("section43_large.csv",)),
    "billion": Part("the billion", _billion, ("billion.csv",)),
}
TABLES = [table for part in PARTS.values() for table in part.tables]
