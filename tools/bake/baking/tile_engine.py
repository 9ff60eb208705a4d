"""Starts an engine that generates tiles and sends it requests over a local connection.
demo_project/addons/thicket/baking/world_baking.gd documents the protocol."""

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
# The time without an answer after which an engine is considered stuck, in seconds.
ANSWER_TIMEOUT = 900.0


@dataclass(frozen=True)
class Source:
    """The parameters of an engine. `godot` is the command that runs Godot, `project` is a folder, and `scene` is a
    res:// path. `node` is the path of the TerrainScatter3D in the scene, or empty if there is only one. `wait` is the
    maximum time in seconds until the ground is available."""

    godot: tuple[str, ...]
    project: str
    scene: str
    node: str = ""
    wait: float = 120.0

    def start(self) -> TileEngine:
        return TileEngine(self)


class EngineGone(RuntimeError):
    """Raised if the engine has ended, does not answer or could not be started. A new engine may work."""


class Rejected(RuntimeError):
    """Raised if the engine has rejected a request. The message contains the reason."""


class ProcessorTime:
    """Sums the CPU time of several processes, in seconds. The sum never decreases, because a process that has ended
    keeps its last known value."""

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
        """Starts the engine and waits until it connects. Raises EngineGone with the engine's output if that fails."""
        self.log = tempfile.TemporaryFile()
        token = secrets.token_hex(16)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            arguments = [f"scene={source.scene}", f"connect={listener.getsockname()[1]}", f"token={token}", f"wait={source.wait:g}"]
            if source.node:
                arguments.append(f"node={source.node}")
            command = [*source.godot, "--headless", "--path", source.project, "--script", SCRIPT, "--", *arguments]
            try:
                # Start in the project's folder, because a wrapper around Godot may make only a few folders visible,
                # including the working directory.
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
            self.connection.close()  # The connection was made by another process on this machine.
        raise EngineGone(f"The engine did not connect in time, or it crashed: check the project, {self.project}. {self._output_text()}")

    def _family(self) -> list[psutil.Process]:
        """Returns the process that this object has started and all of its descendants. The engine may be one of
        these, because a wrapper may start Godot."""
        try:
            first = psutil.Process(self.process.pid)
            return [first, *first.children(recursive=True)]
        except psutil.Error:
            return []

    def _output_text(self) -> str:
        self.log.seek(0)
        lines = self.log.read().decode(errors="replace").splitlines()
        return "It printed:\n" + "\n".join(lines[-20:]) if lines else "It printed nothing."

    def _send(self, message: dict) -> None:
        text = json.dumps(message).encode()
        try:
            self.connection.sendall(struct.pack("<I", len(text)) + text)
        except OSError as error:
            raise EngineGone(f"The engine has ended ({error}). {self._output_text()}") from error

    def _receive_bytes(self, count: int) -> bytearray:
        data = bytearray(count)
        view = memoryview(data)
        while view:
            try:
                size = self.connection.recv_into(view)
            except OSError as error:
                raise EngineGone(f"The engine does not answer ({error}). {self._output_text()}") from error
            if size == 0:
                raise EngineGone(f"The engine has ended in the middle of a tile. {self._output_text()}")
            view = view[size:]
        return data

    def _receive(self) -> tuple[dict, bytearray]:
        (length,) = struct.unpack("<I", self._receive_bytes(4))
        header = json.loads(self._receive_bytes(length))
        if "error" in header:
            raise Rejected(f"{header['error']} {self._output_text() if 'printed' in header['error'] else ''}".strip())
        return header, self._receive_bytes(header["bytes"])

    def describe(self, requested: dict[str, str]) -> dict:
        """Returns the scene's description from scene_description.gd. `requested` has `rect`, `tile_size` and `layers` as strings;
        missing values get defaults. Raises Rejected for a scene that cannot be baked, and for a project with another version of
        the add-on."""
        self._send({"do": "describe", **requested})
        described = self._receive()[0]
        if "columns" not in described:
            raise Rejected("The project has another version of the add-on: copy the add-on of this checkout into the project.")
        return described

    def models(self, layers: list[int]) -> tuple[list[dict], dict[str, bytes]]:
        """Returns the models of each layer's instances, and the contents of the required files, keyed by path."""
        self._send({"do": "models", "layers": layers})
        models: list[dict] = []
        files: dict[str, bytes] = {}
        while True:
            header, payload = self._receive()
            if header.get("end"):
                return models, files
            if "file" in header:
                files[header["file"]] = bytes(payload)
            else:
                models.append(header)

    def rows(self, tile: tuple[int, int]) -> Iterator[tuple[dict, bytearray]]:
        """Yields, for each of the game's tiles that overlaps a tile of the bake, a header with `layer`, `bounds` (see
        grid.py) and other values, and the rows (see ScatterTile.get_rows). The tiles belong to the last described scene."""
        self._send({"do": "rows", "tile": tile})
        while True:
            header, data = self._receive()
            if header.get("end"):
                return
            yield header, data

    def peak_memory(self) -> int:
        """Returns the engine's peak memory in bytes, or 0 if the system does not provide it."""
        peak = 0
        with contextlib.suppress(OSError):
            for process in self.family:
                for line in Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8").splitlines():
                    if line.startswith("VmHWM:"):
                        peak = max(peak, 1024 * int(line.split()[1]))
        return peak

    def core_seconds(self) -> float:
        """Returns the CPU time of all threads of the engine so far. After the engine has ended, returns the last known
        value."""
        return self.processor_time.total()

    def close(self) -> None:
        """Stops the engine. It also stops when this process ends."""
        self.connection.close()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
