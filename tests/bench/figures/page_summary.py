"""Writes the first table of the page: each number of the paper, ours, and their ratio."""

from __future__ import annotations

from bench.figures import paper
from bench.figures.page_text import Tables, gib, number, prose, rate, ratio, span, table
from bench.figures.tables import Row, where


def summary(measured: Tables) -> str:
    rows = [*_rates(measured["figure4"]), *_counts(measured["figure6_ranges"]), *_bytes(measured["section42"])]
    rows += [*_cells(measured["section43_cells"]), *_large(measured["section43_large"])]
    rows.append(_largest(measured["billion"][0]))
    about = """If the ratio of two methods' speeds is below the paper's, our version of the slower method has gained
        more since 2007 than the accumulator."""
    columns = ["", "paper", "ours", "lowest to highest", "ratio", "where"]
    return "\n\n".join(["## The paper, ours, the ratio", table(columns, rows), prose(about)])


def _rates(rates: list[Row]) -> list[list[str]]:
    """Returns the rows for speed at the paper's set size, or at the nearest measured one."""
    size = min({row["asked"] for row in rates}, key=lambda asked: abs(asked - paper.RATE_POINTS))
    at = {row["contender"]: row for row in rates if row["asked"] == size}
    of_size = f"points per second at {number(size, 1)} points"
    rows = []
    for key in ("accumulator-single", "accumulator-double", "jones-double", "scalloped-double"):
        method, _, precision = key.partition("-")
        if key in at:
            reported, own = paper.RATES[method], at[key]
            spread = span(own["lowest"], own["highest"], rate)
            method_label = {"jones": "Jones", "scalloped": "scalloped sectors"}.get(method, f"{method}, {precision}")
            cells = [rate(reported.value), rate(own["median"]), spread, ratio(own["median"] / reported.value)]
            rows.append([f"{method_label}, {of_size}", *cells, reported.where])
    fast, tiles = at["accumulator-double"], at["tile-double"]
    theirs = paper.RATES["accumulator"]
    spread = span(tiles["lowest"], tiles["highest"], rate)
    ours = [rate(theirs.value), rate(tiles["median"]), spread, ratio(tiles["median"] / theirs.value)]
    rows.append([f"exact tiles (the paper: its accumulator), {of_size}", *ours, theirs.where])
    for key, label in (("jones-double", "Jones"), ("scalloped-double", "scalloped sectors")):
        if key in at:
            expected = theirs.value / paper.RATES[key.partition("-")[0]].value
            rows.append([f"accumulator over {label}", *_quotient(fast, at[key], expected), theirs.where])
    if "boundary-double" in at:
        expected = paper.OVER_BOUNDARY
        cells = _quotient(fast, at["boundary-double"], expected.value)
        rows.append(["accumulator over boundary sampling", "on par", *cells[1:], expected.where])
    return rows


def _quotient(above: Row, below: Row, expected: float) -> list[str]:
    """Returns the cells for the ratio of two methods' speeds: the paper's ratio, ours, its spread, and the quotient of
    both ratios."""
    value = above["median"] / below["median"]
    spread = span(above["lowest"] / below["highest"], above["highest"] / below["lowest"])
    return [number(expected), number(value), spread, ratio(value / expected)]


def _counts(counts: list[Row]) -> list[list[str]]:
    squares = [row["squares" + end] for row in counts for end in ("_least", "_most")]
    checks = [row["checks" + end] for row in counts for end in ("_least", "_most")]
    least, most = paper.SQUARES_LEAST, paper.SQUARES_MOST
    middle = 0.5 * (min(squares) + max(squares)) / (0.5 * (least.value + most.value))
    limit = paper.LIST_CHECKS_MOST
    return [
        [
            "squares per accepted dart, all sizes and variants",
            f"{least.value:.0f} to {most.value:.0f}",
            number(0.5 * (min(squares) + max(squares))),
            span(min(squares), max(squares)),
            ratio(middle),
            least.where,
        ],
        [
            "list checks per selection, all sizes and variants",
            f"less than {limit.value:.0f}",
            number(max(checks)),
            span(min(checks), max(checks)),
            ratio(max(checks) / limit.value),
            limit.where,
        ],
    ]


def _bytes(memory: list[Row]) -> list[list[str]]:
    rows = []
    for (method, precision), reported in paper.BYTES.items():
        own = where(memory, method=method, precision=precision)[0]["workspace"]
        label = f"bytes per point, {method}, {precision}"
        rows.append([label, number(reported.value), number(own), "exact", ratio(own / reported.value), reported.where])
    return rows


def _cells(cells: list[Row]) -> list[list[str]]:
    reported = paper.LARGE_CELL_SLOWDOWN
    rows = []
    for own in where(cells, method="accumulator", asked_cell=paper.LARGE_CELL):
        label = f"time with cells of 20 r over cells of 1 r, accumulator, {own['precision']}"
        spread = span(own["slowdown_lowest"], own["slowdown_highest"])
        cells_of_row = [
            number(reported.value),
            number(own["slowdown"]),
            spread,
            ratio(own["slowdown"] / reported.value),
        ]
        rows.append([label, *cells_of_row, reported.where])
    return rows


def _large(large: list[Row]) -> list[list[str]]:
    rows = []
    for own, reported in zip(large, paper.LARGE_SETS, strict=False):
        theirs = reported.paper_bytes
        ours = ["not run", "", ""] if own["why"] else [gib(own["resident"]), "one run", ratio(own["resident"] / theirs)]
        label = f"memory for {reported.points / 1e6:.0f} million points, wavefront"
        rows.append([label, f"at most {theirs / 2**30:.0f} GiB", *ours, reported.where])
    return rows


def _largest(billion: Row) -> list[str]:
    """Returns the row for the largest set of all, by the exact tile sampler."""
    reported = max(paper.LARGE_SETS, key=lambda large: large.points)
    ours = [f"{billion['points']:,}", "two runs", ratio(billion["points"] / reported.points)]
    return ["points of the largest set", f"{reported.points:,.0f}", *ours, reported.where]
