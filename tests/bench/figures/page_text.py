"""Formats numbers, tables and images in Markdown."""

from __future__ import annotations

from collections.abc import Iterable

from bench.figures.tables import Row

Tables = dict[str, list[Row]]


def number(value: float, digits: int = 3) -> str:
    """Formats a number with this many significant digits and thousands separators: 1,234,000, 12.3, 0.00123."""
    if value == 0.0:
        return "0"
    rounded = float(f"{value:.{digits}g}")
    if abs(rounded) >= 10 ** (digits - 1):
        return f"{rounded:,.0f}"
    return f"{rounded:.{digits}g}" if abs(rounded) < 1e-3 else f"{rounded:#.{digits}g}".rstrip(".")


def rate(value: float) -> str:
    """Formats points per second: 778, 4.05 k, 2.58 M."""
    for scale, unit in ((1e6, " M"), (1e3, " k")):
        if value >= scale * 0.9995:
            return number(value / scale) + unit
    return number(value)


def ratio(value: float) -> str:
    return number(value) + " ×"


def percent(share: float, digits: int = 1) -> str:
    return f"{100.0 * share:.{digits}f} %"


def gib(size: float) -> str:
    return f"{size / 2**30:.2f} GiB"


def span(low: float, high: float, write=number) -> str:
    """Formats a range, or a single number if both ends look the same."""
    texts = write(low), write(high)
    return texts[0] if texts[0] == texts[1] else f"{texts[0]} to {texts[1]}"


def table(head: Iterable[str], rows: Iterable[Iterable[object]], right: bool = True) -> str:
    """Returns a Markdown table. If `right` is true, all columns except the first are right-aligned."""
    head = list(head)
    rule = ["---"] + ["---:" if right else "---"] * (len(head) - 1)
    return "\n".join(f"| {' | '.join(map(str, row))} |" for row in [head, rule, *rows])


def picture(folder: str, file: str, describes: str) -> str:
    """Returns the HTML of an image in a light and a dark version. The page displays the one that matches its color
    scheme."""
    stem, _, kind = file.rpartition(".")
    return (
        f'<picture><source media="(prefers-color-scheme: dark)" srcset="{folder}/{stem}-dark.{kind}">'
        f'<img alt="{describes}" src="{folder}/{file}"></picture>'
    )


def verdict(holds: bool) -> str:
    return "yes" if holds else "**no**"


def prose(text: str) -> str:
    """Joins the lines of a paragraph into one line."""
    return " ".join(text.split())
