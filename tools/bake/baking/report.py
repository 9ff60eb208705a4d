"""Collects the results of a bake and presents them as progress messages, a map and a report."""

from __future__ import annotations

import colorsys
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from .whole_file import CannotWrite, whole_file, write_whole
from .words import amount, duration

if TYPE_CHECKING:
    from .location import Location

GROUND = (0.93, 0.92, 0.88)


@dataclass
class Outcome:
    """The results of a bake. `failed` has a message for each tile that failed. `stopped` is the reason if the bake
    ended early."""

    manifest: dict
    kept: int = 0
    made: int = 0
    made_rows: int = 0
    bytes: int = 0
    seconds: float = 0.0
    busy_seconds: float = 0.0
    core_seconds: float = 0.0  # CPU time of workers and engines.
    starting: list[float] = field(default_factory=list)  # The startup time of each engine in seconds.
    driver_seconds: float = 0.0  # The CPU time of this process. It includes the Dask scheduler if that runs in this process.
    worker_memory: int = 0
    engine_memory: int = 0
    failed: dict[tuple[int, int], str] = field(default_factory=dict)
    stopped: str = ""
    unreported: str = ""  # The reason why the report or the map could not be written; empty if both were written.

    @property
    def driver_seconds_a_tile(self) -> float:
        return self.driver_seconds / max(self.made + self.kept, 1)


class Progress:
    """Prints the progress of a bake. If `say` is `print` or a partial of it, and the output is a terminal, it updates
    one line. Otherwise it prints a new line every ten seconds."""

    def __init__(self, tiles: int, say: Callable[[str], None]):
        self.tiles = tiles
        self.say = say
        self.start = time.monotonic()
        self.live = getattr(say, "func", say) is print and sys.stdout.isatty()
        self.next = self.start

    def line(self, outcome: Outcome) -> str:
        """Returns a line such as: 12 of 400 tiles, 3.1 per second, 1.2 M instances per second, 2 min left"""
        elapsed = max(time.monotonic() - self.start, 1e-3)
        finished = outcome.made + outcome.kept + len(outcome.failed)
        remaining = elapsed / max(finished, 1) * (self.tiles - finished)
        failure_text = f", {len(outcome.failed)} failed" if outcome.failed else ""
        return (
            f"{finished} of {self.tiles} tiles{failure_text}, {finished / elapsed:.1f} per second, "
            f"{amount(outcome.made_rows / elapsed)} instances per second, {duration(remaining)} left"
        )

    def print_if_due(self, outcome: Outcome) -> None:
        """Prints the progress if enough time has passed since it was last printed."""
        now = time.monotonic()
        if now < self.next:
            return
        self.next = now + (0.2 if self.live else 10.0)
        if self.live:
            print(f"\r{self.line(outcome):<100}", end="", flush=True)
        else:
            self.say(self.line(outcome))

    def end(self, outcome: Outcome) -> None:
        """Prints the final progress."""
        self.next = 0.0
        self.print_if_due(outcome)
        if self.live:
            print()


class Map:
    """Draws a bake as seen from above, with x to the right and z down. Each layer has a color. Layers with a large
    radius are drawn on top of those with a small one."""

    def __init__(self, rect: tuple[float, float, float, float], pixel: float, layers: list[dict]):
        self.size = (max(1, int(np.ceil(rect[3] / pixel - 1e-9))), max(1, int(np.ceil(rect[2] / pixel - 1e-9))))
        self.layers = layers
        self.pixel = pixel
        self.counts = np.zeros((len(layers), *self.size), np.uint32)

    def add(self, pixels: list[tuple[np.ndarray, np.ndarray]]) -> None:
        """Adds a tile's instances to the counts."""
        for counts, (pixel_indices, instance_counts) in zip(self.counts, pixels, strict=True):
            row = np.minimum(pixel_indices >> 16, self.size[0] - 1)
            column = np.minimum(pixel_indices & 0xFFFF, self.size[1] - 1)
            np.add.at(counts, (row, column), instance_counts.astype(np.uint32))

    def _largest_first(self) -> list[int]:
        return sorted(range(len(self.layers)), key=lambda index: -self.layers[index]["radius"])

    def colors(self) -> list[tuple[float, float, float]]:
        """Returns the red, green and blue of each layer, from 0 to 1. The hues differ clearly, and layers with a large
        radius are dark."""
        order = self._largest_first()
        lightness = np.linspace(0.28, 0.72, max(len(order), 2))
        colors = [(0.0, 0.0, 0.0)] * len(order)
        for rank, index in enumerate(order):
            colors[index] = colorsys.hls_to_rgb((0.34 + 0.381966 * rank) % 1.0, float(lightness[rank]), 0.55)
        return colors

    def picture(self) -> Image.Image:
        """Draws the map. Each instance is a disc whose diameter is the radius of its layer, at most 25 pixels. A pixel that is
        larger than the discs shows the fraction of its area that the discs cover."""
        image = np.empty((*self.size, 3), np.float32)
        image[:] = GROUND
        for index in reversed(self._largest_first()):
            coverage = self._cover(self.counts[index], self.layers[index]["radius"] / self.pixel)[..., None]
            image = image * (1.0 - coverage) + np.float32(self.colors()[index]) * coverage
        return Image.fromarray(np.rint(image * 255.0).astype(np.uint8))

    @staticmethod
    def _cover(counts: np.ndarray, width: float) -> np.ndarray:
        """Returns the covered fraction of each pixel, 0 to 1. `width` is the width of an instance in pixels."""
        cover = np.minimum(counts * np.float32(0.25 * np.pi * width * width), 1.0).astype(np.float32)
        radius = int(min(width, 25.0) / 2.0)
        if radius < 1:
            return cover
        discs = np.zeros_like(counts, dtype=bool)
        has_instances = counts > 0
        for row_offset in range(-radius, radius + 1):
            for column_offset in range(-radius, radius + 1):
                if row_offset * row_offset + column_offset * column_offset > radius * radius + 1:
                    continue
                rows = slice(max(row_offset, 0), counts.shape[0] + min(row_offset, 0)), slice(max(-row_offset, 0), counts.shape[0] + min(-row_offset, 0))
                columns = slice(max(column_offset, 0), counts.shape[1] + min(column_offset, 0)), slice(max(-column_offset, 0), counts.shape[1] + min(-column_offset, 0))
                discs[rows[0], columns[0]] |= has_instances[rows[1], columns[1]]
        return discs.astype(np.float32)


