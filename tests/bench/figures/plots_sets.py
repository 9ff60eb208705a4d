"""Draws the plots of figure 5: point sets and their spectra."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from bench.figures.point_sets import SHOWN_SIDE, SOURCES
from bench.figures.spectra import noise_level
from bench.figures.tables import Row, where
from bench.figures.theme import Theme

HIGHEST_SHOWN = 2.0  # The maximum power in the images.


def sets_and_spectra(arrays: dict[str, np.ndarray], theme: Theme) -> Figure:
    """Plots a point set of each method, and below it the averaged periodogram."""
    figure, panels = plt.subplots(2, len(SOURCES), figsize=(9.2, 4.95), layout="constrained")
    highest = float(arrays["highest_frequency"])
    for (above, below), source in zip(panels.T, SOURCES, strict=True):
        points = arrays[source.key + "_points"]
        above.plot(points[:, 0], points[:, 1], ".", color=theme.ink, markersize=2.6, markeredgewidth=0)
        above.set_xlim(0, SHOWN_SIDE)
        above.set_ylim(0, SHOWN_SIDE)
        above.set_aspect("equal")
        above.set_title(source.label, loc="center")
        span = (-highest, highest, -highest, highest)
        power = arrays[source.key + "_power"]
        below.imshow(
            power, origin="lower", cmap="gray", vmin=0.0, vmax=HIGHEST_SHOWN, extent=span, interpolation="antialiased"
        )
        for axes in (above, below):
            axes.set_xticks([])
            axes.set_yticks([])
            for spine in axes.spines.values():
                spine.set_visible(True)
    return figure


def radial(rows: list[Row], theme: Theme) -> Figure:
    """Plots the mean power, its difference from naive darts, and the anisotropy."""
    figure, panels = plt.subplots(
        3, 1, figsize=(9.2, 7.2), layout="constrained", sharex=True, height_ratios=[1.5, 1, 1]
    )
    mean, difference, direction = panels
    reference = where(rows, source="naive")
    for source in SOURCES:
        source_rows = where(rows, source=source.key)
        frequency = [0.5 * (row["from"] + row["to"]) for row in source_rows]
        style = {"color": theme.methods[source.key], "linewidth": 1.4, "label": source.label}
        mean.plot(frequency, [row["power"] for row in source_rows], **style)
        if source.key != "naive":
            difference.plot(frequency, [row["difference"] for row in source_rows], **style)
        direction.plot(frequency, [row["anisotropy_db"] for row in source_rows], **style)
    mean.axhline(1.0, color=theme.muted, linewidth=1.0, linestyle=":")
    mean.set_ylim(bottom=0.0)
    mean.set_title("radial mean of the power; unrelated points have 1")
    mean.legend(frameon=False, loc="lower right")
    difference.axhspan(-2.0, 2.0, color=theme.muted, alpha=0.14, linewidth=0)
    difference.axhline(0.0, color=theme.muted, linewidth=1.0)
    difference.set_ylim(-5.0, 5.0)
    difference.set_title("difference from naive darts, in its standard errors; band: two of them")
    noise = noise_level(reference[0]["sets"])
    direction.axhline(noise, color=theme.muted, linewidth=1.2)
    direction.set_ylim(noise - 5.0, noise + 5.0)
    direction.set_title(
        f"anisotropy of {reference[0]['sets']} averaged periodograms, dB; a set without directions has {noise:.1f}"
    )
    direction.set_xlabel("frequency, waves a radius")
    direction.set_xlim(0.0, reference[-1]["to"])
    for axes in panels:
        axes.grid(True, axis="y")
    return figure
