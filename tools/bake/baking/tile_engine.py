"""Starts an engine that makes tiles, and sends it requests over a local connection. demo_project/addons/thicket/bake_world.gd documents
the protocol."""

from __future__ import annotations

import contextlib
import json
import secrets
import socket
import struct
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import psutil

SCRIPT = "res://addons/thicket/bake_world.gd"
# Seconds of silence after which an engine counts as stuck.
ANSWER_TIMEOUT = 900.0


@dataclass(frozen=True)
class Source:
    """The parameters of an engine: the command that runs Godot, the project's folder, the scene's res:// path, the scatter's path in it
    (empty if the scene has only one), and the seconds that the ground may take to become available."""

    godot: tuple[str, ...]
    project: str
    scene: str
    node: str = ""
    wait: float = 120.0

    def start(self) -> TileEngine:
        return TileEngine(self)


class EngineGone(RuntimeError):
    """The engine has crashed or could not be started. A new engine may work."""


class Refused(RuntimeError):
    """The engine has refused a request, with a sentence that gives the reason."""


class ProcessorTime:
    """Processor time of some processes, in seconds. It never decreases: a process that has ended keeps its last known value."""

    def __init__(self, processes: list[psutil.Process]):
        self._seconds = dict.fromkeys(processes, 0.0)

    def total(self) -> float:
        for process in self._seconds:
            with contextlib.suppress(psutil.Error):
                times = process.cpu_times()
                self._seconds[process] = times.user + times.system
        return sum(self._seconds.values())


class TileEngine:
    """A running engine with a loaded scene. Not thread-safe."""

    def __init__(self, source: Source):
        """Starts the engine and waits for its connection. Raises EngineGone with the engine's output if that fails."""
        self.log = tempfile.TemporaryFile()
        token = secrets.token_hex(16)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            arguments = [f"scene={source.scene}", f"connect={listener.getsockname()[1]}", f"token={token}", f"wait={source.wait:g}"]
            if source.node:
                arguments.append(f"node={source.node}")
            command = [*source.godot, "--headless", "--path", source.project, "--script", SCRIPT, "--", *arguments]
            try:
                # Started in the project's folder: a wrapper around Godot may make only some folders visible, among them the working
                # directory.
                self.process = subprocess.Popen(
                    command, cwd=source.project, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log
                )
            except OSError as error:
                raise EngineGone(f"{source.godot[0]} cannot be started in {source.project}: {error}. Set GODOT to the path of Godot.") from error
            self.project = source.project
            self.connection = self._accept(listener, token, time.monotonic() + source.wait + 60.0)
        self.connection.settimeout(ANSWER_TIMEOUT)
        self.family = self._family()
        self.processor_time = ProcessorTime(self.family)

    def _accept(self, listener: socket.socket, token: str, deadline: float) -> socket.socket:
        listener.settimeout(0.2)
        while time.monotonic() < deadline and self.process.poll() is None:
            try:
                self.connection, _ = listener.accept()
            except TimeoutError:
                continue
            self.connection.settimeout(10.0)
            try:
                if self._receive()[0].get("token") == token:
                    return self.connection
            except (EngineGone, ValueError):
                pass
            self.connection.close()  # A different process on this machine.
        raise EngineGone(f"The engine did not connect in time, or it crashed: check the project, {self.project}. {self._last_words()}")

    def _family(self) -> list[psutil.Process]:
        """The engine's process, and all processes between it and this one, because a wrapper may start Godot."""
        try:
            first = psutil.Process(self.process.pid)
            return [first, *first.children(recursive=True)]
        except psutil.Error:
            return []

    def _last_words(self) -> str:
        self.log.seek(0)
        lines = self.log.read().decode(errors="replace").splitlines()
        return "It printed:\n" + "\n".join(lines[-20:]) if lines else "It printed nothing."

    def _send(self, message: dict) -> None:
        text = json.dumps(message).encode()
        try:
            self.connection.sendall(struct.pack("<I", len(text)) + text)
        except OSError as error:
            raise EngineGone(f"The engine has ended ({error}). {self._last_words()}") from error

    def _take(self, count: int) -> bytearray:
        taken = bytearray(count)
        view = memoryview(taken)
        while view:
            try:
                size = self.connection.recv_into(view)
            except OSError as error:
                raise EngineGone(f"The engine does not answer ({error}). {self._last_words()}") from error
            if size == 0:
                raise EngineGone(f"The engine has ended in the middle of a tile. {self._last_words()}")
            view = view[size:]
        return taken

    def _receive(self) -> tuple[dict, bytearray]:
        (length,) = struct.unpack("<I", self._take(4))
        header = json.loads(self._take(length))
        if "error" in header:
            raise Refused(f"{header['error']} {self._last_words() if 'printed' in header['error'] else ''}".strip())
        return header, self._take(header["bytes"])

    def describe(self, asked: dict[str, str]) -> dict:
        """The scene as scene_description.gd describes it. `asked` has a `rect`, a `tile_size` and `layers` as text; missing values
        get defaults. Raises Refused for a scene that cannot be baked, and for a project with an older version of the add-on."""
        self._send({"do": "describe", **asked})
        described = self._receive()[0]
        if "columns" not in described:
            raise Refused("The project has the add-on of a different version of Thicket: copy the add-on of this checkout into the project.")
        return described

    def models(self, layers: list[int]) -> tuple[list[dict], dict[str, bytes]]:
        """For each layer, the models of its instances; and the contents of the required files, by path."""
        self._send({"do": "models", "layers": layers})
        found: list[dict] = []
        files: dict[str, bytes] = {}
        while True:
            header, payload = self._receive()
            if header.get("end"):
                return found, files
            if "file" in header:
                files[header["file"]] = bytes(payload)
            else:
                found.append(header)

    def rows(self, tile: tuple[int, int]) -> Iterator[tuple[dict, bytearray]]:
        """For each of the game's tiles in a tile of the bake, its rows, and its `layer`, `bounds` (see grid.py) and so on. The tiles belong to the
        scene that was described last. For the rows, see ScatterTile.get_rows."""
        self._send({"do": "rows", "tile": tile})
        while True:
            part, data = self._receive()
            if part.get("end"):
                return
            yield part, data

    def peak_memory(self) -> int:
        """The engine's peak memory in bytes, or 0 if the system does not provide it."""
        peak = 0
        with contextlib.suppress(OSError):
            for each in self.family:
                for line in Path(f"/proc/{each.pid}/status").read_text(encoding="utf-8").splitlines():
                    if line.startswith("VmHWM:"):
                        peak = max(peak, 1024 * int(line.split()[1]))
        return peak

    def core_seconds(self) -> float:
        """Processor time of all threads of the engine so far. After it has ended, the last known value."""
        return self.processor_time.total()

    def close(self) -> None:
        """Stops the engine. It also stops by itself when this process ends."""
        self.connection.close()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
