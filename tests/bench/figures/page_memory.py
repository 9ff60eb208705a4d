"""Writes the sections of the page for memory, large sets and the billion points."""

from __future__ import annotations

from bench.figures import paper
from bench.figures.page_text import Tables, gib, number, percent, picture, prose, rate, ratio, span, table, verdict
from bench.figures.tables import Row, where


def section42(measured: Tables, pictures: str) -> str:
    rows = []
    for row in measured["section42"]:
        reported = paper.BYTES.get((row["method"], row["precision"]))
        theirs = [number(reported.value), ratio(row["workspace"] / reported.value)] if reported else ["", ""]
        sizes = [number(row[name]) for name in ("grid", "squares", "workspace", "resident")]
        rows.append([f"{row['method']}, {row['precision']}", number(row["cell_size"]), *sizes, *theirs])
    return "\n\n".join(
        [
            "## Section 4.2: memory",
            picture(pictures, "section42.svg", "Bytes per point of each variant and precision"),
            prose(
                f"""Bytes per point in addition to the returned points, at
                {number(measured["section42"][0]["points"], 2)} points. "Both" is the sampler's own count. "Process" is
                the peak of the process's resident memory, minus its memory before the call and the returned points.
                The paper's numbers are from {PAPER_BYTES}."""
            ),
            table(["", "cell, r", "grid", "squares", "both", "process", "paper", "ratio"], rows),
        ]
    )


PAPER_BYTES = next(iter(paper.BYTES.values())).where


def section43(measured: Tables, pictures: str) -> str:
    cells, growth = measured["section43_cells"], measured["section43_growth"]
    sizes = ("bare", "grid", "squares", "workspace", "resident")
    growth_rows = [
        [row["precision"], number(row["points"], 2), *(number(row[name]) for name in sizes)] for row in growth
    ]
    grown = [f"wavefront, cells of {growth[0]['cell']} r", "points", "bare points", "grid", "squares", "both"]
    head = ["", "cell, r", "µs per point", "over cells of 1 r", "grid", "grid over bare points", "with squares"]
    return "\n\n".join(
        [
            "## Section 4.3: wavefront sampling",
            picture(
                pictures, "section43.svg", "Time and memory against the width of cells, and memory against set size"
            ),
            prose(
                f"""Accelerator cells of several widths, with {number(cells[0]["points"], 2)} points that stay in the
                cells: bytes per point, and time relative to cells of one radius (median, lowest to highest of
                {cells[0]["rounds"]} rounds). Widths are rounded up to whole base squares."""
            ),
            table(head, [_cell_row(row) for row in cells]),
            "Bytes per point against set size. The points stay in the cells, so the process stores them once:",
            table([*grown, "process"], growth_rows),
            _large(measured),
        ]
    )


def _cell_row(row: Row) -> list[str]:
    overhead = row["grid"] / row["bare"] - 1.0
    return [
        f"{row['method']}, {row['precision']}",
        f"{row['asked_cell']:g}",
        number(row["microseconds"]),
        f"{number(row['slowdown'])} ({span(row['slowdown_lowest'], row['slowdown_highest'])})",
        number(row["grid"]),
        "+" + percent(overhead, 0 if overhead > 1.0 else 1),
        number(row["workspace"]),
    ]


def _large(measured: Tables) -> str:
    if not measured["section43_large"]:
        return "This run skipped the sets that fill a machine's memory."
    rows = []
    for row in measured["section43_large"]:
        limit = f"{row['limit'] / 2**30:.0f} GiB"
        if row["why"]:
            last_growth = where(measured["section43_growth"], precision="single")[-1]
            would = gib(last_growth["resident"] * row["asked"])
            size = number(last_growth["points"], 2)
            reason = f"not run: {row['why']}. Extrapolated from {size} points: {would}"
            rows.append([f"{row['asked']:,.0f}", limit, f"{row['cell']:g} r", "", "", "", "", reason])
        else:
            each = number(row["resident"] / row["points"])
            time = f"{number(row['seconds'])} s, {rate(row['points'] / row['seconds'])}/s"
            losses = [f"{row['coverage']:.6f}", f"{row['discarded']:,}"]
            rows.append(
                [f"{row['points']:,}", limit, f"{row['cell']:g} r", gib(row["resident"]), each, *losses, time]
            )
    head = ["points", "limit", "cells", "peak resident", "bytes per point", "coverage", "squares discarded"]
    head.append("processor time")
    about = f"""The paper's largest sets, by wavefront sampling in single precision, each in a process whose address
        space is limited. Squares that single precision cannot split any further are discarded (§3.3). Up to November
        2026, this left gaps; since then, every representable position is covered. Sets on a lattice of coordinates
        cover less than the {paper.JAMMED_COVERAGE:.6f} of sets in the plane, the more the wider the domain is:"""
    return prose(about) + "\n\n" + table(head, rows)


BILLION_ROWS = {
    "points": lambda row: f"{row['points']:,}",
    "tiles, and their width": lambda row: f"{row['tiles']:,}, {number(row['tile_radii'])} r",
    "threads": lambda row: row["threads"],
    "seconds of wall time": lambda row: number(row["seconds"], 4),
    "points per second": lambda row: rate(row["points_per_second"]),
    "peak resident memory": lambda row: f"{row['resident_bytes'] / 1e6:.1f} MB of {row['resident_limit'] / 1e6:.0f} MB",
    "pairs compared, too close": lambda row: f"{row['pairs']:,}, {row['too_close']}",
    "least squared distance over the squared radius": lambda row: f"{row['least_over_radius']:.9f}",
    "coverage": lambda row: f"{row['coverage']:.7f} ± {row['coverage_error']:.7f}",
    "known loss of coverage by the lattice": lambda row: f"{row['coverage_lattice_loss']:.7f}",
    "standard errors from the jammed coverage": lambda row: f"{row['coverage_z']:+.2f}",
    "tiles checked for gaps, uncovered lattice points": lambda row: f"{row['gap_tiles']:,}, {row['uncovered']}",
    "digest of the set": lambda row: f"`{row['digest']}`",
    "all guarantees hold": lambda row: verdict(not row["broken"]) + (f": {row['broken']}" if row["broken"] else ""),
}


def billion(measured: Tables) -> str:
    rows = measured["billion"]
    body = [[label, *(write_cell(row) for row in rows)] for label, write_cell in BILLION_ROWS.items()]
    same = len({row["digest"] for row in rows}) == 1
    return "\n\n".join(
        [
            f"## Passed: {rows[0]['points']:,} points of one set",
            prose(
                f"""The exact tile sampler generates them tile by tile and discards each tile after its verification.
                Every pair of points near each other is compared, across tiles too. Tiles chosen by a hash are checked
                for gaps on the whole lattice. Two runs, in two orders of tiles; equal digests: {verdict(same)}.
                `tests/bench/billion.cpp` explains each row."""
            ),
            table(["tiles in order", *(row["order"] for row in rows)], body),
        ]
    )
