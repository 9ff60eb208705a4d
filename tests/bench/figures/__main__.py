"""Measures the seed paper's figures again and writes tables, plots and the page; tests/bench/figures.sh calls it."""

from __future__ import annotations

import argparse
import json
import shutil
from pathlib import Path

import numpy as np

from bench.figures import billion, machine, memory, page, plots, plots_sets, point_sets, speed, tables
from bench.figures.contenders import CONTENDERS, PAPER, TODAY
from bench.figures.peers import CONTENDERS as PEERS
from bench.figures.peers import Peers
from bench.figures.programs import Programs, say
from bench.figures.settings import FULL, LOSS_FROM, LOSS_TO, QUICK, Settings
from bench.figures.theme import save

REPO = Path(__file__).resolve().parents[3]
BENCH = REPO / "tests" / "bench"
TABLES = [
    "figure4_runs.csv",
    "figure4.csv",
    "losses.csv",
    "figure5_radial.csv",
    "figure5_coverage.csv",
    "figure6.csv",
    "section42.csv",
    "section43_cells.csv",
    "section43_growth.csv",
    "section43_large.csv",
    "billion.csv",
]
ARRAYS = "figure5_pictures.npz"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="figures.sh", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, to see that everything works")
    parser.add_argument("--out", type=Path, default=REPO / "build" / "figures", help="the folder of the results")
    parser.add_argument("--programs", type=Path, required=True, help="the folder of the build to measure")
    parser.add_argument("--peers-python", type=Path, help="a Python with the packages of tests/bench/peers/requirements.txt")
    parser.add_argument("--peers-rust", type=Path, help="the program of tests/bench/peers/faster_poisson")
    parser.add_argument("--redraw", action="store_true", help="measure nothing, draw what the folder of the results holds")
    return parser.parse_args()


def measure(programs: Programs, settings: Settings, contenders: list, out: Path) -> None:
    """Writes all tables into `out`, each as soon as it is measured."""
    runs = speed.measure(programs, contenders, settings)
    rates = speed.summarise(runs)
    tables.write(out / "figure4_runs.csv", runs)
    tables.write(out / "figure4.csv", rates)
    tables.write(out / "figure6.csv", speed.counts(runs))
    from_size, to_size = (LOSS_FROM, LOSS_TO) if LOSS_TO in settings.sizes else (settings.sizes[0], settings.sizes[-1])
    tables.write(out / "losses.csv", speed.losses(rates, from_size, to_size))
    spectra, arrays = point_sets.measure_spectra(programs, settings)
    tables.write(out / "figure5_radial.csv", spectra)
    np.savez_compressed(out / ARRAYS, **arrays)
    tables.write(out / "figure5_coverage.csv", point_sets.measure_coverage(programs, settings))
    tables.write(out / "section42.csv", memory.measure_variants(programs, settings))
    tables.write(out / "section43_cells.csv", memory.measure_cells(programs, settings))
    tables.write(out / "section43_growth.csv", memory.measure_growth(programs, settings))
    if settings.large_sets:
        tables.write(out / "section43_large.csv", memory.measure_large(programs, settings))
    tables.write(out / "billion.csv", billion.measure(programs, settings))


def draw(table: dict[str, list[tables.Row]], arrays: dict[str, np.ndarray], pictures: Path) -> None:
    """All plots, from what was measured."""
    pictures.mkdir(parents=True, exist_ok=True)
    rates, contenders = table["figure4"], CONTENDERS + PEERS
    save(lambda theme: plots.figure4(rates, contenders, PAPER, theme), pictures, "figure4")
    save(lambda theme: plots.figure4(rates, contenders, TODAY, theme), pictures, "figure4_today")
    save(lambda theme: plots_sets.sets_and_spectra(arrays, theme), pictures, "figure5_sets", "png")
    save(lambda theme: plots_sets.radial(table["figure5_radial"], theme), pictures, "figure5_radial")
    save(lambda theme: plots.figure6(table["figure6"], CONTENDERS, theme), pictures, "figure6")
    save(lambda theme: plots.section42(table["section42"], theme), pictures, "section42")
    save(lambda theme: plots.section43(table["section43_cells"], table["section43_growth"], theme), pictures, "section43")


def main() -> None:
    given = arguments()
    settings = QUICK if given.quick else FULL
    out = given.out.resolve()
    facts_file = out / "machine.json"
    if not given.redraw:
        out.mkdir(parents=True, exist_ok=True)
        for name in TABLES:  # Not the folder: who knows what else lies in it.
            (out / name).unlink(missing_ok=True)
        peers = Peers(BENCH / "peers", given.peers_python, given.peers_rust)
        facts = machine.describe(REPO, given.programs.resolve(), given.quick)
        facts_file.write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
        programs = Programs(given.programs.resolve(), peers.run)
        measure(programs, settings, CONTENDERS + peers.contenders(), out)
    facts = json.loads(facts_file.read_text(encoding="utf-8"))
    measured = {Path(name).stem: tables.read(out / name) for name in TABLES}
    pictures = out / "pictures"
    draw(measured, dict(np.load(out / ARRAYS)), pictures)
    (out / "RESULTS.md").write_text(page.write(measured, facts, "pictures"), encoding="utf-8")
    if not facts["quick"]:
        shutil.copytree(pictures, BENCH / "figures" / "pictures", dirs_exist_ok=True)
        (BENCH / "RESULTS.md").write_text(page.write(measured, facts, "figures/pictures"), encoding="utf-8")
    say(f"done: {out / 'RESULTS.md'}")


if __name__ == "__main__":
    main()
