"""Writes a map of each layer of a bake: a gray PNG in plan view, west at the left and the engine's least z at the top. See READERS.md."""

from __future__ import annotations

import argparse
import json
import math
import re
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import BinaryIO

import numpy as np
import png
from baking.format import BakeError
from baking.whole_file import whole_file, write_whole

from .bake import Bake, Layer, Tile, open_bake, read_batches
from .say import say

LONGEST = 4096  # Pixels of a map's longer side, where nobody says otherwise.
MOST_PIXELS = 2**31 - 1  # Of a side, in a PNG.
BATCH = 1 << 18  # Rows of a tile that are read at once.


class GrayPng:
    """A PNG that is written row by row, so that its size does not matter."""

    def __init__(self, file: BinaryIO, width: int, height: int, bits: int):
        self._file, self._type = file, ">u2" if bits == 16 else "u1"
        self._packer = zlib.compressobj(6)
        png.Writer(width, height, greyscale=True, bitdepth=bits).write_preamble(file)

    def write(self, rows: np.ndarray) -> None:
        """Appends rows of whole numbers, n by width."""
        lines = rows.astype(self._type)
        raw = lines.view(np.uint8).reshape(len(rows), -1)
        self._chunk(self._packer.compress(np.insert(raw, 0, 0, axis=1).tobytes()))  # Each row begins with its filter, 0 for none.

    def end(self) -> None:
        self._chunk(self._packer.flush())
        png.write_chunk(self._file, b"IEND")
        self._file.flush()

    def _chunk(self, data: bytes) -> None:
        if data:
            png.write_chunk(self._file, b"IDAT", data)


def most_in_a_pixel(radius: float, meters: float) -> int:
    """As many points as can lie in a square with this side, no two of them nearer than `radius` (N. Oler, 1961, An inequality in the geometry of
    numbers)."""
    share = meters / radius
    return math.floor(2 / math.sqrt(3) * share * share + 2 * share + 1)


def gray_of_one(layer: Layer, meters: float, bits: int) -> float:
    """How much brighter an instance makes its pixel. A whole number where there is room for one, so that a program reads counts from a map; the fullest pixel
    that a layer can have is at most white."""
    white, most = 2**bits - 1, most_in_a_pixel(layer.radius, meters)
    return white // most if most <= white else white / most


class Map:
    """How the rectangle of a bake is parted into pixels."""

    def __init__(self, bake: Bake, meters: float):
        self._bake, self.meters = bake, meters
        self.left, self.top, width, depth = bake.rect
        self.width, self.height = max(1, math.ceil(width / meters)), max(1, math.ceil(depth / meters))
        if max(self.width, self.height) > MOST_PIXELS:
            raise BakeError(f"--meters is {meters}, which gives {self.width} x {self.height} pixels, more than a PNG can have: at most {MOST_PIXELS} a side; choose a larger one")
        self._slots = np.full(1 << 16, -1, np.int64)
        for slot, layer in enumerate(bake.layers):
            self._slots[layer.index] = slot

    def columns(self, x: np.ndarray) -> np.ndarray:
        """What stands a little outside of the rectangle counts to its border."""
        return np.floor((x - self.left) / self.meters).clip(0, self.width - 1).astype(np.int64)

    def rows(self, z: np.ndarray | float) -> np.ndarray:
        return np.floor((z - self.top) / self.meters).clip(0, self.height - 1).astype(np.int64)

    def bands(self, memory: int) -> Iterator[np.ndarray]:
        """Counts of instances, layers by rows by width, for so many rows at once as fit into `memory` bytes, from the top down."""
        # The sums of a batch are 8 bytes a pixel beside the 4 of the counts, and encoding takes as much.
        row_bytes = self.width * len(self._bake.layers) * 12
        most = memory // row_bytes
        if most < 1:
            raise BakeError(
                f"--memory is too small for one row of {self.width} pixels in {len(self._bake.layers)} layers: it is {memory / 1e6:g} MB, "
                f"and has to be {row_bytes / 1e6:g} MB or more; raise it, or choose larger --meters"
            )
        for first in range(0, self.height, most):
            band = np.zeros((len(self._bake.layers), min(most, self.height - first), self.width), np.uint32)
            for tile in self._bake.tiles:
                if tile.rows and (tile.bounds is None or self._meets(tile, first, first + band.shape[1])):
                    self._count(tile, first, band)
            yield band

    def _meets(self, tile: Tile, first: int, end: int) -> bool:
        return self.rows(tile.bounds[5]) >= first and self.rows(tile.bounds[2]) < end

    def _count(self, tile: Tile, first: int, band: np.ndarray) -> None:
        for batch in read_batches(tile, ["layer", "x", "z"], BATCH):
            slots, rows = self._slots[batch["layer"]], self.rows(batch["z"]) - first
            if (slots < 0).any():
                unknown = batch["layer"][slots < 0][0]
                raise BakeError(f"{tile.file} has instances of layer {unknown}, which the manifest does not name; {tile.remedy}")
            columns = self.columns(batch["x"])
            inside = (rows >= 0) & (rows < band.shape[1])
            for slot in np.unique(slots[inside]):
                here = inside & (slots == slot)
                _add(band[slot], rows[here], columns[here])


