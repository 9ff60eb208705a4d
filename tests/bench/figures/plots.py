"""Draws the plots. Each function creates a figure from tables and a theme."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.figures import paper
from bench.figures.contenders import CONTENDERS, OURS, PAPER, Contender
from bench.figures.data import FIGURE6_SHOWN
from bench.figures.tables import Row, where
from bench.figures.theme import Label, Theme, label_ends

SINGLE_DASHES = (0, (4, 1.8))


def thousands(value: float) -> str:
    """Formats 1234567 as 1.23 M, and 4050 as 4.05 k."""
    for scale, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if value >= scale * 0.9995:
            return f"{value / scale:.3g}{unit}"
    return f"{value:.3g}"


def _style(contender: Contender, theme: Theme) -> dict[str, object]:
    if contender.family == OURS:
        dashes = SINGLE_DASHES if contender.precision == "single" else "-"
        width = 2.4 if contender.method == "tile" else 1.8
        return {"color": theme.methods[contender.method], "linestyle": dashes, "linewidth": width, "zorder": 3}
    return {"color": theme.muted, "linestyle": "-", "linewidth": 1.3, "zorder": 2}


def _log_sizes(axes: Axes, sizes: list[float], room: float) -> None:
    """Configures the axis of set sizes, with space for labels at its end."""
    axes.set_xscale("log")
    axes.set_xlim(min(sizes) / 1.25, max(sizes) * room)
    decades = [10.0**power for power in range(2, 10) if min(sizes) / 1.25 <= 10.0**power <= max(sizes) * 1.25]
    axes.set_xticks(decades, [thousands(size).replace(" ", "\u2009") for size in decades])
    axes.minorticks_off()
    axes.set_xlabel("points in the set")


def figure4(rates: list[Row], contenders: list[Contender], family: str, theme: Theme) -> Figure:
    """Plots points per second over set size, for our methods and those of one family."""
    figure, axes = plt.subplots(figsize=(9.2, 5.6))
    axes.set_yscale("log")
    _log_sizes(axes, [row["asked"] for row in rates], 9.0)
    axes.grid(True, which="major")
    labels = []
    for contender in contenders:
        if contender.family not in (OURS, family):
            continue
        rows = sorted(where(rates, contender=contender.key), key=lambda row: row["asked"])
        if not rows:
            continue
        sizes = [row["asked"] for row in rows]
        style = _style(contender, theme)
        axes.plot(sizes, [row["median"] for row in rows], marker="o", markersize=3, **style)
        axes.fill_between(
            sizes,
            [row["lowest"] for row in rows],
            [row["highest"] for row in rows],
            color=style["color"],
            alpha=0.15,
            linewidth=0,
        )
        ours = contender.family == OURS
        if not (ours and contender.precision == "single"):
            weight = "bold" if ours else "normal"
            labels.append(Label(sizes[-1], rows[-1]["median"], contender.label, style["color"], weight))
    axes.set_ylabel("points per second of one core")
    ticks = [10.0**power for power in range(2, 8)]
    low, high = axes.get_ylim()
    low = min(low, 0.8 * min(reported.value for reported in paper.RATES.values())) if family == PAPER else low
    axes.set_yticks([tick for tick in ticks if low <= tick <= high])
    axes.set_yticklabels([thousands(tick).replace(" ", "\u2009") for tick in axes.get_yticks()])
    axes.minorticks_off()
    axes.set_ylim(low, high)
    if family == PAPER:
        _paper_marks(axes, theme)
    label_ends(axes, labels)
    gray = "the methods in the paper" if family == PAPER else "the methods in use today"
    axes.set_title(f"colors: ours, dashed in single precision; gray: {gray}", color=theme.muted, fontsize=9)
    return figure


def _paper_marks(axes: Axes, theme: Theme) -> None:
    for key, reported in paper.RATES.items():
        axes.plot(
            paper.RATE_POINTS, reported.value, marker="D", markersize=6, color=theme.ink, fillstyle="none", zorder=4
        )
        name = next(contender.label for contender in CONTENDERS if contender.method == key)
        axes.annotate(
            f"paper, 2007: {name}",
            (paper.RATE_POINTS, reported.value),
            xytext=(8, -1),
            textcoords="offset points",
            va="center",
            fontsize=8,
            color=theme.ink,
            bbox={"facecolor": theme.page, "edgecolor": "none", "alpha": 0.75, "pad": 0.8},
            zorder=4,
        )


def figure6(counts: list[Row], contenders: list[Contender], theme: Theme) -> Figure:
    """Plots squares per accepted dart, and list checks per selection."""
    figure, panels = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
    shown = [contender for contender in contenders if contender.method in FIGURE6_SHOWN]
    titles = {"squares": "active squares per accepted dart", "checks": "list checks per selection"}
    for axes, (name, title) in zip(panels, titles.items(), strict=True):
        _log_sizes(axes, [row["asked"] for row in counts], 1.3)
        axes.grid(True, axis="y")
        axes.set_title(title)
        for contender in shown:
            rows = sorted(where(counts, contender=contender.key), key=lambda row: row["asked"])
            label = f"{contender.label}, {contender.precision}"
            axes.plot(
                [row["asked"] for row in rows],
                [row[name] for row in rows],
                marker="o",
                label=label,
                **_style(contender, theme),
            )
    squares, checks = panels
    squares.set_ylim(8.0, 11.0)
    squares.axhspan(paper.SQUARES_LEAST.value, paper.SQUARES_MOST.value, color=theme.muted, alpha=0.16, linewidth=0)
    squares.text(0.02, 9.94, "the paper: 9 to 10", transform=squares.get_yaxis_transform(), va="top", color=theme.muted)
    checks.set_ylim(0.0, 3.5)
    checks.axhline(paper.LIST_CHECKS_MOST.value, color=theme.muted, linewidth=1.2)
    checks.text(0.02, 3.05, "the paper: less than 3", transform=checks.get_yaxis_transform(), color=theme.muted)
    checks.legend(frameon=False, loc="lower right", fontsize=8.5, handlelength=3.4)
    return figure


def section42(memory: list[Row], theme: Theme) -> Figure:
    """Plots the bytes per point of each variant, by use."""
    figure, axes = plt.subplots(figsize=(9.2, 3.3), layout="constrained")
    names = [f"{row['method']}, {row['precision']}" for row in memory]
    places = np.arange(len(memory))[::-1]
    colors = [theme.methods[row["method"]] for row in memory]
    grid = np.array([row["grid"] for row in memory])
    squares = np.array([row["squares"] for row in memory])
    axes.barh(places, grid, color=colors, height=0.62)
    axes.barh(places, squares, left=grid, color=colors, alpha=0.45, height=0.62)
    widest = max(max(grid + squares), *(reported.value for reported in paper.BYTES.values()))
    for bar_y, row, total in zip(places, memory, grid + squares, strict=True):
        reported = paper.BYTES.get((row["method"], row["precision"]))
        end = total
        if reported:
            axes.plot(reported.value, bar_y, marker="D", color=theme.ink, fillstyle="none", markersize=7)
            is_near = abs(reported.value - total) < 0.08 * widest
            end = max(total, reported.value) if is_near else total
            text_x = end + 0.05 * widest if is_near else reported.value
            axes.text(text_x + 0.015 * widest, bar_y, f"paper: {reported.value:.0f}", va="center", fontsize=8.5)
        axes.text(end + 0.012 * widest, bar_y, f"{total:.0f}", va="center", fontweight="bold")
    axes.set_yticks(places, names)
    axes.set_xlim(0, widest * 1.17)
    axes.set_xlabel("bytes per point in addition to the points themselves (full color: accelerator grid; pale: active squares)")
    axes.grid(True, axis="x")
    axes.tick_params(axis="y", length=0)
    return figure


def section43(cells: list[Row], growth: list[Row], theme: Theme) -> Figure:
    """Plots time and memory over the size of accelerator cells, and memory over set size."""
    figure, (slow, small, large) = plt.subplots(1, 3, figsize=(9.2, 3.5), layout="constrained")
    for method in ("accumulator", "wavefront"):
        for precision in ("single", "double"):
            rows = sorted(where(cells, method=method, precision=precision), key=lambda row: row["cell_size"])
            style = {
                "color": theme.methods[method],
                "linestyle": "-" if precision == "double" else SINGLE_DASHES,
                "marker": "o",
                "label": f"{method}, {precision}",
            }
            sizes = [row["cell_size"] for row in rows]
            slow.plot(sizes, [row["slowdown"] for row in rows], **style)
            small.plot(sizes, [row["grid"] / row["bare"] for row in rows], **style)
    slow.set_title("time over that with cells of 1 r")
    slow.plot(
        paper.LARGE_CELL, paper.LARGE_CELL_SLOWDOWN.value, marker="D", color=theme.ink, fillstyle="none", markersize=6
    )
    slow.annotate(
        "paper",
        (paper.LARGE_CELL, paper.LARGE_CELL_SLOWDOWN.value),
        xytext=(-8, 4),
        textcoords="offset points",
        ha="right",
    )
    highest = max(paper.LARGE_CELL_SLOWDOWN.value, *(row["slowdown"] for row in cells))
    slow.set_ylim(0.0, 1.12 * highest)
    small.set_title("grid over the bare points")
    small.set_yscale("log")
    small.set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    small.set_ylim(bottom=0.9)
    for axes in (slow, small):
        axes.set_xscale("log")
        axes.set_xticks([1, 2, 5, 10, 20, 40], ["1", "2", "5", "10", "20", "40"])
        axes.set_xlabel("width of a cell, radii")
    small.legend(frameon=False, fontsize=8, loc="upper right", handlelength=3.4)
    for precision in ("single", "double"):
        rows = sorted(where(growth, precision=precision), key=lambda row: row["points"])
        sizes = [row["points"] for row in rows]
        color = theme.methods["wavefront"]
        dashes = "-" if precision == "double" else SINGLE_DASHES
        large.plot(sizes, [row["workspace"] for row in rows], marker="o", color=color, linestyle=dashes)
        large.axhline(rows[-1]["bare"], color=theme.muted, linewidth=1.0, linestyle=":")
        large.text(sizes[0], rows[-1]["bare"], f"bare points, {precision}", va="bottom", fontsize=8, color=theme.muted)
    _log_sizes(large, [row["points"] for row in growth], 1.3)
    large.set_ylim(bottom=0.0)
    large.set_title(f"wavefront, {growth[0]['cell']} r: bytes per point")
    for axes in (slow, small, large):
        axes.minorticks_off()
        axes.grid(True, axis="y")
    return figure
