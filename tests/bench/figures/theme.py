"""Defines the style of the plots. Every plot is drawn twice, for light and for dark pages, and saved without metadata
about the machine, date or program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402 (only after the choice above)
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from PIL import Image  # noqa: E402

# The settings of pixel images keep their files small, because noise does not compress well.
PIXELS_AN_INCH = 125
PALETTE = 48


@dataclass(frozen=True)
class Theme:
    """The colors for light or dark pages. `methods` has the colors of our methods, by name."""

    suffix: str
    page: str
    ink: str
    muted: str
    faint: str
    methods: dict[str, str]


LIGHT = Theme(
    suffix="",
    page="#ffffff",
    ink="#1f2328",
    muted="#6a737d",
    faint="#e1e5ea",
    methods={
        "naive": "#b3261e",
        "hierarchical": "#1f66d0",
        "accumulator": "#d36b00",
        "wavefront": "#0b8f6b",
        "tile": "#8f2fb5",
    },
)
DARK = Theme(
    suffix="-dark",
    page="#0d1117",
    ink="#e6edf3",
    muted="#8d96a0",
    faint="#2a3038",
    methods={
        "naive": "#ff7b72",
        "hierarchical": "#6cb0ff",
        "accumulator": "#ffa64d",
        "wavefront": "#3fcf9f",
        "tile": "#d694ff",
    },
)

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.titlelocation": "left",
    "lines.linewidth": 1.8,
    "lines.markersize": 4.0,
    "xtick.direction": "out",
    "svg.fonttype": "path",
    "svg.hashsalt": "thicket",
}


def _colors(theme: Theme) -> dict[str, object]:
    return {
        "figure.facecolor": theme.page,
        "axes.facecolor": theme.page,
        "savefig.facecolor": theme.page,
        "text.color": theme.ink,
        "axes.labelcolor": theme.ink,
        "axes.titlecolor": theme.ink,
        "axes.edgecolor": theme.muted,
        "xtick.color": theme.muted,
        "ytick.color": theme.muted,
        "xtick.labelcolor": theme.ink,
        "ytick.labelcolor": theme.ink,
        "grid.color": theme.faint,
        "grid.linewidth": 0.8,
    }


def save(draw: Callable[[Theme], Figure], folder: Path, name: str, kind: str = "svg") -> None:
    """Saves the figure that `draw` creates as NAME.KIND and NAME-dark.KIND."""
    for theme in (LIGHT, DARK):
        with matplotlib.rc_context(STYLE | _colors(theme)):
            figure = draw(theme)
            path = folder / f"{name}{theme.suffix}.{kind}"
            blank = {"Software": None} if kind == "png" else dict.fromkeys(("Creator", "Date", "Format", "Type"))
            figure.savefig(path, dpi=PIXELS_AN_INCH, bbox_inches="tight", metadata=blank)
            plt.close(figure)
        if kind == "png":
            Image.open(path).convert("RGB").quantize(PALETTE, dither=Image.Dither.NONE).save(path, optimize=True)


@dataclass
class Label:
    """A text at the end of a line. Its position is in data coordinates."""

    x: float
    y: float
    text: str
    color: str
    weight: str = "normal"


def label_ends(axes: Axes, labels: list[Label], gap: float = 7.0) -> None:
    """Draws each label to the right of its position. Labels that would overlap are moved up or down, and a thin line
    connects them with their positions."""
    figure = axes.figure
    figure.canvas.draw()
    texts = []
    for label in labels:
        pixel_position = axes.transData.transform((label.x, label.y))
        text = axes.annotate(
            label.text,
            (label.x, label.y),
            xytext=(gap, 0),
            textcoords="offset points",
            va="center",
            color=label.color,
            fontweight=label.weight,
            fontsize=9,
            annotation_clip=False,
        )
        box = text.get_window_extent()
        texts.append([pixel_position[1], box.x0, box.x1, box.height, text, label])
    texts.sort(key=lambda one: one[0])
    heights = [one[0] for one in texts]
    for _ in range(400):
        is_moved = False
        for low in range(len(texts)):
            for high in range(low + 1, len(texts)):
                a, b = texts[low], texts[high]
                overlap = (a[3] + b[3]) / 2 * 0.98 - (heights[high] - heights[low])
                if a[1] < b[2] and b[1] < a[2] and overlap > 0.1:
                    heights[low] -= overlap / 2
                    heights[high] += overlap / 2
                    is_moved = True
        if not is_moved:
            break
    points = 72.0 / figure.dpi
    for height, (natural, _, _, _, text, label) in zip(heights, texts, strict=True):
        shift = (height - natural) * points
        text.set_position((gap if abs(shift) < 2 else gap + 5, shift))
        if abs(shift) >= 2:
            axes.annotate(
                "",
                (label.x, label.y),
                xytext=(gap + 4, shift),
                textcoords="offset points",
                arrowprops={"arrowstyle": "-", "color": label.color, "linewidth": 0.7, "shrinkA": 0, "shrinkB": 2},
                annotation_clip=False,
            )
