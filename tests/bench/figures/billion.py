"""Generates a billion points of one set with the exact tile sampler (tests/bench/billion.cpp), in two orders of
tiles."""

from __future__ import annotations

from bench.figures.programs import Programs, run_lines, say
from bench.figures.settings import Settings
from bench.figures.tables import Row

ORDERS = ("rows", "shuffled")
SHOWN = (
    "order points tiles tile_radii threads seconds points_per_second cpu_seconds resident_bytes resident_limit "
    "radius_squared least_squared pairs too_close coverage coverage_error coverage_lattice_loss coverage_z gap_tiles "
    "uncovered misplaced doubled tiles_missing tiles_repeated digest"
).split()


def measure(programs: Programs, settings: Settings) -> list[Row]:
    """Returns a row for each order. `broken` names the guarantees that were violated."""
    rows = []
    for order in ORDERS:
        program = programs.folder / "bench" / "billion"
        run = run_lines([program, f"points={settings.billion_points:.0f}", f"order={order}"], accepted=(0, 1))[-1]
        rows.append({name: run[name] for name in SHOWN} | {"broken": " ".join(run["broken"])})
        say(f"billion: {run['points']:,} points by {order} in {run['seconds']:.0f} s, digest {run['digest']}")
    return rows
