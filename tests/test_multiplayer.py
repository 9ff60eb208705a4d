"""Several engine processes share a world over the loopback interface. They only exchange removals, and end with the same world."""

from __future__ import annotations

import json
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
from test_demo import complaints

PATIENCE = 100.0


class Process:
    """An engine process whose lines can be waited for. None of them outlives the test."""

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
        """The first line from here on that matches."""
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
        """Waits until it has ended by itself, well and without a complaint."""
        try:
            assert self._process.wait(timeout=PATIENCE) == 0, self.printed
        except subprocess.TimeoutExpired:
            pytest.fail(f"still runs after {PATIENCE} s; it printed:\n{self.printed}", pytrace=False)
        while (line := self._lines.get(timeout=PATIENCE)) is not None:
            self.printed += line
        assert not complaints(self.printed), complaints(self.printed)

    def kill(self) -> None:
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait(timeout=PATIENCE)


@contextmanager
def processes() -> Iterator[Callable[..., Process]]:
    """Starts engine processes, without a screen or with `--xvfb`, and ends those that are left."""
    started: list[Process] = []

    def start(*arguments: str | Path, screen: str = "--headless") -> Process:
        started.append(Process(list(arguments), screen))
        return started[-1]

    try:
        yield start
    finally:
        for process in started:
            process.kill()


def test_peers_exchange_removals_and_agree(imported_demo):
    """A server and two clients fell trees at the same time, some of them the same. A third client joins late. They share a seed and
    removals, and end with 10^5 bit-identical instances."""
    script = REPO / "tests/engine/multiplayer.gd"
    with processes() as start:
        server = start("--path", imported_demo, "--script", script, "--", "server")
        port = server.wait_for(r"^port (\d+)$").group(1)
        clients = [start("--path", imported_demo, "--script", script, "--", "client", port, str(n)) for n in (1, 2)]
        results = [json.loads(process.wait_for(r"^result (.*)$").group(1)) for process in (server, *clients)]
        late = start("--path", imported_demo, "--script", script, "--", "late", port)
        results.append(json.loads(late.wait_for(r"^result (.*)$").group(1)))
        for process in (*clients, late, server):
            process.end()

    removed = results[0]["removed"]
    assert removed == results[0]["to_fall"] > 200
    for key in ("before", "after", "state", "removed"):
        assert len({str(result[key]) for result in results}) == 1, (key, results)
    before, after = (int(results[0][key].split()[0]) for key in ("before", "after"))
    assert before == after + removed and after >= 100_000
    # A client only receives removals. Sending each existing instance would take 48 bytes.
    for result in results[1:]:
        assert result["received"] < 100 * removed + 5_000, results
    assert results[-1]["received"] < 16 * removed + 5_000, results


def test_the_demo_has_a_server(imported_demo, tmp_path):
    """Runs server.tscn and client.tscn as documented in their comments: a client fells trees, the next client sees this, and so
    does a restarted server."""
    scene = "res://gameplay/{}.tscn"
    state = tmp_path / "state.bin"
    with processes() as start:
        arguments = ["--path", imported_demo, scene.format("server"), "--", "--port=0", f"--state={state}"]
        server = start(*arguments)
        port = server.wait_for(r"^server: listening on port (\d+), 0 felled$").group(1)
        counts, felled = [], []
        for _ in range(2):
            client = start("--path", imported_demo, scene.format("client"), "--", f"--port={port}", "--fell=3")
            counts.append(int(client.wait_for(r"^client: (\d+) trees within").group(1)))
            felled += json.loads(client.wait_for(r"^client: felled (\[.*\])$").group(1))
            client.end()
            server.wait_for(rf"^server: \d+ has left, {len(felled)} felled$")
        assert counts[1] == counts[0] - 3 and len(set(felled)) == 6
        server.kill()
        assert not complaints(server.printed), complaints(server.printed)
        start(*arguments).wait_for(r"^server: listening on port \d+, 6 felled$")