def write_report(out: Location, workers: int, outcome: Outcome, picture: Map) -> None:
    """Writes map.png and report.md next to the manifest. If that fails, sets `unreported` instead of raising an
    exception."""
    try:
        write_whole(out / "report.md", report(workers, outcome, picture).encode())
        with whole_file(out / "map.png") as file:
            picture.picture().save(file, "PNG")
    except CannotWrite as error:
        outcome.unreported = str(error)


def report(workers: int, outcome: Outcome, picture: Map) -> str:
    """Returns the report in Markdown."""
    manifest = outcome.manifest
    tiles = manifest["tiles"].values()
    rect = manifest["rect"]
    by_layer = np.sum([tile["rows_of_layer"] for tile in tiles] or [[0] * len(manifest["layers"])], axis=0)
    total = int(by_layer.sum())
    seconds = max(outcome.seconds, 1e-3)
    lines = [
        f"# {manifest['scene']}, baked",
        "",
        f"{total:,} instances in {len(tiles):,} of {manifest['grid'][2] * manifest['grid'][3]:,} tiles of {manifest['tile_size']:g} m, "
        f"{rect[2]:g} m by {rect[3]:g} m from x {rect[0]:g}, z {rect[1]:g}. Seed {manifest['seed']}.",
        "",
        f"Digest: `{manifest['digest']}`" if manifest["complete"] else "Incomplete: baking again generates only the missing tiles.",
        "",
        *([f"**Stopped:** {outcome.stopped}", ""] if outcome.stopped else []),
        "![Plan view](map.png)",
        "",
        f"{picture.pixel:.3g} m per pixel; x to the right, z down.",
        "",
        "| Layer | Color | Instances |",
        "| --- | --- | ---: |",
    ]
    for layer, color, count in zip(manifest["layers"], picture.colors(), by_layer, strict=True):
        code = "#" + "".join(f"{round(255 * component):02x}" for component in color)
        lines.append(f"| {layer['index']} {layer['name']} | {code} | {int(count):,} |")
    lines += [
        "",
        "| This run | |",
        "| --- | ---: |",
        f"| generated, existing, failed | {outcome.made}, {outcome.kept}, {len(outcome.failed)} tiles |",
        f"| time | {duration(outcome.seconds)} |",
        f"| per second | {outcome.made / seconds:.2f} tiles, {amount(outcome.made_rows / seconds)} instances |",
        f"| requested workers on this machine | {workers} |",
        f"| workers busy on average | {outcome.busy_seconds / seconds:.2f} |",
        f"| cores used on average | {outcome.core_seconds / seconds:.2f} |",
        f"| driver time per tile | {1000 * outcome.driver_seconds_a_tile:.2f} ms |",
        f"| peak memory of a worker | {outcome.worker_memory / 2**20:.0f} MiB |",
        f"| peak memory of its engine | {outcome.engine_memory / 2**20:.0f} MiB |",
        f"| files | {outcome.bytes / 2**20:.1f} MiB |",
    ]
    sheared = sum(tile.get("sheared", 0) for tile in tiles)
    if sheared:
        lines += ["", f"{sheared} hand-placed instances have a shear, which the files cannot store."]
    if outcome.failed:
        lines += ["", "## Tiles that failed", ""]
        lines += [f"- {i},{j}: {reason}" for (i, j), reason in sorted(outcome.failed.items())]
    return "\n".join(lines) + "\n"
