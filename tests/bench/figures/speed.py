"""Measures figure 4, points per second over set size, and figure 6, which counts squares and checks in the same
runs."""

from __future__ import annotations

import contextlib
import mmap
import os
import statistics
from collections.abc import Iterable

from bench.figures.contenders import OURS, Contender
from bench.figures.programs import Failed, Programs, Run, say
from bench.figures.settings import LOSS_TO, Settings
from bench.figures.tables import Row, where

# The maximum fraction of free memory that a run may need, extrapolated from the previous size.
MEMORY_SHARE = 0.8

# Bytes. Smaller runs reuse memory that previous runs have freed.
TOUCHED_FROM = 1 << 26


def memory_available() -> float:
    """Returns the bytes that a new process can allocate, or all memory if the system does not report this."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            return next(int(line.split()[1]) * 1024.0 for line in file if line.startswith("MemAvailable"))
    except OSError:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))


def touch_memory(size: float) -> None:
    """Allocates this many bytes, at most half of the free memory, writes to every page and frees them. In a virtual machine, the first access to a
    page may wait for the host, and no contender's time must include this. Later accesses only need the guest system. Huge pages are requested if
    available: a system takes them from other memory than small pages, and touched huge pages can also provide small ones."""
    size = int(min(size, 0.5 * memory_available()))
    if size >= TOUCHED_FROM:
        with mmap.mmap(-1, size) as memory:
            if hasattr(mmap, "MADV_HUGEPAGE"):
                with contextlib.suppress(OSError):  # A system may not support huge pages.
                    memory.madvise(mmap.MADV_HUGEPAGE)
            memory[:: mmap.PAGESIZE] = bytes(-(-size // mmap.PAGESIZE))


class Series:
    """The measurements of one contender with increasing sizes."""

    def __init__(self, contender: Contender, settings: Settings):
        self.contender = contender
        self.settings = settings
        self.rates: dict[int, list[float]] = {}
        self.first_rate = 0.0  # The rate of an uncounted set, for a first estimate.
        self.bytes_a_point = 0.0
        self.ended = ""  # The reason why no larger set is generated; empty while there is none.

    def seconds_expected(self, size: int) -> float:
        """Returns the expected duration of one set in seconds, extrapolated from the rates of the last two sizes."""
        medians = [statistics.median(rates) for rates in self.rates.values()]
        if not medians:
            return size / self.first_rate
        falling = min(1.0, medians[-1] / medians[-2]) if len(medians) > 1 else 1.0
        return size / (medians[-1] * falling)

    def rounds(self, size: int) -> int:
        """Returns the number of runs at this size. It is 0 once a run would take too much time or memory."""
        seconds = self.seconds_expected(size)
        if seconds > self.settings.longest_run:
            self.ended = f"a run with {size:,} points would take {seconds:.0f} s"
        elif self.bytes_a_point * size > MEMORY_SHARE * memory_available():
            self.ended = f"{size:,} points would not fit into memory"
        if self.ended:
            return 0
        fitting = int(self.settings.contender_seconds / max(seconds, 1e-9))
        min_rounds = self.settings.least_rounds if self.contender.family == OURS and size <= LOSS_TO else 1
        return min(max(fitting, min_rounds), self.settings.most_rounds)

    def sets(self, size: int) -> int:
        """Returns the number of sets in one run."""
        return max(1, min(1000, round(self.settings.shortest_run / self.seconds_expected(size))))

    def _run(self, programs: Programs, size: int, seed: int, sets: int) -> list[Run]:
        contender = self.contender
        run = programs.peer if contender.is_peer else programs.domain
        return run(contender.method, contender.precision, size, seed, *contender.flags, sets=sets)

    def begin(self, programs: Programs) -> None:
        """Generates two sets of the smallest size to estimate this contender's speed. A peer, which warms up itself,
        generates only one."""
        size = self.settings.sizes[0]
        try:
            line = self._run(programs, size, 1, 1 if self.contender.is_peer else 2)[-1]
            self.first_rate = line["points"] / max(line["seconds"], 1e-9)
        except Failed as failed:
            self.ended = str(failed)
            say(f"figure 4: {self.contender.key} is left out: {failed}")

    def take(self, programs: Programs, size: int, round_number: int) -> Row:
        """Performs one run: sets of this size, each with a different seed."""
        seed = 1 + 1000 * (round_number + self.settings.most_rounds * self.settings.sizes.index(size))
        touch_memory(1.2 * self.bytes_a_point * size)
        lines = self._run(programs, size, seed, self.sets(size))
        total = {name: sum(line.get(name, 0) for line in lines) for name in COUNTED}
        rate = total["points"] / max(total["seconds"], 1e-9)
        self.rates.setdefault(size, []).append(rate)
        self.bytes_a_point = max(line.get("resident_peak", 0) for line in lines) / size
        head = {"contender": self.contender.key, "asked": size, "round": round_number, "sets": len(lines), "rate": rate}
        return head | total | {"resident_peak": max(line.get("resident_peak", 0) for line in lines)}


COUNTED = ["points", "seconds", "darts", "squares", "selections", "list_checks", "discarded"]


def measure(programs: Programs, contenders: Iterable[Contender], settings: Settings) -> list[Row]:
    """Measures all runs and returns their rows. All contenders take turns within a round, so that disturbances affect
    them equally."""
    rows: list[Row] = []
    series = [Series(contender, settings) for contender in contenders]
    for measurement in series:
        measurement.begin(programs)
    for size in settings.sizes:
        running = [(measurement, measurement.rounds(size)) for measurement in series if not measurement.ended]
        for measurement, rounds in running:
            if rounds == 0:
                say(f"figure 4: {measurement.contender.key} ends: {measurement.ended}")
        for round_number in range(settings.most_rounds):
            for measurement, rounds in running:
                if round_number < rounds and not measurement.ended:
                    try:
                        rows.append(measurement.take(programs, size, round_number))
                    except Failed as failed:
                        measurement.ended = str(failed)
                        say(f"figure 4: {measurement.contender.key} ends: {failed}")
        say(f"figure 4: {size:,} points,", ", ".join(_summary(measurement, size) for measurement in series if size in measurement.rates))
    return rows


def _summary(series: Series, size: int) -> str:
    return f"{series.contender.key} {statistics.median(series.rates[size]) / 1e3:.3g} k/s"


def summarise(runs: list[Row]) -> list[Row]:
    """Returns figure 4's table: the median, lowest and highest rate of each contender at each size."""
    rows = []
    for key, size in dict.fromkeys((run["contender"], run["asked"]) for run in runs):
        own_runs = where(runs, contender=key, asked=size)
        rates = [run["rate"] for run in own_runs]
        sets = sum(run["sets"] for run in own_runs)
        rows.append(
            {
                "contender": key,
                "asked": size,
                "points": sum(run["points"] for run in own_runs) / sets,
                "rounds": len(own_runs),
                "sets": sets,
                "median": statistics.median(rates),
                "lowest": min(rates),
                "highest": max(rates),
            }
        )
    return rows


