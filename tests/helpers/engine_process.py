"""Starts engine processes that run in parallel with a test."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, Queue
from threading import Thread

import pytest
from conftest import REPO
from helpers.engine_output import complaints

PATIENCE = 100.0


class Process:
    """An engine process, with methods that wait for lines of its output."""

    def __init__(self, arguments: list[str | Path], screen: str) -> None:
        command = [str(part) for part in (REPO / "tools/godot", screen, *arguments)]
        self.printed = ""
        self._lines: Queue[str | None] = Queue()
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
        Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for line in self._process.stdout:
            self._lines.put(line)
        self._lines.put(None)

    def wait_for(self, pattern: str) -> re.Match[str]:
        """Waits for another line that matches `pattern` and returns the match. Fails the test if the process ends or prints
        nothing for PATIENCE seconds."""
        while True:
            try:
                line = self._lines.get(timeout=PATIENCE)
            except Empty:
                pytest.fail(f"no line like {pattern!r} within {PATIENCE} s; it printed:\n{self.printed}", pytrace=False)
            if line is None:
                pytest.fail(f"ended without a line like {pattern!r}; it printed:\n{self.printed}", pytrace=False)
            self.printed += line
            if found := re.search(pattern, line):
                return found

    def end(self) -> None:
        """Waits until the process has exited. Fails the test if the exit code or the output reports an error."""
        try:
            assert self._process.wait(timeout=PATIENCE) == 0, self.printed
        except subprocess.TimeoutExpired:
            pytest.fail(f"still running after {PATIENCE} s; it printed:\n{self.printed}", pytrace=False)
        while (line := self._lines.get(timeout=PATIENCE)) is not None:
            self.printed += line
        assert not complaints(self.printed), complaints(self.printed)

    def kill(self) -> None:
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait(timeout=PATIENCE)


@contextmanager
def processes() -> Iterator[Callable[..., Process]]:
    """Provides a function that starts engine processes, headless or with `--xvfb`. Kills those that are still running
    at the end."""
    started: list[Process] = []

    def start(*arguments: str | Path, screen: str = "--headless") -> Process:
        started.append(Process(list(arguments), screen))
        return started[-1]

    try:
        yield start
    finally:
        for process in started:
            process.kill()
