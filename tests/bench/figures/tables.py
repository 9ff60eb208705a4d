"""Reads and writes tables as CSV files. A table is a list of rows, which are dictionaries with the same keys. Numbers
are read back as numbers."""

from __future__ import annotations

import csv
from pathlib import Path

Row = dict[str, object]


def write(path: Path, rows: list[Row]) -> None:
    """Replaces the file. The first row names the columns. Floats have ten significant digits."""
    assert rows, f"no rows for {path.name}"
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{cell:.10g}" if isinstance(cell, float) else cell for key, cell in row.items()})


def read(path: Path) -> list[Row]:
    """Returns the rows of a file that `write` has written, or none if the file does not exist."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [{key: _cell(text) for key, text in row.items()} for row in csv.DictReader(file)]


def _cell(text: str) -> object:
    if text in ("True", "False"):
        return text == "True"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def where(rows: list[Row], **wanted) -> list[Row]:
    """Returns the rows in which all these cells have the given values."""
    return [row for row in rows if all(row[key] == cell for key, cell in wanted.items())]
