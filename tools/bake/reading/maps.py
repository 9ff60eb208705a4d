"""Writes a map of each layer of a bake: a grayscale PNG as seen from above, with x to the right and z down. See
READERS.md."""

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
from baking.command_line import folder_argument
from baking.format import BakeError
from baking.whole_file import whole_file, write_whole

from .bake import Bake, Layer, Tile, open_bake, read_batches
from .say import say

LONGEST = 4096  # The default maximum of a map's longer side in pixels.
MAX_PIXELS = 2**31 - 1  # The maximum width and height of a PNG in pixels.
BATCH = 1 << 18  # The number of rows of a tile to read in one call.


class GrayPng:
    """Writes a PNG row by row, so that memory does not limit its size."""

    def __init__(self, file: BinaryIO, width: int, height: int, bits: int):
        self._file, self._type = file, ">u2" if bits == 16 else "u1"
        self._packer = zlib.compressobj(6)
        png.Writer(width, height, greyscale=True, bitdepth=bits).write_preamble(file)

    def write(self, rows: np.ndarray) -> None:
        """Appends rows of integers, n by width."""
        lines = rows.astype(self._type)
        raw = lines.view(np.uint8).reshape(len(rows), -1)
        # Each row of a PNG begins with its filter type; 0 is none.
        self._chunk(self._packer.compress(np.insert(raw, 0, 0, axis=1).tobytes()))

    def end(self) -> None:
        self._chunk(self._packer.flush())
        png.write_chunk(self._file, b"IEND")
        self._file.flush()

    def _chunk(self, data: bytes) -> None:
        if data:
            png.write_chunk(self._file, b"IDAT", data)


def max_in_a_pixel(radius: float, meters: float) -> int:
    """Returns the maximum number of points in a square with edges of `meters` if any two of them are at least `radius` apart
    (N. Oler, 1961, An inequality in the geometry of numbers)."""
    ratio = meters / radius
    return math.floor(2 / math.sqrt(3) * ratio * ratio + 2 * ratio + 1)


def gray_of_one(layer: Layer, meters: float, bits: int) -> float:
    """Returns the gray value of one instance. The value is an integer if possible, so that a program can compute exact
    counts from a map. The largest possible number of points in a pixel is at most white."""
    white, max_count = 2**bits - 1, max_in_a_pixel(layer.radius, meters)
    return white // max_count if max_count <= white else white / max_count


class Map:
    """The pixel grid of a bake's rectangle."""

    def __init__(self, bake: Bake, meters: float):
        self._bake, self.meters = bake, meters
        self.left, self.top, width, depth = bake.rect
        self.width, self.height = max(1, math.ceil(width / meters)), max(1, math.ceil(depth / meters))
        if max(self.width, self.height) > MAX_PIXELS:
            raise BakeError(f"--meters {meters} results in {self.width} x {self.height} pixels, but the width and height of a PNG must be at most {MAX_PIXELS}; choose a larger value")
        self._slots = np.full(1 << 16, -1, np.int64)
        for slot, layer in enumerate(bake.layers):
            self._slots[layer.index] = slot

    def columns(self, x: np.ndarray) -> np.ndarray:
        """Returns the pixel column of each position. Positions slightly outside the rectangle belong to its outermost
        pixels."""
        return np.floor((x - self.left) / self.meters).clip(0, self.width - 1).astype(np.int64)

    def rows(self, z: np.ndarray | float) -> np.ndarray:
        return np.floor((z - self.top) / self.meters).clip(0, self.height - 1).astype(np.int64)

    def bands(self, memory: int) -> Iterator[np.ndarray]:
        """Yields instance counts (layers by rows by width) in bands from the top down. Each array has as many rows as
        fit into `memory` bytes."""
        # Each pixel takes 4 bytes for its count, and 8 bytes for the sum of a batch of rows. Encoding takes as much memory
        # as the sum, but not at the same time.
        row_bytes = self.width * len(self._bake.layers) * 12
        max_rows = memory // row_bytes
        if max_rows < 1:
            raise BakeError(
                f"--memory must be {row_bytes / 1e6:g} MB or more for a row of {self.width} pixels in {len(self._bake.layers)} layers, "
                f"got {memory / 1e6:g} MB; increase it, or choose a larger value for --meters"
            )
        for first in range(0, self.height, max_rows):
            band = np.zeros((len(self._bake.layers), min(max_rows, self.height - first), self.width), np.uint32)
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
                unknown_layer = batch["layer"][slots < 0][0]
                raise BakeError(f"{tile.file} has instances of layer {unknown_layer}, which is not in the manifest; {tile.remedy}")
            columns = self.columns(batch["x"])
            in_band = (rows >= 0) & (rows < band.shape[1])
            for slot in np.unique(slots[in_band]):
                in_slot = in_band & (slots == slot)
                _add(band[slot], rows[in_slot], columns[in_slot])


