"""Runs one of our scripts in a headless Godot and sends it jobs."""

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
MAX_QUOTED = 4000  # The maximum length of the quoted engine output, in characters.


class PipedScript:
    """Runs `script`, from the folder SCRIPTS, in `project` until the end of the block. The script handles one job at a
    time. A job is a dictionary and optional bytes. The script reads both with job_reader.gd and prints a dictionary as
    the answer."""

    def __init__(self, project: Path, script: str, godot: Path = REPO / "tools/godot"):
        self._error_output = tempfile.TemporaryFile()
        command = [str(godot), "--headless", "--path", str(project), "--script", str(SCRIPTS / script)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._error_output)

    def __enter__(self) -> PipedScript:
        return self

    def __exit__(self, error_type: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        try:
            self._process.stdin.close()  # Signals the end of the jobs to the script.
            self._process.wait(60 if error_type is None else 1)
        except (OSError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
        self._error_output.close()

    def ask(self, job: dict, payload: bytes | memoryview = b"") -> dict:
        """Sends a job and returns its answer. Raises BakeError if the script reports an error, or if the engine ends
        before it answers."""
        text = json.dumps({**job, "bytes": len(payload)}).encode()
        try:
            self._process.stdin.write(struct.pack("<I", len(text)) + text)
            self._process.stdin.write(payload)
            self._process.stdin.flush()
        except BrokenPipeError:
            raise self._end_error() from None
        for line in self._process.stdout:
            if line.startswith(ANSWER.encode()):
                answer = json.loads(line[len(ANSWER) :])
                if problem := answer.get("problem"):
                    raise BakeError(problem)
                return answer
        raise self._end_error()

    def _end_error(self) -> BakeError:
        self._process.wait()
        return BakeError(f"Godot ended with status {self._process.returncode} before its work was done. Its output:\n{self.printed()}")

    def printed(self) -> str:
        """Returns the end of the engine's error output so far."""
        self._error_output.seek(0)
        return self._error_output.read().decode(errors="replace")[-MAX_QUOTED:]
