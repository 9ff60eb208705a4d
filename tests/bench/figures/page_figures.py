"""Writes the sections of the page for figures 4, 5 and 6."""

from __future__ import annotations

from bench.figures import paper
from bench.figures.contenders import CONTENDERS, NAIVE_DARTS
from bench.figures.page_text import Tables, number, percent, picture, prose, rate, span, table, verdict
from bench.figures.peers import CONTENDERS as PEERS
from bench.figures.point_sets import SHOWN_SIDE
from bench.figures.tables import Row, where

LABELS = {one.key: f"{one.label}, {one.precision}" for one in CONTENDERS + PEERS}
LOSING = ("hierarchical", "accumulator", "wavefront")


def figure4(measured: Tables, pictures: str) -> str:
    rates = measured["figure4"]
    sizes = sorted({row["asked"] for row in rates})
    decades = [size for size in sizes if size == 10 ** (len(str(size)) - 1)]
    stopped = next(row for row in measured["figure5_coverage"] if not row["ends"])
    first = measured["losses"][0]
    return "\n\n".join(
        [
            "## Figure 4: points per second against set size",
            picture(pictures, "figure4.svg", "Points per second against set size: our methods, and those of the paper"),
            picture(pictures, "figure4_today.svg", "Points per second against set size: our methods, and those of today"),
            prose(
                """Median points per second. The last columns are the number of rounds per size, and the widest spread
                of any size (highest minus lowest, over the median). A contender ends where one run would take too
                long or too much memory."""
            ),
            table(["", *(number(size, 1) for size in decades), "rounds", "spread"], _rate_rows(measured, decades)),
            prose(
                f"""Naive darts are {NAIVE_DARTS} for each base square. They stop at a coverage of
                {stopped["coverage"]:.4f}, short of the jammed state that our other methods reach. Our single-domain
                methods, the baselines of the paper and naive darts work on a torus. Exact tiles are a window onto the
                infinite set, assembled from tiles of 64 r. Bridson and the peers fill a bounded square. For all
                methods, the returned points are counted. Bridson's sets and those of scipy and faster_poisson are not
                maximal, and neither they nor those of boundary sampling are distributed like dart throwing. Bridson,
                boundary sampling, scalloped sectors and Jones are our own implementations, in `tests/bench/common` and
                `tests/bench/baselines`; the peers are the published packages, called by `tests/bench/peers`."""
            ),
            prose(
                f"""Loss of points per second from {number(first["from"], 1)} to {number(first["to"], 1)} points. The
                goal is less than a third:"""
            ),
            table(["", "lost", "between any two rounds", "less than a third"], _loss_rows(measured["losses"])),
        ]
    )


def _rate_rows(measured: Tables, decades: list[int]) -> list[list[str]]:
    rates, rounds = measured["figure4"], {row["contender"]: row for row in measured["figure4_rounds"]}
    rows = []
    for key, label in LABELS.items():
        own_rates = {row["asked"]: row for row in where(rates, contender=key)}
        if own_rates:
            widest = max((row["highest"] - row["lowest"]) / row["median"] for row in own_rates.values())
            cells = [rate(own_rates[size]["median"]) if size in own_rates else "" for size in decades]
            rows.append([label, *cells, span(rounds[key]["least"], rounds[key]["most"], str), percent(widest, 0)])
    return rows


def _loss_rows(losses: list[Row]) -> list[list[str]]:
    return [
        [
            LABELS[row["contender"]],
            percent(row["loss"]),
            span(row["least"], row["most"], percent),
            verdict(row["loss"] < 1 / 3),
        ]
        for row in losses
        if row["contender"].partition("-")[0] in LOSING
    ]


NO_SETS = """Missing here: pictures of point sets and their spectra. Their data is too large to be committed. In a few minutes,
    `bash tests/bench/figures.sh --only sets` measures them and writes this page with them; the other numbers then come
    from the committed data."""


def figure5(measured: Tables, pictures: str, has_sets: bool) -> str:
    radial = measured["figure5_radial"]
    sets, side = radial[0]["sets"], radial[0]["side"]
    spectra = [
        [
            row["label"],
            row["sets"],
            "the reference" if row_index == 0 else number(row["p"], 2),
            f"{row['anisotropy_db']:.2f} dB",
            f"{row['expected_db']:.2f} dB",
        ]
        for row_index, row in enumerate(measured["figure5_spectra"])
    ]
    coverage = [
        [
            row["label"],
            f"{row['sets']:,}",
            f"{row['points']:,}",
            f"{row['coverage']:.6f} ± {row['error']:.6f}",
            f"{row['z']:+.2f}" if row["ends"] else "stops early",
            verdict(abs(row["z"]) < 4.0) if row["ends"] else "",
        ]
        for row in measured["figure5_coverage"]
    ]
    return "\n\n".join(
        [
            "## Figure 5: point sets and spectra",
            *(
                [
                    picture(pictures, "figure5_sets.png", "Point sets of four methods, and their averaged periodograms"),
                    f"Above, {SHOWN_SIDE:.0f} r by {SHOWN_SIDE:.0f} r of a set; below, the mean of the periodograms.",
                ]
                if has_sets
                else [prose(NO_SETS)]
            ),
            prose(
                f"""Spectra are means of {sets} periodograms of windows of {number(side, 2)} r, without the mean
                density in the middle. Naive darts run to their end here: `tests/analysis/naive_darts.hpp`, which
                shares no code with the samplers."""
            ),
            picture(pictures, "figure5_radial.svg", "Radial mean of the power, its differences, and anisotropy"),
            prose(
                """Anisotropy is the variance of the averaged power within a ring over its squared mean. The last
                column is the expected value for this number of periodograms of an isotropic set. The p-value tests
                whether radial means differ from those of naive darts only by chance (Hotelling's test, independent
                sets)."""
            ),
            table(["", "sets", "p-value", "anisotropy, mean of the rings", "without directions"], spectra),
            prose(
                f"""Coverage by disks of diameter r, compared with the {paper.JAMMED_COVERAGE:.6f} at which random
                sequential adsorption jams. Domains are tori and windows onto the infinite set, so borders have no
                effect:"""
            ),
            table(["", "sets", "points", "coverage and standard error", "z", "\\|z\\| < 4"], coverage),
        ]
    )


def figure6(measured: Tables, pictures: str) -> str:
    rows = []
    for row in measured["figure6_ranges"]:
        spans = [
            span(row[name + "_least"], row[name + "_most"], write)
            for name, write in zip(("asked", "squares", "checks"), WRITERS, strict=True)
        ]
        rows.append([LABELS[row["contender"]], *spans, number(1e6 * row["discarded"])])
    head = [
        "",
        "points",
        "squares per accepted dart",
        "list checks per selection",
        "discarded per million points, at most",
    ]
    least, most, checks = paper.SQUARES_LEAST, paper.SQUARES_MOST, paper.LIST_CHECKS_MOST
    return "\n\n".join(
        [
            "## Figure 6: squares and list checks",
            picture(
                pictures, "figure6.svg", "Squares per accepted dart and list checks per selection against set size"
            ),
            prose(
                f"""Counted in the runs of figure 4: lowest to highest of all sizes. The paper has {least.value:.0f} to
                {most.value:.0f} squares per accepted dart ({least.where}) and less than {checks.value:.0f} list checks
                ({checks.where}). Discarded squares are too small for the precision (§3.3)."""
            ),
            table(head, rows),
        ]
    )


WRITERS = (lambda size: number(size, 2), number, number)
