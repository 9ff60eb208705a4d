"""Runs other samplers in use today (tests/bench/peers), if they are installed. Each is a contender of figure 4."""

from __future__ import annotations

from pathlib import Path

from bench.figures.contenders import TODAY, Contender
from bench.figures.programs import Failed, Run, run_lines, say

# The maximum number of sets. Each needs a separate process, which generates one set after a small warm-up set.
MOST_SETS = 2

PYTHON_PEERS = {"hdt_sampling": "hdt-sampling", "scipy_poisson_disk": "scipy PoissonDisk"}
RUST_PEERS = {
    "faster_poisson_dart": "faster_poisson, darts",
    "faster_poisson_bridson": "faster_poisson, Bridson",
    "faster_poisson_parental": "faster_poisson, parental",
}

CONTENDERS = [
    Contender(method, "double", label, TODAY, is_peer=True) for method, label in (PYTHON_PEERS | RUST_PEERS).items()
]


class Peers:
    """Runs the peers: those in Python with an interpreter that has their packages, those in Rust with their program."""

    def __init__(self, folder: Path, python: Path | None, rust_program: Path | None):
        script = folder / "run_python_peer.py"
        self._commands = dict.fromkeys(PYTHON_PEERS, [python, script]) | dict.fromkeys(RUST_PEERS, [rust_program])

    def contenders(self) -> list[Contender]:
        """Returns the peers that can run on this machine, and reports those that cannot."""
        able = []
        for contender in CONTENDERS:
            if all(path is not None and path.is_file() for path in self._commands[contender.method]):
                able.append(contender)
            else:
                say(f"peers: {contender.label} is not set up here and is left out")
        return able

    def run(self, method: str, _precision: str, points: float, seed: int, sets: int = 1) -> list[Run]:
        """Runs a peer with the arguments of Programs.domain, and at most MOST_SETS sets."""
        lines: list[Run] = []
        for set_index in range(min(sets, MOST_SETS)):
            lines += run_lines([*self._commands[method], method, f"{points:.0f}", seed + set_index])
        if not lines:
            raise Failed(f"{method} printed nothing")
        return lines
