"""Writes the page: the paper's numbers, our numbers, and their ratios. Our numbers come from the tables in the results
folder, and the paper's from paper.py."""

from __future__ import annotations

from bench.figures.page_figures import figure4, figure5, figure6
from bench.figures.page_memory import billion, section42, section43
from bench.figures.page_summary import summary
from bench.figures.page_text import Tables, prose
from bench.figures.parts import PARTS
from bench.figures.tables import Row


def write(measured: Tables, facts: dict[str, Row], pictures: str, has_sets: bool) -> str:
    """Returns the page in Markdown. `measured` has the tables that data.compact returns, and `facts` the machine of
    each part. `pictures` is the folder of the plots, relative to the page. `has_sets` is true if the plot of whole
    point sets exists."""
    parts = [
        _head(facts),
        summary(measured),
        figure4(measured, pictures),
        figure5(measured, pictures, has_sets),
        figure6(measured, pictures),
        section42(measured, pictures),
        section43(measured, pictures),
        billion(measured),
        _how(measured),
    ]
    return "\n\n".join(parts) + "\n"


def _head(facts: dict[str, Row]) -> str:
    first = facts["speed"]
    other_machines = [
        f"{PARTS[name].shows} on {entry['date']} at commit {entry['commit']}"
        for name, entry in facts.items()
        if (entry["date"], entry["commit"]) != (first["date"], first["commit"])
    ]
    exceptions = f" ({'; '.join(other_machines)})" if other_machines else ""
    parts = [
        "# The seed paper, measured again",
        prose(
            """White, Cline and Egbert, *Poisson Disk Point Sets by Hierarchical Dart Throwing* (2007), figure by
            figure: the paper's number, ours, and the ratio. `bash tests/bench/figures.sh` measures everything and
            writes this page; `--render` writes it from tests/bench/data. All of our numbers are measured. The paper's
            times are from a 2.13 GHz Core 2 Duo (figure 4), so ratios of speed include the progress of hardware.
            Ratios between methods on one machine do not."""
        ),
        prose(
            f"""Measured on {first["date"]} at commit {first["commit"]}{exceptions}: {first["processor"]}, {first["cores"]}
            cores, {first["memory_gib"]:.0f} GiB, {first["system"]}; {first["compiler"]}, `{first["flags"]}`. Times
            are processor time of one core, with one process per run: medians, followed by the lowest and highest
            round. Contenders take turns within each round."""
        ),
    ]
    committed = [PARTS[name].shows for name, entry in facts.items() if entry.get("committed")]
    if committed:
        parts.append(f"**Not measured in this run, and taken from tests/bench/data: {', '.join(committed)}.**")
    if any(entry["quick"] for entry in facts.values()):
        parts.append(
            "**This is a quick run with small sets: its numbers only show that the command works.**"
        )
    return "\n\n".join(parts)


def _how(measured: Tables) -> str:
    total = measured["figure4_total"][0]
    return "## How\n\n" + prose(
        f"""`bash tests/bench/figures.sh` builds for release, generates {total["sets"]:,} sets in
        {total["processes"]:,} processes for figure 4 alone, and writes its tables, with every single run, to
        `build/figures`. `--redraw` draws them again, `--render` draws the committed data, `--only PART` measures one
        part, `--quick` is a small run of everything, and `--out DIR` selects a different folder.
        `tests/bench/domain_run.cpp` times one set: processor time of the call, on a cold object, including the page
        faults of its memory. Very fast sets are generated several times in one process. Before every run, the memory
        that it will need is touched once and freed, because the first touch may wait for the host of a virtual
        machine. Peers start with a small set that is not counted. The code that measures and draws is in
        `tests/bench/figures`."""
    )