def losses(rates: list[Row], from_size: int, to_size: int) -> list[Row]:
    """Returns the relative loss of points per second of each contender between two sizes: the loss of the medians, and the
    minimum and maximum over all pairs of rounds."""
    rows = []
    for small in where(rates, asked=from_size):
        for large in where(rates, asked=to_size, contender=small["contender"]):
            rows.append(
                {
                    "contender": small["contender"],
                    "from": from_size,
                    "to": to_size,
                    "loss": 1.0 - large["median"] / small["median"],
                    "least": 1.0 - large["highest"] / small["lowest"],
                    "most": 1.0 - large["lowest"] / small["highest"],
                }
            )
    return rows


def counts(runs: list[Row]) -> list[Row]:
    """Returns figure 6's table: squares per accepted dart, and list checks per selection, over all sets of a size. The
    lowest and highest values are those of single rounds."""
    rows = []
    for key, size in dict.fromkeys((run["contender"], run["asked"]) for run in runs if run["selections"] > 0):
        own_runs = where(runs, contender=key, asked=size)
        row = {"contender": key, "asked": size, "sets": sum(run["sets"] for run in own_runs)}
        for name, above, below in (("squares", "squares", "points"), ("checks", "list_checks", "selections")):
            each = [run[above] / run[below] for run in own_runs]
            row[name] = sum(run[above] for run in own_runs) / sum(run[below] for run in own_runs)
            row[name + "_lowest"], row[name + "_highest"] = min(each), max(each)
        row["discarded"] = sum(run["discarded"] for run in own_runs) / sum(run["points"] for run in own_runs)
        rows.append(row)
    return rows
