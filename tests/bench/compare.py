"""Reports the rows of the benchmarks that differ between two commits by more than the machine's noise.

    bash tests/bench/compare.sh BASE [NEW] [--turns 9] [--programs bench_sampler,bench_tile] [--engine gameplay,spikes]

BASE and NEW are commits. NEW defaults to the working tree. Both are built for release in separate folders in
build/compare, then run alternately, so that a slow minute of the machine affects both. Exits with 1 if a row became
worse.
"""

import argparse
import math
import re
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
PROGRAMS = ("bench_sampler", "bench_tile", "bench_fields", "bench_shapes")

# The significance level: if chance alone decides which commit is faster in a turn, a row is reported as changed with at most
# this probability.
CHANCE = 0.01
# Smaller changes are ignored, because even a different memory layout of the code can cause them.
LEAST = 0.02

ROW = re.compile(r"\| (?P<what>.+?) \| (?P<number>-?[0-9][0-9,]*(?:\.[0-9]+)?)(?P<unit>[^|]*) \| [^|]* \| [0-9]+ \|")


def read_rows(printed: str) -> dict[str, tuple[float, str]]:
    """Returns the median and its unit ("" for none) of each row of a benchmark, keyed by the row's name. Other lines are
    ignored."""
    rows = (ROW.fullmatch(line.strip()) for line in printed.splitlines())
    return {row["what"]: (float(row["number"].replace(",", "")), row["unit"].strip()) for row in rows if row}


def more_is_better(unit: str) -> bool:
    """Returns True for rates and speedups, and False for times and sizes, for which less is better."""
    return bool(re.search(r"/s\b|\bper (?:second|ms)\b", unit)) or unit == "times"


def outliers(turns: int) -> int:
    """Returns the number of turns that may contradict the rest, or -1 if there are too few turns to decide anything."""
    return max(k for k in range(-1, turns // 2) if 2 * sum(math.comb(turns, i) for i in range(k + 1)) / 2**turns <= CHANCE)


@dataclass(frozen=True)
class Change:
    what: str
    unit: str
    base: float  # Medians of all turns.
    new: float
    ratio: float  # The median of the ratios new / base of each turn.
    moved: bool

    @property
    def worse(self) -> bool:
        return self.moved and (self.ratio < 1.0) == more_is_better(self.unit)

    @property
    def verdict(self) -> str:
        return ("worse" if self.worse else "better") if self.moved else ""


def compare(what: str, unit: str, base: list[float], new: list[float]) -> Change:
    """Compares a row. Both lists contain the medians of all turns, in the same order."""
    ratios = sorted(b / a if a > 0 and b > 0 else 1.0 for a, b in zip(base, new, strict=True))
    ratio = statistics.median(ratios)
    against = sum(each >= 1.0 for each in ratios) if ratio < 1.0 else sum(each <= 1.0 for each in ratios)
    is_significant = against <= outliers(len(ratios)) and abs(math.log(ratio)) >= math.log1p(LEAST)
    return Change(what, unit, statistics.median(base), statistics.median(new), ratio, is_significant)


def compare_all(turns: list[tuple[dict, dict]]) -> tuple[list[Change], list[str]]:
    """Returns the changes of all rows that both commits print in every turn, and the names of the other rows."""
    names = dict.fromkeys(label for pair in turns for side in pair for label in side)
    shared = [label for label in names if all(label in side for pair in turns for side in pair)]
    changes = []
    for label in shared:
        base, new = ([pair[side][label][0] for pair in turns] for side in (0, 1))
        changes.append(compare(label, turns[0][1][label][1], base, new))
    return changes, [label for label in names if label not in shared]


def report(changes: list[Change], others: list[str], turns: int) -> str:
    lines = ["| measurement | base | new | new / base | |", "|---|---|---|---|---|"]
    for change in changes:
        unit = f" {change.unit}" if change.unit else ""
        lines.append(f"| {change.what} | {change.base:g}{unit} | {change.new:g}{unit} | {change.ratio:.3f} | {change.verdict} |")
    moved_changes = [change for change in changes if change.moved]
    lines += ["", f"{turns} turns; {len(moved_changes)} of {len(changes)} rows moved, {sum(change.worse for change in moved_changes)} for the worse."]
    if outliers(turns) < 0:
        lines.append("These are too few turns to distinguish changes from noise: at least 8 are needed.")
    if others:
        lines.append("Only in one of the two: " + "; ".join(others) + ".")
    return "\n".join(lines)


class Side:
    """A commit and its built benchmarks."""

    def __init__(self, commit: str | None, engine: bool):
        self.folder = self.check_out(commit) if commit else REPO
        self.run("scons", "-Q", "target=template_release", "bench")
        if engine:
            self.run("scons", "-Q", "extension")
            self.run("bash", "-c", "source tools/setup.sh; import_demo")

    def check_out(self, commit: str) -> Path:
        name = subprocess.run(["git", "rev-parse", "--short", f"{commit}^{{commit}}"], cwd=REPO, check=True, capture_output=True, text=True)
        folder = REPO / "build" / "compare" / name.stdout.strip()
        if not folder.exists():
            subprocess.run(["git", "clone", "--quiet", "--no-checkout", str(REPO), str(folder)], check=True)
        subprocess.run(["git", "checkout", "--quiet", "--detach", name.stdout.strip()], cwd=folder, check=True)
        return folder

    def run(self, *command: str) -> str:
        result = subprocess.run(command, cwd=self.folder, check=False, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
        if result.returncode != 0:
            sys.exit(f"compare: {' '.join(command)} in {self.folder} ended with {result.returncode}:\n{result.stdout[-2000:]}")
        return result.stdout

    def measure(self, programs: list[str], scripts: list[str]) -> dict[str, tuple[float, str]]:
        rows = {}
        for program in programs:
            program_files = sorted(self.folder.glob(f"build/*.template_release.*/bench/{program}"))
            if program_files:
                rows |= {f"{program}: {label}": row for label, row in read_rows(self.run(str(program_files[0]), "1", "0.25")).items()}
        for script in scripts:
            path = self.folder / "tests" / "bench" / f"{script}.gd"
            printed = self.run("tools/godot", "--headless", "--path", "demo_project", "--script", str(path)) if path.exists() else ""
            rows |= {f"{script}: {label}": row for label, row in read_rows(printed).items()}
        return rows


def named(text: str) -> list[str]:
    return [name for name in text.split(",") if name]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base")
    parser.add_argument("new", nargs="?")
    parser.add_argument("--turns", type=int, default=9)
    parser.add_argument("--programs", type=named, default=list(PROGRAMS))
    parser.add_argument("--engine", type=named, default=[])
    arguments = parser.parse_args()
    if arguments.turns < 1:
        parser.error(f"--turns must be at least 1, got {arguments.turns}")
    sides = [Side(arguments.base, bool(arguments.engine)), Side(arguments.new, bool(arguments.engine))]
    turns = []
    for turn in range(arguments.turns):
        print(f"compare: turn {turn + 1} of {arguments.turns}", file=sys.stderr)
        order = (0, 1) if turn % 2 == 0 else (1, 0)
        measured = {side: sides[side].measure(arguments.programs, arguments.engine) for side in order}
        turns.append((measured[0], measured[1]))
    changes, others = compare_all(turns)
    print(report(changes, others, arguments.turns))
    return 1 if any(change.worse for change in changes) else 0


if __name__ == "__main__":
    sys.exit(main())
