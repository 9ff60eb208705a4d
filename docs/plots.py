"""Draws the plots of docs/benchmarks.md into docs/plots, from tests/bench/data/speed.json. Every bar is a ratio."""

import json
import re
import shutil
from html import escape
from pathlib import Path

REPO = Path(__file__).resolve().parents[1]
FOLDER = REPO / "docs/plots"
LABEL, BAR, ROW, TOP = 250, 380, 26, 44  # The widths of labels and bars, the height of a row, and the height of the title, in pixels.


def measured():
    """Returns the number in each row of the benchmarks, by the row's name."""
    parts = json.loads((REPO / "tests/bench/data/speed.json").read_text(encoding="utf-8"))
    return {row[0]: float(found.group(0)) for part in parts.values() for row in part["rows"] if (found := re.match(r"[\d.]+", row[1]))}


def charts(rows):
    """Returns the title and the bars of each chart, by its file name."""
    bridson = "tiles of 64 r: sampler over %s Bridson"
    on = "tiles of 64 r: sampler on "
    alone = "a worker's points over the sampler's alone, "
    levels = rows["tiles of 64 r: sampler, L = 4"] / rows["tiles of 64 r: sampler, L = 1"]
    faster = rows[bridson % "plain"]
    return {
        "bridson": ("Points per second, as multiples of plain Bridson", {
            "Bridson, plain": 1.0,
            "Bridson, tuned": faster / rows[bridson % "tuned"],
            "Thicket, 4 progressive levels": faster * levels,
            "Thicket, 1 level": faster,
        }),
        "vectors": ("Points per second, as multiples of no vector instructions", {
            name.removeprefix(on): value / rows[on + "EMU128"] for name, value in reversed(rows.items()) if name.startswith(on)
        }),
        "rules": ("Points per second of a worker, as a fraction of the sampler alone", {
            name.removeprefix(alone): value for name, value in rows.items() if name.startswith(alone)
        }),
        "cores": ("Speed on two cores, as multiples of one core", {
            name.removesuffix(": all cores over one"): value for name, value in rows.items() if name.endswith(": all cores over one")
        }),
    }  # fmt: skip


def draw(title, bars):
    """Returns a bar chart as SVG."""
    height = TOP + ROW * len(bars) + 12
    longest = max(bars.values())
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LABEL + BAR + 80} {height}" font-family="sans-serif" font-size="13">',
        f"<title>{escape(title)}</title>",
        f'<rect width="100%" height="100%" rx="8" fill="#f7faf3"/><text x="16" y="26" font-weight="bold" fill="#1f2a1c">{escape(title)}</text>',
    ]
    for number, (name, value) in enumerate(bars.items()):
        top, width = TOP + ROW * number, BAR * value / longest
        lines.append(f'<text x="{LABEL - 8}" y="{top + 15}" text-anchor="end" fill="#1f2a1c">{escape(shortened(name))}</text>')
        lines.append(f'<rect x="{LABEL}" y="{top + 2}" width="{width:.1f}" height="{ROW - 8}" rx="3" fill="#4f8040"/>')
        lines.append(f'<text x="{LABEL + width + 8:.1f}" y="{top + 15}" fill="#1f2a1c">{value:.3g}</text>')
    return "\n".join([*lines, "</svg>", ""])


def shortened(name):
    return name.replace("with an edge that thins out", "thinned edge").replace("on the ground of a noise", "on a noise").replace(", 10^6 square meters, radius 1 m", "")


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir()
    for name, (title, bars) in charts(measured()).items():
        (FOLDER / f"{name}.svg").write_text(draw(title, bars), encoding="utf-8")


if __name__ == "__main__":
    main()
