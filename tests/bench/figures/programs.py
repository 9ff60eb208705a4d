"""Runs the measuring programs. Each run is a separate process that prints a JSON object per line."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from bench.figures.contenders import Contender

Run = dict[str, object]


class Failed(Exception):
    """A program has failed. The message contains its command and the reason."""


def say(*words: object) -> None:
    """Prints progress, with the minutes since the command started."""
    print(f"figures {(time.monotonic() - say.start) / 60:6.1f} min:", *words, file=sys.stderr, flush=True)


say.start = time.monotonic()


def run_lines(
    command: list[object], *, limit_bytes: float | None = None, accepted: tuple[int, ...] = (0,), timeout: float = 7200
) -> list[Run]:
    """Returns the JSON lines that a command prints. `limit_bytes` limits its address space. Raises Failed for an exit
    code that is not in `accepted`."""

    def limit() -> None:
        if limit_bytes is not None:
            resource.setrlimit(resource.RLIMIT_AS, (int(limit_bytes), int(limit_bytes)))

    words = [str(word) for word in command]
    result = subprocess.run(
        words, capture_output=True, text=True, errors="replace", timeout=timeout, check=False, preexec_fn=limit
    )
    if result.returncode not in accepted:
        raise Failed(f"{' '.join(words)} ended with {result.returncode}: {result.stderr.strip()[-500:]}")
    return [json.loads(line) for line in result.stdout.splitlines() if line.startswith("{")]


@dataclass
class Programs:
    """The programs of a build, the function that runs peers (Peers.run), and the contenders."""

    folder: Path
    peer: Callable[..., list[Run]]
    contenders: list[Contender]

    def domain(self, method: str, precision: str, points: float, seed: int, *flags: str, **options) -> list[Run]:
        """Runs domain_run (tests/bench/domain_run.cpp). The option `limit_bytes` is passed to run_lines, and all others
        to domain_run."""
        limit_bytes = options.pop("limit_bytes", None)
        named = [f"{key}={value}" for key, value in options.items()]
        program = self.folder / "bench" / "domain_run"
        return run_lines([program, method, precision, f"{points:.0f}", seed, *flags, *named], limit_bytes=limit_bytes)
