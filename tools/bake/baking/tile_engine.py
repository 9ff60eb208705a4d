"""One engine that makes tiles: starts it, and asks it over a connection on this machine. What is said over it stands in
demo_project/addons/thicket/bake_world.gd."""

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
# Seconds without a word after which an engine counts as stuck.
ANSWER_TIMEOUT = 900.0


@dataclass(frozen=True)
class Source:
    """What an engine is started with: the command that runs Godot, the project's folder, the scene's res:// path, the scatter's path
    in it (empty for the only one), and the seconds that the ground may take to be there."""

    godot: tuple[str, ...]
    project: str
    scene: str
    node: str = ""
    wait: float = 120.0

    def start(self) -> TileEngine:
        return TileEngine(self)


class EngineGone(RuntimeError):
    """The engine has ended or cannot be started; another one may do better."""


class Refused(RuntimeError):
    """The engine has answered that it cannot do what was asked, with a sentence."""


class TileEngine:
    """A running engine with its scene loaded. Not for several threads."""

    def __init__(self, source: Source):
        """Starts it and waits until it is connected. Raises EngineGone with what it printed where that fails."""
        self.log = tempfile.TemporaryFile()
        token = secrets.token_hex(16)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            arguments = [f"scene={source.scene}", f"connect={listener.getsockname()[1]}", f"token={token}", f"wait={source.wait:g}"]
            if source.node:
                arguments.append(f"node={source.node}")
            command = [*source.godot, "--headless", "--path", source.project, "--script", SCRIPT, "--", *arguments]
            try:
                # From the project's folder: what runs Godot may hide folders that have nothing to do with where it is called.
                self.process = subprocess.Popen(
                    command, cwd=source.project, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log
                )
            except OSError as error:
                raise EngineGone(f"{source.godot[0]} cannot be started in {source.project}: {error}. Set GODOT to the program of Godot.") from error
            self.project = source.project
            self.connection = self._accept(listener, token, time.monotonic() + source.wait + 60.0)
        self.connection.settimeout(ANSWER_TIMEOUT)
        self.family = self._family()

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
            self.connection.close()  # Somebody else of this machine.
        raise EngineGone(f"The engine did not connect in time, or ended before: check the project, {self.project}. {self._last_words()}")

    def _family(self) -> list[psutil.Process]:
        """The engine's process, and those between it and this one: what runs Godot may be a wrapper."""
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
                raise EngineGone(f"The engine has ended in the middle of its work. {self._last_words()}")
            view = view[size:]
        return taken

    def _receive(self) -> tuple[dict, bytearray]:
        (length,) = struct.unpack("<I", self._take(4))
        header = json.loads(self._take(length))
        if "error" in header:
            raise Refused(f"{header['error']} {self._last_words() if 'printed' in header['error'] else ''}".strip())
        return header, self._take(header["bytes"])

    def describe(self, asked: dict[str, str]) -> dict:
        """What scene_description.gd says of the scene for a `rect`, a `tile_size` and `layers`, each a text; what is missing is chosen there. Raises
        Refused for what cannot be baked, and for a project with an add-on that does not know of this."""
        self._send({"do": "describe", **asked})
        described = self._receive()[0]
        if "columns" not in described:
            raise Refused("The project has the add-on of another version of Thicket: copy the one of this checkout into it.")
        return described

    def models(self, layers: list[int]) -> tuple[list[dict], dict[str, bytes]]:
        """For each of the layers what its instances look like, and the contents of the files that this takes, by path."""
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
        """What a tile of what was described last consists of: of each tile of the game its `layer`, its `bounds` (see grid.py) and so on, and its rows;
        see ScatterTile.get_rows."""
        self._send({"do": "rows", "tile": tile})
        while True:
            part, data = self._receive()
            if part.get("end"):
                return
            yield part, data

    def peak_memory(self) -> int:
        """The most bytes that the engine had in memory so far; 0 where the system does not tell."""
        peak = 0
        with contextlib.suppress(OSError):
            for each in self.family:
                for line in Path(f"/proc/{each.pid}/status").read_text(encoding="utf-8").splitlines():
                    if line.startswith("VmHWM:"):
                        peak = max(peak, 1024 * int(line.split()[1]))
        return peak

    def core_seconds(self) -> float:
        """Processor time that the engine has taken so far, of all its threads; what of it is known for one that has ended."""
        spent = 0.0
        for each in self.family:
            with contextlib.suppress(psutil.Error):
                times = each.cpu_times()
                spent += times.user + times.system
        return spent

    def close(self) -> None:
        """Ends the engine. It ends by itself, too, when this process does."""
        self.connection.close()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
