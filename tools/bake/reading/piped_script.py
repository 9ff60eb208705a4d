"""A Godot without a display that runs a script of ours, and is handed work in bulk."""

from __future__ import annotations

import json
import struct
import subprocess
import tempfile
from pathlib import Path
from types import TracebackType

from baking.command_line import REPO
from baking.format import BakeError

SCRIPTS = Path(__file__).with_name("scripts")
ANSWER = "thicket answer "
KEPT = 4000  # Characters of what the engine said before it ended.


class PipedScript:
    """Runs `script`, of those in SCRIPTS, in `project` until the block ends. One job after the other: a dictionary, and bytes that belong to it. The script reads both with
    job_reader.gd, and prints an answer for each, a dictionary."""

    def __init__(self, project: Path, script: str, godot: Path = REPO / "tools/godot"):
        self._said = tempfile.TemporaryFile()
        command = [str(godot), "--headless", "--path", str(project), "--script", str(SCRIPTS / script)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._said)

    def __enter__(self) -> PipedScript:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        try:
            self._process.stdin.close()  # Which tells the script that there is no more.
            self._process.wait(60 if kind is None else 1)
        except (OSError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
        self._said.close()

    def ask(self, job: dict, payload: bytes | memoryview = b"") -> dict:
        """Hands over a job and waits for its answer. Raises BakeError with what the script says against it, and where the engine ends before."""
        text = json.dumps({**job, "bytes": len(payload)}).encode()
        try:
            self._process.stdin.write(struct.pack("<I", len(text)) + text)
            self._process.stdin.write(payload)
            self._process.stdin.flush()
        except BrokenPipeError:
            raise self._ended() from None
        for line in self._process.stdout:
            if line.startswith(ANSWER.encode()):
                answer = json.loads(line[len(ANSWER) :])
                if problem := answer.get("problem"):
                    raise BakeError(problem)
                return answer
        raise self._ended()

    def _ended(self) -> BakeError:
        self._process.wait()
        return BakeError(f"Godot ended with status {self._process.returncode} before its work was done; it had printed:\n{self.printed()}")

    def printed(self) -> str:
        """The end of the engine's errors so far."""
        self._said.seek(0)
        return self._said.read().decode(errors="replace")[-KEPT:]
