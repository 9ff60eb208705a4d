"""Stores the rows that tests/bench/run.sh has measured in tests/bench/data/speed.json, and writes the speed tables in
docs/benchmarks.md from them.

    python3 tests/bench/speed_table.py --machine TEXT ROWS   stores the rows of ROWS, a folder with a file for each measured part,
                                                             with the machine and today's date; then writes the tables
    python3 tests/bench/speed_table.py                       writes the tables from the stored rows

The rows of parts that were not measured are kept. SECTIONS lists the rows that the page shows.
"""

import argparse
import datetime
import fnmatch
import json
import re
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
KEPT = REPO / "tests/bench/data/speed.json"
PAGE = REPO / "docs/benchmarks.md"

BEGIN = "<!-- The tables from here on are written by tests/bench/run.sh with the option write. -->"
END = "<!-- The tables end here. -->"
HEAD = "| Measurement | Median | Lowest to highest round | Rounds |\n|---|---|---|---|"

# The headings in docs/benchmarks.md, and shell patterns for the names of the rows below each. Stars match the numbers of a run.
SECTIONS = {
    "The sampler, on one core": [
        "tiles of 64 r: sampler, L = *",
        "tiles of 64 r: sampler over * Bridson",
        "tiles of 64 r: points computed per point kept, L = 1",
        "tiles of 64 r: workspace per cell, L = 1",
        "tiles of 64 r: sampler on *",
        "tiles of 16 r: sampler, L = 1",
        "tiles of 32 r: sampler, L = 1",
        "tiles of 128 r: sampler, L = 1",
        "tiles of * r in rows, L = 1: blocks kept",
        "tiles of * r: p99.9 *",
    ],
    "From a request to buffers that are ready to upload": [
        "forest, L = 1: whole tile over sampler alone",
        "meadow, L = 1: whole tile over sampler alone",
        "meadow with edge_feather: whole tile*",
        "a worker's points, on *",
        "a worker's points over the sampler's alone, on *",
        "PoissonSampler.sample*",
        "sample_domain*",
        "build_rect*",
    ],
    "Starting": ["as shipped: *", "from the engine's start*"],
    "The main thread": [
        "a wide view: *",
        "a wide view, flight *",
        "*: the longest frame",
        "a diff of 10^6 changes*: the call",
        "a diff of 10^6 changes, apply_diff_async: all of *",
        "flight at *, headless: main thread per frame, *",
        "*: * tiles within * m regenerated",
        "*: all tiles regenerated",
        "*: main thread per frame, longest",
    ],
    "Drawing": ["view *, tiles in cells: triangles in sight", "view *, tiles in cells: draw calls in sight"],
    "Playing": [
        "query_*",
        "get_instance by id*",
        "remove_*",
        "state, *: bytes per removal",
        "collision * created *",
        "navigation: parsing *",
        "navigation: time that the trees add to the bake",
        "navigation: time * trees* as bodies *",
    ],
}


def read(rows: Path) -> dict[str, list[list[str]]]:
    """Returns the cells of all rows in a folder, keyed by part."""
    parts = {}
    for path in sorted(rows.iterdir()):
        lines = path.read_text(encoding="utf-8").splitlines()
        parts[path.name] = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
        if not parts[path.name] or any(len(row) != 4 for row in parts[path.name]):
            raise SystemExit(f"speed_table: {path} must contain rows of four cells, got {lines[:3]}")
    return parts


def keep(kept: dict, parts: dict[str, list[list[str]]], machine: str, date: str) -> dict:
    """Returns the stored rows, with the rows of the newly measured parts replaced."""
    return kept | {part: {"machine": machine, "date": date, "rows": rows} for part, rows in parts.items()}


def tables(kept: dict, sections: dict[str, list[str]]) -> str:
    """Returns the tables in Markdown. A pattern without a matching row is an error, because the page would lack that
    row."""
    rows = [row for part in kept.values() for row in part["rows"]]
    written = [measured(kept)]
    for heading, patterns in sections.items():
        lines = []
        for pattern in patterns:
            fitting = [row for row in rows if fnmatch.fnmatchcase(row[0], pattern)]
            if not fitting:
                raise SystemExit(f"speed_table: no row is called {pattern}; measure its part again, or change SECTIONS")
            lines += ["| " + " | ".join(row) + " |" for row in fitting]
        written.append("\n".join([f"### {heading}\n", HEAD, *lines]))
    return "\n\n".join(written)


def measured(kept: dict) -> str:
    machines = dict.fromkeys(part["machine"] for part in kept.values())
    dates = sorted(part["date"] for part in kept.values())
    dates_text = f"on {dates[0]}" if dates[0] == dates[-1] else f"from {dates[0]} to {dates[-1]}"
    return f"Measured {dates_text}: {'; '.join(machines)}."


def put(page: str, text: str) -> str:
    """Returns the page's text with new tables between the marks."""
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        raise SystemExit(f"speed_table: {PAGE.name} must contain these two lines once each:\n{BEGIN}\n{END}")
    return re.sub(f"(?<={re.escape(BEGIN)}\n).*(?={re.escape(END)})", lambda _: f"\n{text}\n\n", page, flags=re.DOTALL)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--machine", help="the machine that measured the rows")
    parser.add_argument("rows", nargs="?", type=Path)
    arguments = parser.parse_args()
    kept_parts = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    if arguments.rows:
        if not arguments.machine:
            parser.error("--machine must describe the machine on which the rows were measured")
        kept_parts = keep(kept_parts, read(arguments.rows), arguments.machine, datetime.date.today().isoformat())
        KEPT.write_text(json.dumps(kept_parts, indent="\t", ensure_ascii=False) + "\n", encoding="utf-8")
    PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), tables(kept_parts, SECTIONS)), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