def _add(counts: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> None:
    """Adds 1 to the counts of these pixels. Accesses only the part of `counts` that contains them."""
    top, left = rows.min(), columns.min()
    height, width = rows.max() - top + 1, columns.max() - left + 1
    sums = np.bincount((rows - top) * width + columns - left, minlength=height * width)
    counts[top : top + height, left : left + width] += sums.reshape(height, width).astype(np.uint32)


def file_names(layers: tuple[Layer, ...]) -> list[str]:
    return [f"{layer.index}_{re.sub(r'[^A-Za-z0-9]+', '_', layer.name).strip('_') or 'layer'}.png" for layer in layers]


def default_meters(bake: Bake) -> float:
    """Returns the default width of a pixel in meters: the smallest number 1, 2, 5, 10, 20, ... with which the longer
    side of the map has at most LONGEST pixels."""
    minimum = max(1.0, max(bake.rect[2:]) / LONGEST)
    power = 10.0 ** math.floor(math.log10(minimum))
    return next(power * factor for factor in (1, 2, 5, 10) if power * factor >= minimum)


def write_maps(bake: Bake, folder: Path, meters: float, bits: int, memory: int, progress: Callable[[float], None]) -> None:
    """Writes a PNG for each layer and maps.json, which describes their gray values. The PNGs appear only when all of them are
    complete."""
    plan = Map(bake, meters)
    grays = [gray_of_one(layer, meters, bits) for layer in bake.layers]
    names, white = file_names(bake.layers), 2**bits - 1
    totals, clipped = np.zeros(len(names), np.int64), np.zeros(len(names), np.int64)
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        files = [stack.enter_context(whole_file(folder / name)) for name in names]
        writers = [GrayPng(file, plan.width, plan.height, bits) for file in files]
        finished_rows = 0
        for band in plan.bands(memory):
            for slot, writer in enumerate(writers):
                for start in range(0, band.shape[1], 64):
                    counts = band[slot, start : start + 64]
                    values = np.rint(counts * grays[slot])
                    totals[slot] += counts.sum(dtype=np.int64)
                    clipped[slot] += (values > white).sum()
                    writer.write(values.clip(0, white))
            finished_rows += band.shape[1]
            progress(finished_rows / plan.height)
        for writer in writers:
            writer.end()
    entries = [
        {"file": name, "layer": layer.index, "name": layer.name, "gray_of_one": gray, "instances": int(total), "pixels_beyond_white": int(clipped_count)}
        for name, layer, gray, total, clipped_count in zip(names, bake.layers, grays, totals, clipped)
    ]
    description = {"scene": bake.scene, "scene_digest": bake.scene_digest, "rect": bake.rect, "meters_a_pixel": meters, "width": plan.width}
    write_whole(folder / "maps.json", json.dumps({**description, "height": plan.height, "bits": bits, "maps": entries}, indent=1).encode())
    for entry in entries:
        if entry["pixels_beyond_white"]:
            say(f"{entry['file']}: {entry['pixels_beyond_white']} pixels have more instances than the layer's radius allows and are white; choose a smaller value for --meters to distinguish them")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=folder_argument, help="the folder for the maps; created if it does not exist")
    parser.add_argument("--meters", type=float, help=f"the width of a pixel in meters; by default a round number with which the map is at most {LONGEST} pixels wide and high")
    parser.add_argument("--bits", type=int, choices=(8, 16), default=16, help="bits per pixel (16)")
    parser.add_argument("--memory", type=float, default=256.0, metavar="MB", help="the approximate memory to use (256)")


def export(options: argparse.Namespace) -> None:
    """Writes the maps. Raises BakeError for an invalid option before it writes anything."""
    bake = open_bake(options.bake, options.verify)
    meters = default_meters(bake) if options.meters is None else options.meters
    if not (math.isfinite(meters) and meters > 0):
        raise BakeError(f"--meters must be above 0 m, got {meters}")
    if not (math.isfinite(options.memory) and options.memory > 0):
        raise BakeError(f"--memory must be above 0 MB, got {options.memory}")
    write_maps(bake, options.folder, meters, options.bits, int(options.memory * 1e6), lambda fraction: say(f"{fraction:.0%}"))
    say(f"wrote {len(bake.layers)} maps to {options.folder}, {meters:g} m per pixel")
