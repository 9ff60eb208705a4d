"""The page: what the paper reports, what was measured here, and the one over the other. Every number of ours comes from the
tables in the folder of the results, every number of the paper from paper.py."""

from __future__ import annotations

from bench.figures import paper
from bench.figures.contenders import CONTENDERS, NAIVE_DARTS
from bench.figures.page_summary import summary
from bench.figures.page_text import gib, number, percent, picture, rate, ratio, span, table, verdict
from bench.figures.parts import PARTS
from bench.figures.peers import CONTENDERS as PEERS
from bench.figures.spectra import noise_level
from bench.figures.tables import Row, where

Tables = dict[str, list[Row]]


def write(measured: Tables, facts: dict[str, Row], pictures: str) -> str:
    """The page in Markdown, from all tables by name and the machine of each part; `pictures` is the folder of the plots as seen from the page."""
    parts = [
        _head(facts),
        summary(measured),
        _figure4(measured, pictures),
        _figure5(measured, pictures),
        _figure6(measured, pictures),
        _section42(measured, pictures),
        _section43(measured, pictures),
        _billion(measured),
        _how(measured),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _head(facts: dict[str, Row]) -> str:
    first = facts["speed"]
    others = [
        f"{PARTS[name].shows} on {one['date']} at commit {one['commit']}"
        for name, one in facts.items()
        if (one["date"], one["commit"]) != (first["date"], first["commit"])
    ]
    parts = [
        "# The seed paper, measured again",
        "White, Cline and Egbert, *Poisson Disk Point Sets by Hierarchical Dart Throwing* (2007), figure by figure: the paper's "
        "number, ours, and ours over the paper's. `bash tests/bench/figures.sh` measures everything and writes this page; no "
        "number of ours is typed in. The paper timed on a 2.13 GHz Core 2 Duo (figure 4), so ratios of speed hold the years "
        "between the machines, too; ratios between methods on one machine do not.",
        f"Measured on {first['date']} at commit {first['commit']}"
        + (f" ({'; '.join(others)})" if others else "")
        + f": {first['processor']}, {first['cores']} cores, {first['memory_gib']:.0f} GiB, {first['system']}; "
        f"{first['compiler']}, `{first['flags']}`. Times are processor time of one core and one process a run, medians with the "
        "lowest and highest round behind them; contenders take turns within each round.",
    ]
    if any(one["quick"] for one in facts.values()):
        parts.append("**This is a quick run with small sets: its numbers say that the command works, and little else.**")
    return "\n\n".join(parts)


def _labels() -> dict[str, str]:
    return {one.key: f"{one.label}, {one.precision}" for one in CONTENDERS + PEERS}


def _figure4(measured: Tables, pictures: str) -> str:
    rates = measured["figure4"]
    sizes = sorted({row["asked"] for row in rates})
    decades = [size for size in sizes if round(size) == 10 ** (len(str(int(size))) - 1)]
    rows = []
    for key, label in _labels().items():
        own = {row["asked"]: row for row in where(rates, contender=key)}
        if own:
            widest = max((row["highest"] - row["lowest"]) / row["median"] for row in own.values())
            cells = [rate(own[size]["median"]) if size in own else "" for size in decades]
            rounds = [row["rounds"] for row in own.values()]
            rows.append([label, *cells, span(min(rounds), max(rounds), str), percent(widest, 0)])
    stopped = measured["figure5_coverage"][-1]
    losses = [
        [_labels()[row["contender"]], percent(row["loss"]), span(row["least"], row["most"], percent), verdict(row["loss"] < 1 / 3)]
        for row in measured["losses"]
        if row["contender"].partition("-")[0] in ("hierarchical", "accumulator", "wavefront")
    ]
    first = measured["losses"][0]
    return "\n\n".join(
        [
            "## Figure 4: points a second against set size",
            picture(pictures, "figure4.svg", "Points a second against set size: our methods, and those that the paper has"),
            picture(pictures, "figure4_today.svg", "Points a second against set size: our methods, and those of today"),
            "Median points a second; the last columns tell the rounds of a size, and the widest spread of any size (highest less "
            "lowest, over the median). A contender ends where one run would take too long or too much memory.",
            table(["", *(number(size, 1) for size in decades), "rounds", "spread"], rows),
            f"Naive darts are {NAIVE_DARTS} for each base square, which end at a coverage of {stopped['coverage']:.4f}, short of "
            "the jammed state that all others of ours reach. Our single-domain methods, the baselines of the paper and naive "
            "darts work on a torus; exact tiles are a window onto the infinite set, put together from tiles of 64 r; Bridson and "
            "the peers fill a bounded square. Points handed out are counted, whatever the method; Bridson's sets and the peers' "
            "are not maximal, and neither they nor boundary sampling's are those of dart throwing. Bridson, boundary sampling, "
            "scalloped sectors and Jones are our own implementations, in `tests/bench/common` and `tests/bench/baselines`; the "
            "peers are the published packages, called by `tests/bench/peers`.",
            f"What the points a second lose from {number(first['from'], 1)} to {number(first['to'], 1)} points; less than a third "
            "is asked for:",
            table(["", "lost", "between any two rounds", "less than a third"], losses),
        ]
    )


def _figure5(measured: Tables, pictures: str) -> str:
    radial = measured["figure5_radial"]
    sets, side = radial[0]["sets"], radial[0]["side"]
    rows = []
    for row in measured["figure5_coverage"]:
        z = f"{row['z']:+.2f}" if row["ends"] else "stops early"
        within = verdict(abs(row["z"]) < 4.0) if row["ends"] else ""
        coverage = f"{row['coverage']:.6f} ± {row['error']:.6f}"
        rows.append([row["label"], f"{row['sets']:,}", f"{row['points']:,}", coverage, z, within])
    return "\n\n".join(
        [
            "## Figure 5: point sets and spectra",
            picture(pictures, "figure5_sets.png", "Point sets of four methods, and their averaged periodograms"),
            f"Above, 24 r by 24 r of a set; below, the mean of {sets} periodograms of windows of {number(side)} r, the mean "
            "density in the middle left out. Naive darts are thrown to their end here: `tests/analysis/naive_darts.hpp`, which "
            "shares no code with the samplers.",
            picture(pictures, "figure5_radial.svg", "Radial mean of the power, its differences, and anisotropy"),
            f"Anisotropy is the variance of the averaged power within a ring over its squared mean; {sets} periodograms of a set "
            f"without directions have {noise_level(sets):.1f} dB.",
            "Coverage by disks of diameter r, against the "
            f"{paper.JAMMED_COVERAGE:.6f} at which random sequential adsorption jams; tori, and windows onto the infinite set, so that "
            "no border counts:",
            table(["", "sets", "points", "coverage and standard error", "z", "within 4"], rows),
        ]
    )


def _figure6(measured: Tables, pictures: str) -> str:
    counts = measured["figure6"]
    rows = []
    for key in dict.fromkeys(row["contender"] for row in counts):
        own = where(counts, contender=key)
        rows.append(
            [
                _labels()[key],
                span(min(row["asked"] for row in own), max(row["asked"] for row in own), lambda size: number(size, 2)),
                span(min(row["squares"] for row in own), max(row["squares"] for row in own)),
                span(min(row["checks"] for row in own), max(row["checks"] for row in own)),
                number(1e6 * max(row["discarded"] for row in own)),
            ]
        )
    head = ["", "points", "squares per accepted dart", "list checks per selection", "squares discarded, most, per million points"]
    return "\n\n".join(
        [
            "## Figure 6: squares and list checks",
            picture(pictures, "figure6.svg", "Squares per accepted dart and list checks per selection against set size"),
            "Counted in the runs of figure 4: lowest to highest of all sizes. The paper has "
            f"{number(paper.SQUARES_LEAST.value, 1)} to {number(paper.SQUARES_MOST.value, 2)} squares per accepted dart "
            f"({paper.SQUARES_LEAST.where}) and less than {number(paper.LIST_CHECKS_MOST.value, 1)} list checks "
            f"({paper.LIST_CHECKS_MOST.where}). Discarded squares are those smaller than the precision goes (§3.3).",
            table(head, rows),
        ]
    )


def _section42(measured: Tables, pictures: str) -> str:
    rows = []
    for row in measured["section42"]:
        reported = paper.BYTES.get((row["method"], row["precision"]))
        theirs = [number(reported.value), ratio(row["workspace"] / reported.value)] if reported else ["", ""]
        sizes = [number(row[name]) for name in ("grid", "squares", "workspace", "resident")]
        rows.append([f"{row['method']}, {row['precision']}", number(row["cell_size"]), *sizes, *theirs])
    head = ["", "cell, r", "grid", "squares", "both", "process", "paper", "ratio"]
    return "\n\n".join(
        [
            "## Section 4.2: memory",
            picture(pictures, "section42.svg", "Bytes a point of each variant and precision"),
            f"Bytes a point besides the points handed out, at {number(measured['section42'][0]['points'], 2)} points. \"Both\" is "
            'what the sampler counts; "process" is the peak of the process\' resident memory, less what it had before the call '
            "and the points that it handed out.",
            table(head, rows),
        ]
    )


def _section43(measured: Tables, pictures: str) -> str:
    rows = []
    for row in measured["section43_cells"]:
        over = percent(row["grid"] / row["bare"] - 1.0, 0 if row["grid"] > 2 * row["bare"] else 1)
        rows.append(
            [
                f"{row['method']}, {row['precision']}",
                f"{row['asked_cell']:g}",
                number(row["microseconds"]),
                f"{number(row['slowdown'])} ({span(row['slowdown_lowest'], row['slowdown_highest'])})",
                number(row["grid"]),
                over,
                number(row["workspace"]),
            ]
        )
    head = ["", "cell, r", "µs a point", "over cells of 1 r", "grid", "over bare points", "with squares"]
    growth = [
        [row["precision"], number(row["points"], 2), *(number(row[name]) for name in ("bare", "grid", "squares", "workspace", "resident"))]
        for row in measured["section43_growth"]
    ]
    grown = [f"wavefront, cells of {measured['section43_growth'][0]['cell']} r", "points", "bare points", "grid", "squares", "both", "whole process"]
    return "\n\n".join(
        [
            "## Section 4.3: wavefront sampling",
            picture(pictures, "section43.svg", "Time and memory against the width of accelerator cells, and against set size"),
            f"Accelerator cells of several widths, {number(measured['section43_cells'][0]['points'], 2)} points that stay in the "
            f"cells; bytes a point, and time over that with cells of one radius (median, lowest to highest of "
            f"{measured['section43_cells'][0]['rounds']} rounds). Widths are rounded up to whole base squares.",
            table(head, rows),
            "Bytes a point against set size; the points stay in the cells, so that the whole process holds them once:",
            table(grown, growth),
            _large(measured),
        ]
    )


def _large(measured: Tables) -> str:
    if not measured["section43_large"]:
        return "The sets that fill a machine's memory were left out of this run."
    rows = []
    for row in measured["section43_large"]:
        limit = f"{row['limit'] / 2**30:.0f} GiB"
        if row["why"]:
            single = where(measured["section43_growth"], precision="single")[-1]
            would = f"not run ({row['why']}); {number(single['resident'])} bytes a point at {number(single['points'], 2)} points would make {gib(single['resident'] * row['asked'])}"
            rows.append([f"{row['asked']:,.0f}", limit, "", "", "", would])
        else:
            cells = [gib(row["resident"]), number(row["resident"] / row["points"]), f"{row['coverage']:.5f}"]
            rows.append([f"{row['points']:,}", limit, *cells, f"{number(row['seconds'])} s, {rate(row['points'] / row['seconds'])}/s"])
    head = ["points", "limit of the address space", "peak resident", "bytes a point", "coverage", "processor time"]
    return (
        "The paper's largest sets, by wavefront sampling in single precision with cells of "
        f"{measured['section43_growth'][0]['cell']} r, each in a process whose address space is limited:\n\n" + table(head, rows)
    )


def _billion(measured: Tables) -> str:
    rows = measured["billion"]
    shown = {
        "points": lambda row: f"{row['points']:,}",
        "tiles, and their width": lambda row: f"{row['tiles']:,}, {number(row['tile_radii'])} r",
        "seconds on the clock": lambda row: number(row["seconds"], 4),
        "points a second": lambda row: rate(row["points_per_second"]),
        "threads": lambda row: row["threads"],
        "peak resident memory": lambda row: f"{row['resident_bytes'] / 1e6:.1f} MB of {row['resident_limit'] / 1e6:.0f} MB",
        "pairs compared, too close": lambda row: f"{row['pairs']:,}, {row['too_close']}",
        "least squared distance over the squared radius": lambda row: f"{row['least_squared'] / row['radius_squared']:.9f}",
        "coverage": lambda row: f"{row['coverage']:.7f} ± {row['coverage_error']:.7f}",
        "of that, known to be lost to the lattice": lambda row: f"{row['coverage_lattice_loss']:.7f}",
        "standard errors from the jammed coverage": lambda row: f"{row['coverage_z']:+.2f}",
        "tiles searched for gaps, lattice points uncovered": lambda row: f"{row['gap_tiles']:,}, {row['uncovered']}",
        "digest of the set": lambda row: f"`{row['digest']}`",
        "all promises held": lambda row: verdict(not row["broken"]) + (f": {row['broken']}" if row["broken"] else ""),
    }
    body = [[what, *(write_cell(row) for row in rows)] for what, write_cell in shown.items()]
    same = len({row["digest"] for row in rows}) == 1
    return "\n\n".join(
        [
            f"## Passed: {rows[0]['points']:,} points of one set",
            "The exact tile sampler makes them tile by tile and forgets each once it is verified: every pair of points near each "
            "other is compared, across tiles too, and tiles drawn by a hash are searched for room on the whole lattice. Two runs, "
            f"in two orders of tiles; equal digests: {verdict(same)}. `tests/bench/billion.cpp` says what each row is.",
            table(["tiles in order", *(row["order"] for row in rows)], body),
        ]
    )


def _how(measured: Tables) -> str:
    runs = measured["figure4_runs"]
    return (
        "## How\n\n"
        f"`bash tests/bench/figures.sh` builds for release, makes {sum(row['sets'] for row in runs):,} sets in {len(runs):,} "
        "processes for figure 4 alone, and leaves its tables, with every single run, in `build/figures`; `--redraw` draws them "
        "again, `--only PART` measures one part, `--quick` is a small run of everything, `--out DIR` puts it elsewhere. `tests/bench/domain_run.cpp` times one "
        "set: processor time of the call, on a cold object, page faults of its memory included; sets that take less than a "
        "moment are made several times in one process. The code that measures and draws is in `tests/bench/figures`."
    )
