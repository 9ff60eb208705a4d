"""Options of the command line that several exports share."""

from __future__ import annotations

import argparse
import math
import re

import numpy as np

from baking.command_line import folder_argument
from baking.format import BakeError

from .bake import Bake, Tile


def add_folder(parser: argparse.ArgumentParser, files: str) -> None:
    """Adds the options `folder` and `--tiles` of exports that write a file for each tile."""
    parser.add_argument("folder", type=folder_argument, help=f"the folder for {files}; created if it does not exist")
    parser.add_argument("--tiles", default="", metavar="'I,J I,J'", help="export only these tiles")


def tiles_to_export(bake: Bake, names: list[str]) -> list[Tile]:
    """Returns the tiles that have rows, limited to those in `names` if that list is not empty. Names have the form
    I,J. Raises BakeError for an unknown name."""
    tiles = {str(tile): tile for tile in bake.tiles}
    for name in names:
        if name not in tiles:
            raise BakeError(f"--tiles: the bake has no tile {name}; its first tile is {next(iter(tiles), 'none')}, in the form I,J")
    return [tile for tile in ([tiles[name] for name in names] or bake.tiles) if tile.rows]


def vector(text: str) -> np.ndarray:
    numbers = [float(component) for component in text.split(",")] if re.fullmatch(r"[-+.,\deE]+", text) else []
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise argparse.ArgumentTypeError(f"'{text}' is not X,Y,Z: three finite numbers in meters separated by commas")
    return np.array(numbers)
