"""Measures figure 5: point sets, spectra and coverage of methods whose sets should all have the same distribution."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from analysis.significance import means_differ

from bench.figures.contenders import NAIVE_DARTS
from bench.figures.paper import JAMMED_COVERAGE
from bench.figures.programs import Programs, say
from bench.figures.settings import Settings
from bench.figures.spectra import AveragedSpectrum, noise_level, ring_edges
from bench.figures.tables import Row

DENSITY = JAMMED_COVERAGE * 4.0 / np.pi  # Points per square radius.
RINGS = 75
RINGS_TOGETHER = 5  # Rings to average in the test for equal spectra, which needs more sets than features.
SHOWN_SIDE = 24.0  # The width of plots of point sets in radii.


@dataclass(frozen=True)
class Source:
    """A method whose sets are analyzed. `flags` are arguments of domain_run."""

    key: str
    label: str
    method: str
    flags: tuple[str, ...] = ()
    ends: bool = True  # True if the method runs to the jammed state.


SOURCES = [
    Source("naive", "naive darts", "reference"),
    Source("hierarchical", "hierarchical", "hierarchical", ("torus",)),
    Source("wavefront", "wavefront", "wavefront", ("torus",)),
    Source("tile", "exact tiles", "tile"),
]
# Only the coverage of this source is reported, because it stops before the jammed state.
STOPPED = Source(
    "naive_stopped", f"naive darts, {NAIVE_DARTS} a square", "naive", ("torus", f"darts={NAIVE_DARTS}"), False
)


def read_sets(path: Path) -> list[np.ndarray]:
    """Returns the sets in a dump of domain_run, each as (n, 2) coordinates in radii."""
    data, sets, place = path.read_bytes(), [], 0
    while place < len(data):
        count = int(np.frombuffer(data, "<u8", 1, place)[0])
        sets.append(np.frombuffer(data, "<f8", 2 * count, place + 8).reshape(count, 2))
        place += 8 + 16 * count
    return sets


def make_sets(programs: Programs, source: Source, side: float, sets: int, seed: int) -> list[np.ndarray]:
    """Generates sets in domains that are at least this wide, in radii. Domains may be slightly wider, because domain_run takes
    a number of points."""
    with tempfile.TemporaryDirectory() as folder:
        dump = Path(folder) / "sets"
        programs.domain(
            source.method, "double", np.ceil(DENSITY * side * side), seed, *source.flags, sets=sets, dump=dump
        )
        return read_sets(dump)


def p_of_equal_means(a: AveragedSpectrum, b: AveragedSpectrum) -> float:
    """Returns the probability that radial means differ at least this much by chance; 1 for identical sources."""
    rows = [point_set.radial_of_sets.reshape(point_set.sets, -1, RINGS_TOGETHER).mean(axis=2) for point_set in (a, b)]
    return 1.0 if a is b else means_differ(*rows)


def measure_spectra(programs: Programs, settings: Settings) -> tuple[list[Row], list[Row], dict[str, np.ndarray]]:
    """Returns the radial table, the table of whole spectra and, for the plots, arrays of the power over the plane
    and the points of one set, by key."""
    rows: list[Row] = []
    whole: list[Row] = []
    arrays: dict[str, np.ndarray] = {}
    side, modes = settings.spectrum_side, settings.spectrum_modes
    edges = ring_edges(modes, side, RINGS)
    reference = None
    for source in SOURCES:
        sets = make_sets(programs, source, side, settings.spectrum_sets, seed=1)
        spectrum = AveragedSpectrum(sets, side, modes, edges)
        reference = spectrum if reference is None else reference
        head = {"source": source.key, "label": source.label, "sets": len(sets)}
        anisotropy = {"anisotropy_db": float(spectrum.anisotropy().mean()), "expected_db": noise_level(len(sets))}
        whole.append(head | {"p": p_of_equal_means(reference, spectrum)} | anisotropy)
        columns = (edges[:-1], edges[1:], spectrum.radial(), spectrum.radial_error(), spectrum.anisotropy())
        for low, high, power, error, anisotropy in zip(*columns, strict=True):
            head = {"source": source.key, "sets": len(sets), "side": side, "from": low, "to": high}
            rows.append(head | {"power": power, "error": error, "anisotropy_db": anisotropy})
        arrays[source.key + "_power"] = spectrum.image().astype(np.float32)
        arrays[source.key + "_points"] = sets[0][np.all(sets[0] < SHOWN_SIDE, axis=1)]
        say(f"figure 5: spectrum of {source.label}, {len(sets)} sets")
    arrays["highest_frequency"] = np.array(modes / side)
    return rows, whole, arrays


def measure_coverage(programs: Programs, settings: Settings) -> list[Row]:
    """Measures the coverage of sets with independent seeds: points * pi / 4, divided by the area in square radii.
    Borders have no effect, because opposite edges meet, or the domain is a window onto an infinite set."""
    rows = []
    for source in [*SOURCES, STOPPED]:
        sets = settings.coverage_sets if source.ends else max(2, settings.coverage_sets // 10)
        runs = programs.domain(source.method, "double", settings.coverage_points, 100_001, *source.flags, sets=sets)
        coverage = np.array([run["points"] * np.pi / 4.0 / run["size"] ** 2 for run in runs])
        error = float(coverage.std(ddof=1) / np.sqrt(sets))
        rows.append(
            {
                "source": source.key,
                "label": source.label,
                "ends": source.ends,
                "sets": sets,
                "points": sum(run["points"] for run in runs),
                "coverage": float(coverage.mean()),
                "error": error,
                "z": float((coverage.mean() - JAMMED_COVERAGE) / error),
            }
        )
        say(f"figure 5: coverage of {source.label}: {coverage.mean():.6f} +- {error:.1e}")
    return rows
