"""The data of the page and its plots: a few numbers of each table, in one file that is small enough to be committed.
A full measurement replaces tests/bench/data/figures.json. The page and plots can be rendered from it at any time."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from bench.figures.contenders import CONTENDERS
from bench.figures.page_text import Tables
from bench.figures.tables import Row, where

DIGITS = 8  # Significant digits, more than the page and plots need.

FIGURE6_SHOWN = ("hierarchical", "wavefront")


def compact(measured: Tables) -> Tables:
    """Returns the tables of the page, computed from the tables that the parts write. Tables of parts that were not measured are left out."""
    tables = {}

    def add(name: str, source: str, convert: Callable[[list[Row]], list[Row]] = lambda rows: rows) -> None:
        if measured.get(source) or source == "section43_large":
            tables[name] = convert(measured.get(source, []))

    for name in ("figure5_spectra", "figure5_coverage", "section42", "losses", "section43_cells"):
        add(name, name)
    add("figure4", "figure4", lambda rows: _columns(rows, "contender asked median lowest highest"))
    add("figure4_rounds", "figure4", _rounds)
    add("figure4_total", "figure4_runs", lambda rows: [{"sets": sum(row["sets"] for row in rows), "processes": len(rows)}])
    keys = [contender.key for contender in CONTENDERS if contender.method in FIGURE6_SHOWN]
    add("figure6", "figure6", lambda rows: _columns([row for row in rows if row["contender"] in keys], "contender asked squares checks"))
    add("figure6_ranges", "figure6", _ranges)
    add("figure5_radial", "figure5_radial", _differences)
    add("section43_growth", "section43_growth", lambda rows: _columns(rows, "precision cell points bare grid squares workspace resident"))
    add("section43_large", "section43_large", lambda rows: _columns(rows, "asked points limit cell resident coverage discarded seconds why"))
    add("billion", "billion", lambda rows: [_billion_row(row) for row in rows])
    return tables


def _columns(rows: list[Row], names: str) -> list[Row]:
    return [{name: row[name] for name in names.split()} for row in rows]


def _rounds(rates: list[Row]) -> list[Row]:
    """Returns the minimum and maximum number of rounds over all sizes, for each contender."""
    rows = []
    for key in dict.fromkeys(row["contender"] for row in rates):
        rounds = [row["rounds"] for row in where(rates, contender=key)]
        rows.append({"contender": key, "least": min(rounds), "most": max(rounds)})
    return rows


def _ranges(counts: list[Row]) -> list[Row]:
    """Returns the lowest and highest counts over all sizes, for each contender."""
    rows = []
    for key in dict.fromkeys(row["contender"] for row in counts):
        own_rows = where(counts, contender=key)
        row = {"contender": key}
        for name in ("asked", "squares", "checks"):
            values = [run[name] for run in own_rows]
            row |= {f"{name}_least": min(values), f"{name}_most": max(values)}
        rows.append(row | {"discarded": max(run["discarded"] for run in own_rows)})
    return rows


def _differences(radial: list[Row]) -> list[Row]:
    """Returns the power of each ring and its difference from naive darts in standard errors."""
    expected = {row["from"]: row for row in where(radial, source="naive")}
    rows = _columns(radial, "source sets side from to power anisotropy_db")
    for row, radial_row in zip(rows, radial, strict=True):
        naive = expected[radial_row["from"]]
        error = float(np.hypot(radial_row["error"], naive["error"]))
        row["difference"] = 0.0 if radial_row is naive else (radial_row["power"] - naive["power"]) / error
    return rows


def _billion_row(row: Row) -> Row:
    left_out = ("radius_squared", "least_squared")
    kept_cells = {name: cell for name, cell in row.items() if name not in left_out}
    return kept_cells | {"least_over_radius": row["least_squared"] / row["radius_squared"]}


def write(path: Path, tables: Tables, facts: dict[str, Row]) -> None:
    """Replaces the file. Each table lists its columns once, and has one line per row, so that diffs are readable."""
    parts = []
    for name, rows in sorted(tables.items()):
        columns = list(rows[0]) if rows else []
        lines = ",\n".join("   " + json.dumps([_short(row[column]) for column in columns]) for row in rows)
        parts.append(f'  "{name}": {{"columns": {json.dumps(columns)}, "rows": [\n{lines}\n  ]}}')
    machine = ",\n".join(f"  {json.dumps(name)}: {json.dumps(entry)}" for name, entry in facts.items())
    text = '{\n "facts": {\n' + machine + '\n },\n "tables": {\n' + ",\n".join(parts) + "\n }\n}\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def _short(cell: object) -> object:
    return float(f"{cell:.{DIGITS}g}") if isinstance(cell, float) and abs(cell) < 10**DIGITS else cell


def read(path: Path) -> tuple[Tables, dict[str, Row]]:
    """Returns the tables and facts that `write` has written."""
    content = json.loads(path.read_text(encoding="utf-8"))
    tables = {
        name: [dict(zip(table["columns"], row, strict=True)) for row in table["rows"]]
        for name, table in content["tables"].items()
    }
    return tables, content["facts"]
