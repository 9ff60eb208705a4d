#!/usr/bin/env python3
"""Converts the Jacksboro fault elevation model into the demo's heightmap.

The source is `mpl-data/sample_data/jacksboro_fault_dem.npz` of the PyPI package matplotlib, with elevations from the Shuttle Radar
Topography Mission (SRTM). They are in the public domain, according to matplotlib pull request 3291, which added the file. The model has
344 x 403 samples, 3 arc-seconds apart, in the Cumberland Mountains of Tennessee around the Jacksboro fault. Elevations are in whole
meters, from 236 to 1076 m above sea level.

Writes the following files next to this script, bit-identical on every machine:
- jacksboro.r16   unsigned 16-bit little-endian samples, row by row, rows from north to south, samples from west to east.
- jacksboro.json  size, meters between samples, extent and the heights of samples 0 and 65535.

In the world, +x is east, +z is south, y is up, and the map's center is the origin. One sample step is 1/64 m, so every elevation of the
source is represented exactly: height = min_height + sample / 65535 * (max_height - min_height), where max_height - min_height is
65535/64.

Usage: convert_dem.py [--out DIRECTORY] [--source FILE.npz]
"""

import argparse
import importlib.util
import json
import math
import pathlib

import numpy as np

SOURCE = "mpl-data/sample_data/jacksboro_fault_dem.npz"
STEPS_PER_METER = 64
# The WGS 84 ellipsoid: the semi-major axis in meters, and the first eccentricity squared.
SEMI_MAJOR = 6378137.0
ECCENTRICITY_2 = 6.69437999014e-3


def find_source() -> pathlib.Path:
    """Returns the path of the data file in the installed matplotlib, without importing it. Raises FileNotFoundError if there is none."""
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        raise FileNotFoundError("matplotlib is not installed: pip install matplotlib, or pass --source")
    path = pathlib.Path(spec.origin).parent / SOURCE
    if not path.is_file():
        raise FileNotFoundError(f"{path} is missing from the installed matplotlib")
    return path


def meters_per_degree(latitude_degrees: float) -> tuple[float, float]:
    """Returns the meters per degree of longitude and of latitude on the ellipsoid, at a latitude."""
    latitude = math.radians(latitude_degrees)
    w2 = 1.0 - ECCENTRICITY_2 * math.sin(latitude) ** 2
    prime_vertical = SEMI_MAJOR / math.sqrt(w2)
    meridian = SEMI_MAJOR * (1.0 - ECCENTRICITY_2) / w2**1.5
    degree = math.pi / 180.0
    return prime_vertical * math.cos(latitude) * degree, meridian * degree


def convert(source: pathlib.Path) -> tuple[bytes, dict]:
    """Returns the samples and the description of the heightmap for the npz file. Raises ValueError if the data is not as expected."""
    with np.load(source) as dem:
        elevation = dem["elevation"].astype(np.int64)
        # Despite its name, ymin is the northern border, and the first row is the northernmost. Samples are the centers of
        # cells of dx by dy degrees.
        north, south = float(dem["ymin"]), float(dem["ymax"])
        dx, dy = float(dem["dx"]), float(dem["dy"])
    if north < south:
        raise ValueError("expected the first row to be the northern one")
    rows, columns = elevation.shape
    low, high = int(elevation.min()), int(elevation.max())
    samples = (elevation - low) * STEPS_PER_METER
    if samples.max() > 0xFFFF:
        raise ValueError(f"{high - low} m of relief do not fit 16 bits at {STEPS_PER_METER} steps per meter")
    per_lon, per_lat = meters_per_degree((north + south) / 2.0)
    # Rounded to 1/256 m, so that the extent and half of it are exact in the single precision of the engine's Rect2.
    post_x, post_z = round(per_lon * dx * 256) / 256, round(per_lat * dy * 256) / 256
    description = {
        "source": f"matplotlib {SOURCE}; SRTM elevations, public domain",
        "samples": "jacksboro.r16",
        "columns": columns,
        "rows": rows,
        "post_meters_x": post_x,
        "post_meters_z": post_z,
        "size_x": post_x * (columns - 1),
        "size_z": post_z * (rows - 1),
        "min_height": float(low),
        "max_height": low + 0xFFFF / STEPS_PER_METER,
        "lowest": float(low),
        "highest": float(high),
    }
    return samples.astype("<u2").tobytes(), description


def main() -> None:
    """Reads the arguments, writes both files and prints their sizes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent)
    parser.add_argument("--source", type=pathlib.Path)
    arguments = parser.parse_args()
    samples, description = convert(arguments.source or find_source())
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "jacksboro.r16").write_bytes(samples)
    text = json.dumps(description, indent="\t") + "\n"
    (arguments.out / "jacksboro.json").write_text(text, encoding="utf-8", newline="\n")
    print(f"{len(samples)} bytes, {description['size_x']} m x {description['size_z']} m -> {arguments.out}")


if __name__ == "__main__":
    main()
