"""Measures sections 4.2 and 4.3: bytes per point, the size of accelerator cells, and sets that fill a machine's
memory."""

from __future__ import annotations

import math
import statistics

from bench.figures.paper import LARGE_SETS, LargeSet
from bench.figures.programs import Failed, Programs, Run, say
from bench.figures.settings import Settings
from bench.figures.speed import memory_available
from bench.figures.tables import Row

VARIANTS = ("hierarchical", "accumulator", "wavefront")
PRECISIONS = ("single", "double")
GROWTH_CELL = 10  # A cell size in radii. Cells of this size need slightly more memory than the points alone.
LEAST_BYTES = 10.0  # Per point in single precision. If less memory is free, a large set is skipped.
COORDINATES = {"single": 8, "double": 16}  # Bytes of a point without any grid.


def measure_variants(programs: Programs, settings: Settings) -> list[Row]:
    """Measures section 4.2 of the paper: bytes per point of each variant, as the sampler counts them. The
    bytes are also measured as the peak memory of the process, minus the memory before the call, minus the returned points."""
    rows = []
    for method in VARIANTS:
        for precision in PRECISIONS:
            run = programs.domain(method, precision, settings.memory_points, 1, "torus")[0]
            points = run["points"]
            resident = run["resident_peak"] - run["resident_before"] - run["output_bytes"]
            rows.append(
                {
                    "method": method,
                    "precision": precision,
                    "points": points,
                    "cell_size": run["cell_size"],
                    "grid": run["grid_bytes"] / points,
                    "squares": run["square_bytes"] / points,
                    "workspace": run["workspace_bytes"] / points,
                    "resident": resident / points,
                }
            )
            say(f"section 4.2: {method}, {precision}: {run['workspace_bytes'] / points:.1f} bytes per point")
    return rows


def measure_cells(programs: Programs, settings: Settings) -> list[Row]:
    """Measures section 4.3 of the paper: time and memory with accelerator cells of several sizes, which take turns within each round. Points stay
    in the cells."""
    runs: dict[tuple[str, str, float], list[Run]] = {}
    for round_number in range(settings.cell_rounds):
        for method in ("accumulator", "wavefront"):
            for precision in PRECISIONS:
                for cell in settings.cells:
                    line = programs.domain(
                        method, precision, settings.memory_points, 1 + round_number, "torus", "fill", cell=cell
                    )
                    runs.setdefault((method, precision, cell), []).extend(line)
        say(f"section 4.3: cells of {settings.cells} radii, round {round_number + 1} of {settings.cell_rounds}")
    return [_cell_row(*key, runs_of_key, runs[*key[:2], settings.cells[0]]) for key, runs_of_key in runs.items()]


def _cell_row(method: str, precision: str, cell: float, runs: list[Run], with_small_cells: list[Run]) -> Row:
    slowdown = [run["seconds"] / small["seconds"] for run, small in zip(runs, with_small_cells, strict=True)]
    seconds = [run["seconds"] / run["points"] for run in runs]
    points = runs[0]["points"]
    return {
        "method": method,
        "precision": precision,
        "asked_cell": cell,
        "cell_size": runs[0]["cell_size"],
        "points": points,
        "rounds": len(runs),
        "microseconds": 1e6 * statistics.median(seconds),
        "slowdown": statistics.median(slowdown),
        "slowdown_lowest": min(slowdown),
        "slowdown_highest": max(slowdown),
        "grid": runs[0]["grid_bytes"] / points,
        "squares": runs[0]["square_bytes"] / points,
        "workspace": runs[0]["workspace_bytes"] / points,
        "bare": COORDINATES[precision],
    }


def measure_growth(programs: Programs, settings: Settings) -> list[Row]:
    """Measures section 4.3 of the paper: bytes per point of wavefront sampling over the set size, with large cells. Points stay in the cells."""
    rows = []
    for precision in PRECISIONS:
        for size in settings.growth_sizes:
            run = programs.domain("wavefront", precision, size, 1, "torus", "fill", cell=GROWTH_CELL)[0]
            points = run["points"]
            rows.append(
                {
                    "precision": precision,
                    "cell": GROWTH_CELL,
                    "points": points,
                    "seconds": run["seconds"],
                    "grid": run["grid_bytes"] / points,
                    "squares": run["square_bytes"] / points,
                    "workspace": run["workspace_bytes"] / points,
                    "resident": (run["resident_peak"] - run["resident_before"]) / points,
                    "bare": COORDINATES[precision],
                }
            )
            say(f"section 4.3: {size:,} points, {precision}: {run['workspace_bytes'] / points:.2f} bytes per point")
    return rows


def measure_large(programs: Programs, settings: Settings) -> list[Row]:
    """Measures section 4.3 of the paper: its largest sets, by wavefront sampling in single precision, with a hard limit on the address space. A
    set that needs more memory than this machine has, or would take too long, is skipped. Its row then has the reason."""
    rows: list[Row] = []
    for large in LARGE_SETS:
        rates = [row["points"] / row["seconds"] for row in rows if row["seconds"]]
        expected = large.points / min(rates) if rates else 0.0
        rows.append(_fill(programs, large, expected, settings.longest_large_run))
    return rows


def _fill(programs: Programs, large: LargeSet, expected: float, longest: float) -> Row:
    """Generates a large set. `expected` is its expected duration in seconds; 0 if unknown."""
    row: Row = {
        "asked": large.points,
        "cell": large.cell,
        "limit": large.limit_bytes,
        "available": memory_available(),
    }
    row |= dict.fromkeys(("points", "seconds", "workspace", "resident", "cell_size", "discarded", "coverage"), 0.0)
    row["why"] = ""
    name = f"section 4.3: {large.points / 1e6:.0f} million points within {large.limit_bytes / 2**30:.0f} GiB"
    if row["available"] < LEAST_BYTES * large.points:
        row["why"] = f"only {row['available'] / 2**30:.1f} GiB of memory were free"
    elif expected > longest:
        row["why"] = f"it would take {expected / 60.0:.0f} minutes"
    if row["why"]:
        say(f"{name}: left out, {row['why']}")
        return row
    say(name)
    try:
        flags = ("torus", "fill")
        options = {"cell": large.cell, "limit_bytes": large.limit_bytes}
        run = programs.domain("wavefront", "single", large.points, 1, *flags, **options)[0]
    except Failed as failed:
        row["why"] = str(failed).rpartition(": ")[2]
        say(f"{name}: {failed}")
        return row
    say(f"{name}: {run['seconds']:.0f} s, {run['resident_peak'] / 2**30:.2f} GiB")
    row |= {name: run[name] for name in ("points", "seconds", "cell_size", "discarded")}
    row |= {"workspace": run["workspace_bytes"], "resident": run["resident_peak"]}
    return row | {"coverage": run["points"] * math.pi / 4.0 / run["size"] ** 2}
