#!/usr/bin/env python3
"""Generates the terrain for the demo scenes about rules and biomes: a valley of 768 m with a lake, meadows, woods and a steep scree slope.

Writes the following files next to this script:
- valley.r16       385 x 385 unsigned 16-bit little-endian samples, 2 m apart, row by row, rows from north to south, samples
                   from west to east: height = LOW + sample / 65535 * (HIGH - LOW) meters. The lake's surface is at 0.
- valley_soil.png  193 x 193 pixels, 4 m apart: the weights of meadow (red), forest floor (green), rock (blue) and sand (alpha), 0
                   to 255. They add up to 255.
- valley_biomes.png  48 x 48 pixels, 16 m wide: MEADOW and WOOD, with smooth outlines, which the scatter makes irregular.

In the world +x is east, +z is south, y is up, and the map's center is the origin.

Usage: make_valley.py [--out DIRECTORY]; needs numpy and pillow.
"""

import argparse
import pathlib

import numpy as np
from PIL import Image

SIZE = 768.0
POSTS = 385
SOIL_POSTS = 193
LOW = -8.0
HIGH = 120.0
BIOME_PIXELS = 48
MEADOW = (176, 196, 72)
WOOD = (32, 84, 48)
# The x and z of the path's corners, from south to north, as in the scene.
PATH = [(60, 384), (48, 300), (26, 220), (4, 150), (24, 92), (64, 40), (74, -18), (58, -78), (82, -140), (68, -215),
        (92, -295), (80, -384)]


