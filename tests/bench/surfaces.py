"""Compares poissontiles.sample_surface with the samplers of other packages for evenly spaced points on a triangle mesh:
speed on one core, and quality of the sets. Prints the rows of a Markdown table. surfaces.sh installs the packages.

    bash tests/bench/surfaces.sh [points = 20000] [rounds = 3]

All samplers get the same mesh with triangles of 1 to 4 m, and a radius of 1 m. trimesh.sample.sample_surface_even
generates random points and removes those that are too close to another one. Open3D's sample_points_poisson_disk
generates five times as many points as requested and eliminates the most crowded ones (Yuksel 2015). It takes a number
of points instead of a radius, so its distances are a result. Both get the number of points that poissontiles returned.

The columns are:

- the number of points;
- thousand points per second of CPU time, the median of the rounds;
- the minimum distance between two points, in radii;
- the largest distance from a random position on the surface to the nearest point, in radii, which is at most 1 for a maximal set;
- the fraction of the surface that disks of half a radius cover (0.547 for random sequential addition on a plane)."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
import open3d
import poissontiles
import trimesh
from scipy.spatial import cKDTree

COVERAGE = 0.547


def sphere(points: int) -> trimesh.Trimesh:
    """Returns a sphere on which about this many points of radius 1 fit, with edges of about 2 m."""
    radius = float(np.sqrt(points / COVERAGE / 16.0))
    faces = 4 * np.pi * radius**2 / 2.0
    return trimesh.creation.icosphere(subdivisions=max(1, round(np.log(faces / 20) / np.log(4))), radius=radius)


def hills(points: int) -> trimesh.Trimesh:
    """Returns a square of hills with slopes of up to 60 degrees and triangles of 2 m."""
    side = float(np.sqrt(points / COVERAGE * np.pi / 4 / 1.35))
    count = int(side / 2.0) + 1
    x, y = np.meshgrid(np.linspace(0, side, count), np.linspace(0, side, count), indexing="ij")
    vertices = np.stack([x, y, 8.0 * np.sin(x / 6.5) * np.cos(y / 6.5)], axis=-1).reshape(-1, 3)
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate([np.stack([first, first + count, first + count + 1], 1), np.stack([first, first + count + 1, first + 1], 1)])
    return trimesh.Trimesh(vertices, faces, process=False)


def by_poissontiles(mesh: trimesh.Trimesh, count: int, seed: int) -> np.ndarray:
    return poissontiles.sample_surface(mesh.vertices, mesh.faces, 1.0, seed).positions


def by_trimesh(mesh: trimesh.Trimesh, count: int, seed: int) -> np.ndarray:
    return trimesh.sample.sample_surface_even(mesh, count, radius=1.0, seed=seed)[0]


def by_open3d(mesh: trimesh.Trimesh, count: int, seed: int) -> np.ndarray:
    open3d.utility.random.seed(seed)
    open3d_mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(mesh.vertices), open3d.utility.Vector3iVector(mesh.faces))
    return np.asarray(open3d_mesh.sample_points_poisson_disk(count, init_factor=5).points)


def row(name: str, sample: Callable[..., np.ndarray], mesh: trimesh.Trimesh, count: int, rounds: int) -> str:
    speeds = []
    for seed in range(rounds):
        start = time.process_time()
        positions = sample(mesh, count, seed)
        speeds.append(len(positions) / (time.process_time() - start) / 1e3)
    tree = cKDTree(positions)
    nearest = tree.query(positions, k=2)[0][:, 1].min()
    gap = tree.query(trimesh.sample.sample_surface(mesh, 200_000, seed=1)[0])[0].max()
    covered_fraction = len(positions) * np.pi / 4 / mesh.area
    return f"| {name} | {len(positions)} | {statistics.median(speeds):.1f} | {nearest:.3f} | {gap:.3f} | {covered_fraction:.4f} |"


def main(arguments: list[str]) -> None:
    points = int(arguments[0]) if arguments else 20_000
    rounds = int(arguments[1]) if len(arguments) > 1 else 3
    print("| What | Points | Thousand points/s | Least distance | Largest gap | Coverage |\n|---|---|---|---|---|---|")
    for label, mesh in (("sphere", sphere(points)), ("hills", hills(points))):
        count = len(by_poissontiles(mesh, 0, 0))
        for name, sample in (("poissontiles", by_poissontiles), ("trimesh", by_trimesh), ("Open3D", by_open3d)):
            print(row(f"{label}, {len(mesh.faces)} triangles: {name}", sample, mesh, count, rounds), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