def _add(counts: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> None:
    """Adds one at each of these pixels; only the part of `counts` around them is looked at."""
    top, left = rows.min(), columns.min()
    height, width = rows.max() - top + 1, columns.max() - left + 1
    sums = np.bincount((rows - top) * width + columns - left, minlength=height * width)
    counts[top : top + height, left : left + width] += sums.reshape(height, width).astype(np.uint32)


def file_names(layers: tuple[Layer, ...]) -> list[str]:
    return [f"{layer.index}_{re.sub(r'[^A-Za-z0-9]+', '_', layer.name).strip('_') or 'layer'}.png" for layer in layers]


def usual_meters(bake: Bake) -> float:
    """The least of 1, 2 and 5 times a power of ten with which the longer side has at most LONGEST pixels, and at least 1 m."""
    wanted = max(1.0, max(bake.rect[2:]) / LONGEST)
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(power * factor for factor in (1, 2, 5, 10) if power * factor >= wanted)


def write_maps(bake: Bake, folder: Path, meters: float, bits: int, memory: int, progress: Callable[[float], None]) -> None:
    """Writes a PNG for each layer and maps.json, which tells what their grays are. Each file appears when all are whole."""
    plan = Map(bake, meters)
    grays = [gray_of_one(layer, meters, bits) for layer in bake.layers]
    names, white = file_names(bake.layers), 2**bits - 1
    totals, clipped = np.zeros(len(names), np.int64), np.zeros(len(names), np.int64)
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        files = [stack.enter_context(whole_file(folder / name)) for name in names]
        writers = [GrayPng(file, plan.width, plan.height, bits) for file in files]
        done = 0
        for band in plan.bands(memory):
            for slot, writer in enumerate(writers):
                for start in range(0, band.shape[1], 64):
                    counts = band[slot, start : start + 64]
                    values = np.rint(counts * grays[slot])
                    totals[slot] += counts.sum(dtype=np.int64)
                    clipped[slot] += (values > white).sum()
                    writer.write(values.clip(0, white))
            done += band.shape[1]
            progress(done / plan.height)
        for writer in writers:
            writer.end()
    described = [
        {"file": name, "layer": layer.index, "name": layer.name, "gray_of_one": gray, "instances": int(total), "pixels_beyond_white": int(beyond)}
        for name, layer, gray, total, beyond in zip(names, bake.layers, grays, totals, clipped)
    ]
    about = {"scene": bake.scene, "scene_digest": bake.scene_digest, "rect": bake.rect, "meters_a_pixel": meters, "width": plan.width}
    write_whole(folder / "maps.json", json.dumps({**about, "height": plan.height, "bits": bits, "maps": described}, indent=1).encode())
    for entry in described:
        if entry["pixels_beyond_white"]:
            say(f"{entry['file']}: {entry['pixels_beyond_white']} pixels have more instances than points of the layer's radius can have; they are white, so use smaller --meters to tell them apart")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=Path, help="where the maps go; made if need be")
    parser.add_argument("--meters", type=float, help=f"meters a pixel; unless told, a round number with which no side has more than {LONGEST} pixels")
    parser.add_argument("--bits", type=int, choices=(8, 16), default=16, help="bits a pixel (16)")
    parser.add_argument("--memory", type=float, default=256.0, metavar="MB", help="about how much to take (256)")


def export(chosen: argparse.Namespace) -> None:
    """Writes the maps. Raises BakeError for a value without sense, before anything is written."""
    bake = open_bake(chosen.bake, chosen.verify)
    meters = usual_meters(bake) if chosen.meters is None else chosen.meters
    if not (math.isfinite(meters) and meters > 0):
        raise BakeError(f"--meters is {meters}, where a length above 0 is expected")
    if not (math.isfinite(chosen.memory) and chosen.memory > 0):
        raise BakeError(f"--memory is {chosen.memory}, where a number of MB above 0 is expected")
    write_maps(bake, chosen.folder, meters, chosen.bits, int(chosen.memory * 1e6), lambda share: say(f"{share:.0%}"))
    say(f"{len(bake.layers)} maps lie in {chosen.folder}, {meters:g} m a pixel")