def smooth(start: float, end: float, value: np.ndarray) -> np.ndarray:
    """Returns 0 before `start`, 1 after `end`, and a smooth transition in between. `start` may be larger than `end`."""
    t = np.clip((value - start) / (end - start), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def noise(x: np.ndarray, z: np.ndarray, size: float, seed: int) -> np.ndarray:
    """Returns smooth noise from about -1 to 1, with features of `size` meters."""
    lattice = np.random.default_rng(seed).uniform(-1.0, 1.0, (256, 256))
    px, pz = x / size + 128.0, z / size + 128.0
    i, j = np.floor(px).astype(int), np.floor(pz).astype(int)
    u, v = smooth(0.0, 1.0, px - i), smooth(0.0, 1.0, pz - j)
    north = lattice[j, i] * (1.0 - u) + lattice[j, i + 1] * u
    south = lattice[j + 1, i] * (1.0 - u) + lattice[j + 1, i + 1] * u
    return north * (1.0 - v) + south * v


def rough(x: np.ndarray, z: np.ndarray, size: float, seed: int) -> np.ndarray:
    """Returns the sum of three octaves of noise. The largest has features of `size` meters."""
    return sum(noise(x, z, size / 2**octave, seed + octave) / 2**octave for octave in range(3)) / 1.75


def from_shore(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns the approximate distance from the lake's shore in meters, which is negative in the lake."""
    scaled_x, scaled_z = (x + 45.0) / 82.0, (z + 25.0) / 48.0
    angle = np.arctan2(scaled_z, scaled_x)
    bays = 1.0 + 0.14 * np.sin(2.0 * angle + 0.8) + 0.09 * np.sin(3.0 * angle - 0.5) + 0.04 * np.sin(7.0 * angle)
    return (np.hypot(scaled_x, scaled_z) / bays - 1.0) * 60.0


def from_path(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns the distance in meters from the center line of the path, which consists of straight segments."""
    nearest = np.full(x.shape, np.inf)
    for (ax, az), (bx, bz) in zip(PATH, PATH[1:], strict=False):
        fraction = ((x - ax) * (bx - ax) + (z - az) * (bz - az)) / ((bx - ax) ** 2 + (bz - az) ** 2)
        fraction = np.clip(fraction, 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(x - ax - fraction * (bx - ax), z - az - fraction * (bz - az)))
    return nearest


def scarp(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns the horizontal distance in meters from the foot of the eastern slope, increasing uphill."""
    return x - 122.0 - 24.0 * np.sin(z / 75.0 + 0.6) - 14.0 * rough(x, z, 60.0, 50)


def heights(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns the heights in meters."""
    shore = from_shore(x, z)
    inland = smooth(4.0, 60.0, shore)
    ground = np.where(shore < 0.0, np.maximum(0.12 * shore, -5.0), 0.055 * shore)
    ground = np.minimum(ground, 5.0 + 0.01 * shore)
    ground += inland * (3.2 * rough(x, z, 90.0, 10) + 0.5 * rough(x, z, 24.0, 20))
    ground += 62.0 * smooth(-95.0, -360.0, z + 18.0 * rough(x, z, 120.0, 30)) * (1.0 - 0.45 * smooth(60.0, 150.0, x))
    ground += 46.0 * smooth(-150.0, -384.0, x + 20.0 * rough(x, z, 120.0, 40))
    ground += 34.0 * smooth(190.0, 384.0, z)
    uphill = scarp(x, z)
    # The slope is steep in the main view, and gentler and wooded to the north and south.
    slope_length = 62.0 + 90.0 * smooth(70.0, 170.0, np.abs(z + 10.0 + 40.0 * noise(x, z, 60.0, 55)))
    ground += 38.0 * smooth(0.0, 1.0, (uphill + 8.0) / (slope_length + 8.0))
    ground += 14.0 * smooth(40.0, 200.0, uphill)
    return ground


def soils(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Returns the weights of meadow, forest floor, rock and sand along the last axis."""
    step = 2.0
    ground = heights(x, z)
    rise_x = (heights(x + step, z) - heights(x - step, z)) / (2.0 * step)
    rise_z = (heights(x, z + step) - heights(x, z - step)) / (2.0 * step)
    slope = np.degrees(np.arctan(np.hypot(rise_x, rise_z)))
    # Woods keep a distance from the middle of the valley, the lake and the path.
    valley = (np.hypot((x - 5.0) / 145.0, (z - 70.0) / 160.0) - 1.0) * 130.0
    open_land = np.minimum.reduce([valley, from_shore(x, z) - 16.0, from_path(x, z) - 20.0])
    groves = 30.0 * smooth(0.3, 0.5, rough(x, z, 62.0, 70)) * smooth(20.0, 40.0, from_shore(x, z))
    wood = smooth(-3.0, 3.0, open_land + 24.0 * rough(x, z, 50.0, 60) + 2.0 * groves)
    rock = smooth(24.0, 31.0, slope + 3.0 * noise(x, z, 9.0, 80))
    sand = smooth(0.75, 0.3, ground + 0.25 * noise(x, z, 12.0, 90))
    weights = np.stack([(1.0 - rock) * (1.0 - sand) * (1.0 - wood), (1.0 - rock) * (1.0 - sand) * wood,
                        rock * (1.0 - sand), sand], axis=-1)
    return weights


def biomes() -> Image.Image:
    """Returns the biome map: meadows in the middle of the valley and in a northern glade, surrounded by woods that reach the lake."""
    line = (np.arange(BIOME_PIXELS) + 0.5) / BIOME_PIXELS * SIZE - SIZE / 2.0
    x, z = np.meshgrid(line, line)
    meadow = np.hypot((x - 30.0) / 150.0, (z - 70.0) / 190.0) < 1.0
    meadow |= np.hypot(x + 160.0, z + 170.0) < 55.0
    meadow &= ~(np.hypot((x + 70.0) / 90.0, (z - 60.0) / 46.0) < 1.0)
    return Image.fromarray(np.where(meadow[..., None], MEADOW, WOOD).astype(np.uint8), "RGB")


def grid(posts: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the world x and z of `posts` by `posts` positions, with rows from north to south."""
    line = np.linspace(-SIZE / 2.0, SIZE / 2.0, posts)
    x, z = np.meshgrid(line, line)
    return x, z


def make() -> tuple[bytes, Image.Image]:
    """Returns the bytes of the height samples and the image of the soils. Raises ValueError if a height is out of range."""
    values = np.round((heights(*grid(POSTS)) - LOW) / (HIGH - LOW) * 65535.0)
    if values.min() < 0.0 or values.max() > 65535.0:
        raise ValueError("heights do not fit between LOW and HIGH")
    weights = soils(*grid(SOIL_POSTS))
    return values.astype("<u2").tobytes(), Image.fromarray(np.round(weights * 255.0).astype(np.uint8), "RGBA")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).parent)
    folder = parser.parse_args().out
    posts, soil = make()
    (folder / "valley.r16").write_bytes(posts)
    soil.save(folder / "valley_soil.png", optimize=True)
    biomes().save(folder / "valley_biomes.png", optimize=True)


if __name__ == "__main__":
    main()
