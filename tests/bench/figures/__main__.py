"""Reproduces the paper's figures: measures, and writes tables, plots and the page. tests/bench/figures.sh runs it."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.figures import data, machine, page, plots, plots_sets, tables
from bench.figures.contenders import CONTENDERS, PAPER, TODAY
from bench.figures.parts import ARRAYS, PARTS, TABLES
from bench.figures.peers import CONTENDERS as PEERS
from bench.figures.peers import Peers
from bench.figures.programs import Programs, say
from bench.figures.settings import FULL, QUICK
from bench.figures.theme import save

REPO = Path(__file__).resolve().parents[3]
BENCH = REPO / "tests" / "bench"
DATA = BENCH / "data" / "figures.json"
FACTS = "machine.json"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="figures.sh", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, to check that everything works")
    parser.add_argument("--out", type=Path, default=REPO / "build" / "figures", help="the folder of the results")
    parser.add_argument(
        "--only", action="append", choices=list(PARTS), help="measure only this part; keep the others"
    )
    parser.add_argument(
        "--minutes", type=float, default=FULL.longest_large_run / 60.0, help="skip large sets that take longer"
    )
    parser.add_argument(
        "--redraw", action="store_true", help="measure nothing, draw from the tables in the folder of the results"
    )
    parser.add_argument(
        "--render", action="store_true", help="measure nothing, write page and plots from tests/bench/data"
    )
    parser.add_argument("--programs", type=Path, required=True, help="the folder of the build to measure")
    parser.add_argument(
        "--peers-python", type=Path, help="a Python with the packages of tests/bench/peers/requirements.txt"
    )
    parser.add_argument("--peers-rust", type=Path, help="the program of tests/bench/peers/faster_poisson")
    return parser.parse_args()


def read_facts(out: Path) -> dict[str, tables.Row]:
    """Returns the date and the machine of the measurement of each part."""
    path = out / FACTS
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def measure(options: argparse.Namespace, out: Path) -> None:
    """Measures the requested parts and writes their tables and the facts about the machine."""
    out.mkdir(parents=True, exist_ok=True)
    folder = options.programs.resolve()
    settings = QUICK if options.quick else replace(FULL, longest_large_run=60.0 * options.minutes)
    peers = Peers(BENCH / "peers", options.peers_python, options.peers_rust)
    programs = Programs(folder, peers.run, CONTENDERS + peers.contenders())
    for name in options.only or PARTS:
        part = PARTS[name]
        facts = read_facts(out)
        facts.pop(name, None)
        (out / FACTS).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
        for table in part.tables:
            (out / table).unlink(missing_ok=True)
        facts[name] = machine.describe(REPO, folder, options.quick)
        part.measure(programs, settings, out)
        (out / FACTS).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")


def draw(table: page.Tables, arrays: dict[str, np.ndarray], pictures: Path) -> None:
    """Draws all plots of the measured tables. The plot of whole point sets needs `arrays`."""
    pictures.mkdir(parents=True, exist_ok=True)
    rates, contenders = table["figure4"], CONTENDERS + PEERS
    save(lambda theme: plots.figure4(rates, contenders, PAPER, theme), pictures, "figure4")
    save(lambda theme: plots.figure4(rates, contenders, TODAY, theme), pictures, "figure4_today")
    if arrays:
        save(lambda theme: plots_sets.sets_and_spectra(arrays, theme), pictures, "figure5_sets", "png")
    save(lambda theme: plots_sets.radial(table["figure5_radial"], theme), pictures, "figure5_radial")
    save(lambda theme: plots.figure6(table["figure6"], CONTENDERS, theme), pictures, "figure6")
    save(lambda theme: plots.section42(table["section42"], theme), pictures, "section42")
    save(
        lambda theme: plots.section43(table["section43_cells"], table["section43_growth"], theme), pictures, "section43"
    )


def render(out: Path, table: page.Tables, facts: dict[str, tables.Row], arrays: dict[str, np.ndarray]) -> None:
    draw(table, arrays, out / "pictures")
    (out / "RESULTS.md").write_text(page.write(table, facts, "pictures", bool(arrays)), encoding="utf-8")
    say(f"done: {out / 'RESULTS.md'}")


def main() -> None:
    options = arguments()
    output = options.out.resolve()
    if options.render:
        render(output, *data.read(DATA), {})
        return
    if not options.redraw:
        measure(options, output)
    facts = read_facts(output)
    missing = [name for name in PARTS if name not in facts]
    table = data.compact({Path(name).stem: tables.read(output / name) for name in TABLES})
    arrays = dict(np.load(output / ARRAYS)) if "sets" in facts else {}
    if missing:
        say(f"not measured in {output}, and taken from tests/bench/data: {', '.join(missing)}")
        committed, committed_facts = data.read(DATA)
        own_tables = {Path(name).stem for part in facts for name in PARTS[part].tables}
        table = committed | {name: rows for name, rows in table.items() if name in own_tables or name.partition("_")[0] in own_tables}
        facts = {name: facts.get(name) or committed_facts[name] | {"committed": True} for name in PARTS}
    render(output, table, facts, arrays)
    if not missing and not any(entry["quick"] for entry in facts.values()):
        data.write(DATA, table, facts)


if __name__ == "__main__":
    main()
