"""Tests the Python package, which is built with one command and installed offline into a new environment. Its digests must
equal the digests of the core. Other threads must run during calls, calls can be
canceled, and invalid arguments are rejected."""

from __future__ import annotations

import inspect
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from conftest import REPO, WHEEL_VENV, run
from golden.cases import DOMAINS, SETS
from scipy.spatial import cKDTree

PAGE = (REPO / "python/README.md").read_text(encoding="utf-8")


def script(wheel_python: Path, text: str, timeout: float = 120) -> subprocess.CompletedProcess[str]:
    return run([wheel_python, "-c", text], timeout, cwd=WHEEL_VENV)


def test_wheel(wheel):
    """Checks the file name of the wheel. From Python 3.12 on, one wheel works with all later versions."""
    tag = "cp312-abi3" if sys.version_info >= (3, 12) else "cp3{0}-cp3{0}".format(sys.version_info.minor)
    assert f"-{tag}-" in wheel.name
    plugin = (REPO / "demo_project/addons/thicket/plugin.cfg").read_text(encoding="utf-8")
    version = re.search(r'^version="([^"]+)"', plugin, re.MULTILINE)
    assert wheel.name.startswith(f"poissontiles-{version.group(1)}-")
    repository = re.search(r'^repository="([^"]+)"', plugin, re.MULTILINE).group(1)
    with ZipFile(wheel) as files:
        (metadata,) = (files.read(name).decode() for name in files.namelist() if name.endswith(".dist-info/METADATA"))
    assert f"Project-URL: Repository, {repository}\n" in metadata


@pytest.mark.parametrize("example", re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
def test_examples_of_the_page_run(wheel_python, example):
    result = script(wheel_python, example)
    assert result.returncode == 0 and not result.stderr and re.search(r"\d", result.stdout), result.stdout + result.stderr


def test_example_of_the_documentation_runs(wheel_python):
    (example,) = re.findall(r"^```python\n(.*?)^```", (REPO / "docs/howto/python.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    result = script(wheel_python, example)
    assert result.returncode == 0 and re.search(r"^\d{4} points", result.stdout), result.stdout + result.stderr


@pytest.mark.parametrize("one", SETS, ids=lambda one: one.name)
def test_sets(poissontiles, one):
    points = poissontiles.sample(one.rect, one.radius, one.seed, levels=one.levels, layer=one.layer)
    assert points.digest() == one.digests
    count = len(points)
    assert count > 100 and points.positions.shape == (count, 2) and points.positions.dtype == np.float64
    for array, dtype in ((points.ids, np.uint64), (points.ranks, np.uint32), (points.levels, np.uint32)):
        assert array.shape == (count,) and array.dtype == dtype
    assert (points.positions >= one.rect[:2]).all() and (points.positions < one.rect[2:]).all()
    assert len(np.unique(points.ids)) == count and (points.ids >> np.uint64(48) == one.layer).all()
    # Small rectangles may contain no points of the coarsest levels, which are too far apart.
    assert set(range(min(one.levels, 4))) <= set(points.levels) <= set(range(one.levels))
    assert (np.diff(points.levels[np.argsort(points.ranks)].astype(int)) <= 0).all(), "coarse levels come first"


def test_no_two_points_are_too_close(poissontiles):
    positions = poissontiles.sample((-1e6, 5e5, -1e6 + 60, 5e5 + 40), 1.0, 3, levels=3).positions
    distances = np.hypot(*(positions[:, None] - positions[None, :]).transpose(2, 0, 1))
    assert distances[~np.eye(len(positions), dtype=bool)].min() >= 1.0


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("one", DOMAINS, ids=lambda one: one.name)
def test_domains(poissontiles, one, precision):
    positions = poissontiles.sample_domain(
        one.size, one.radius, one.seed, method=one.method, toroidal=one.toroidal, precision=precision, cell_size=one.cell_size
    )
    assert poissontiles.domain_digest(positions) == one.digest(precision)
    assert positions.dtype == {"single": np.float32, "double": np.float64}[precision]
    assert positions.ndim == 2 and positions.shape[1] == 2 and positions.flags.c_contiguous
    assert (positions >= 0).all() and (positions < one.size).all()


def ball(radius: float, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns the vertices and faces of a sphere around the origin. The faces are counterclockwise when seen from outside."""
    down, around = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False), indexing="ij")
    vertices = radius * np.stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)], axis=-1).reshape(-1, 3)
    row, column = np.divmod(np.arange(rings * 2 * rings), 2 * rings)
    corners = [(row + step) * 2 * rings + (column + right) % (2 * rings) for step, right in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return vertices, np.concatenate([np.stack(corners[:3], axis=1), np.stack([corners[0], corners[2], corners[3]], axis=1)])


def on_faces(vertices: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
    """Returns random positions on triangles, uniformly distributed by area."""
    random = np.random.default_rng(5)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[random.choice(len(faces), count, p=area / area.sum())]
    u, v = random.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return chosen[:, 0] + u * (chosen[:, 1] - chosen[:, 0]) + v * (chosen[:, 2] - chosen[:, 0])


def test_points_on_a_surface(poissontiles):
    """Checks that no two points are too close, that no other point would fit, and that each point lies on its face."""
    vertices, faces = ball(12.0, 24)
    points = poissontiles.sample_surface(vertices, faces, 1.0, 3, layer=7)
    count = len(points)
    tree = cKDTree(points.positions)
    assert tree.query(points.positions, k=2)[0][:, 1].min() >= 1.0 - 1e-6
    assert tree.query(on_faces(vertices, faces, 100_000))[0].max() <= 1.0 + 1e-4
    assert 0.52 < count * np.pi / 4 / (4 * np.pi * 12.0**2) < 0.58, "the fraction that disks of half the radius cover"
    assert len(np.unique(points.ids)) == count and (points.ids >> np.uint64(48) == 7).all()
    corners = vertices[faces[points.faces]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.abs(points.normals - normals / np.linalg.norm(normals, axis=1, keepdims=True)).max() < 1e-9
    assert np.abs(((points.positions - corners[:, 0]) * points.normals).sum(axis=1)).max() < 2e-6
    assert ((points.positions * points.normals).sum(axis=1) > 11.0).all(), "normals point outward"


def test_windows_of_a_surface_fit_together(poissontiles):
    vertices, faces = ball(12.0, 24)
    full_sample = poissontiles.sample_surface(vertices, faces, 1.0, 3, levels=3)
    assert set(full_sample.levels) == {0, 1, 2} and (np.diff(full_sample.levels[np.argsort(full_sample.ranks)].astype(int)) <= 0).all()
    halves = [
        poissontiles.sample_surface(vertices.astype(np.float64), faces.astype(kind), 1.0, 3, levels=3, window=window)
        for kind, window in ((np.int32, (-50, -50, -50, 2.5, 50, 50)), (np.uint32, np.array([2.5, -50, -50, 50, 50, 50])))
    ]
    assert all(len(half) > 100 for half in halves) and len(halves[0]) + len(halves[1]) == len(full_sample)
    positions_by_id = {point_id: position.tobytes() for half in halves for point_id, position in zip(half.ids, half.positions, strict=True)}
    assert positions_by_id == {point_id: position.tobytes() for point_id, position in zip(full_sample.ids, full_sample.positions, strict=True)}


def test_points_on_a_surface_without_faces(poissontiles):
    points = poissontiles.sample_surface(np.zeros((3, 3)), np.zeros((0, 3), int), 1.0)
    assert len(points) == 0 and points.positions.shape == points.normals.shape == (0, 3)


def test_arrays_are_contiguous_and_read_only(poissontiles):
    """Checks that each array has memory of its own, so that keeping one does not keep the others."""
    points = poissontiles.sample((0, 0, 300, 300), 1.0)
    surface = poissontiles.sample_surface(*ball(5.0, 9), 1.0)
    domain = poissontiles.sample_domain((300, 300), 1.0)
    arrays = [points.positions, points.ids, points.ranks, points.levels, domain]
    arrays += [surface.positions, surface.normals, surface.ids, surface.ranks, surface.levels, surface.faces]
    for array in arrays:
        assert array.flags.c_contiguous and not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    tails = [array[-5:] for array in arrays]
    copied = [array.copy() for array in tails]
    del points, surface, domain, arrays
    other_sets = [poissontiles.sample((0, 0, 300, 300), 1.0, seed) for seed in range(1, 4)]
    assert all((one == other).all() for one, other in zip(tails, copied, strict=True)) and all(map(len, other_sets))


def test_points_behave_like_numpy_arrays(poissontiles):
    for points in (poissontiles.sample((0, 0, 30, 20), 1.0, 3, levels=3), poissontiles.sample_surface(*ball(5.0, 9), 1.0)):
        assert np.asarray(points) is points.positions and len(points) > 100
        assert np.array(points, dtype=np.float32).dtype == np.float32 and np.array(points).flags.writeable
        assert (np.stack(list(points)) == points.positions).all()
        assert (points[3] == points.positions[3]).all() and (points[np.int64(-1)] == points.positions[-1]).all()
        coarse = points[points.ranks < 2**31]
        assert type(coarse) is type(points) and 0 < len(coarse) < len(points)
        assert (coarse.ids == points.ids[points.ranks < 2**31]).all() and coarse.seed == points.seed
        for subset in (points[10:20], points[list(range(10, 20))], points[np.arange(10, 20)]):
            assert (subset.ids == points.ids[10:20]).all() and (subset.positions == points.positions[10:20]).all()
        assert len(points[:0]) == 0
        for wrong in ((1, 0), np.zeros((2, 2), int), None, "ids"):
            with pytest.raises(IndexError):
                points[wrong]
        with pytest.raises(IndexError):
            points[len(points)]
        unpickled = pickle.loads(pickle.dumps(points))
        assert type(unpickled) is type(points) and unpickled.seed == points.seed and not unpickled.positions.flags.writeable
        assert (unpickled.ids == points.ids).all() and (unpickled.positions == points.positions).all()


def test_first_points(poissontiles):
    rect, points = (0, 0, 40, 30), poissontiles.sample((0, 0, 40, 30), 1.0, 3, levels=5)
    first = poissontiles.sample(rect, 1.0, 3, levels=5, n=100)
    assert len(first) == 100 and first.ranks.max() == np.sort(points.ranks)[99] and set(first.ids) < set(points.ids)
    assert cKDTree(first.positions).query(first.positions, k=2)[0][:, 1].min() > 1.3, "they are well spaced"
    assert len(points.first(0)) == 0 and (points.first(len(points)).ids == points.ids).all()
    for wrong in (-1, len(points) + 1):
        with pytest.raises(ValueError, match=f"^count must be between 0 and {len(points)}, the number of points, got {wrong}$"):
            points.first(wrong)


def test_thinned_points(poissontiles):
    """Checks that a density selects points by their ranks, so that tiles fit together."""
    def density(positions):
        return np.clip(positions[:, 0] / 60, 0, 1)

    rect, points = (0, 0, 60, 60), poissontiles.sample((0, 0, 60, 60), 1.0, 3, levels=4)
    thinned = points.thin(density)
    assert (thinned.ids == points.ids[points.ranks / 2**32 < density(points.positions)]).all()
    assert abs(len(thinned) / len(points) - 0.5) < 0.03
    halves = [poissontiles.sample(half, 1.0, 3, levels=4).thin(density) for half in ((0, 0, 23, 60), (23, 0, 60, 60))]
    assert set(halves[0].ids) | set(halves[1].ids) == set(thinned.ids)
    assert len(points.thin(0.0)) == 0 and len(points.thin(1)) == len(points)
    assert len(points.thin(points.levels > 0)) == (points.levels > 0).sum()
    assert len(poissontiles.sample_surface(*ball(5.0, 9), 1.0).thin(lambda positions: positions[:, 2] > 0)) > 50
    for wrong, message in ((1.5, "density must be between 0 and 1, got 1.5"), (np.nan, "got nan"), ([0.5, 0.5], r"density must be a number, or have shape \(")):
        with pytest.raises(ValueError, match=message):
            points.thin(wrong)
    assert len(poissontiles.sample(rect, 1.0, 3, n=5)) == 5


def test_points_pass_between_processes(wheel_python):
    text = """
from concurrent.futures import ProcessPoolExecutor
from functools import partial
import multiprocessing, poissontiles
tiles = [(x, 0, x + 20, 20) for x in (0, 20, 40)]
with ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
    parts = list(pool.map(partial(poissontiles.sample, radius=1.0, seed=5), tiles))
print(sum(map(len, parts)) == len(poissontiles.sample((0, 0, 60, 20), 1.0, 5)))
"""
    completed = script(wheel_python, text)
    assert completed.stdout == "True\n", completed.stdout + completed.stderr


def test_memory_is_freed(wheel_python):
    """Checks that memory is freed. A set and a domain take 4.5 MB, and twelve more of each must increase the peak by
    less than 10 MB."""
    text = """
import resource, poissontiles
def work(count):
    for seed in range(count):
        poissontiles.sample((0, 0, 370, 370), 1.0, seed).ids
        poissontiles.sample_domain((370, 370), 1.0, seed)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(work(3) + 10_000 > work(15))
"""
    completed = script(wheel_python, text)
    assert completed.stdout == "True\n", completed.stdout + completed.stderr


def test_an_empty_rectangle_has_no_points(poissontiles):
    points = poissontiles.sample((5, 5, 5, 9), 1.0)
    assert len(points) == 0 and points.positions.shape == (0, 2) and points.ids.shape == points.ranks.shape == (0,)


def test_seeds_are_any_64_bits(poissontiles):
    def ids(seed):
        return poissontiles.sample((0, 0, 9, 9), 1.0, seed).digest()

    assert ids(-1) == ids(2**64 - 1) == ids(np.int64(-1)) and ids(-(2**63)) == ids(2**63) and ids(0) != ids(1)
    for wrong in (2**64, -(2**63) - 1):
        with pytest.raises(ValueError, match=f"^seed must have 64 bits, got {wrong}$"):
            poissontiles.sample((0, 0, 9, 9), 1.0, wrong)


def test_seeds_of_numpy(poissontiles):
    """Checks the seeds that NumPy's generators provide, and that None chooses a new seed, which can be used again."""
    rect = (0, 0, 9, 9)
    by_generator = [poissontiles.sample(rect, 1.0, np.random.default_rng(4)) for _ in range(2)]
    assert by_generator[0].digest() == by_generator[1].digest()
    assert by_generator[0].digest() == poissontiles.sample(rect, 1.0, np.random.PCG64(4)).digest()
    generator = np.random.default_rng(4)
    assert poissontiles.sample(rect, 1.0, generator).digest() != poissontiles.sample(rect, 1.0, generator).digest()
    sequence = np.random.SeedSequence(4)
    assert poissontiles.sample(rect, 1.0, sequence).seed == poissontiles.sample(rect, 1.0, sequence).seed
    samples = [poissontiles.sample(rect, 1.0, None) for _ in range(2)]
    assert samples[0].seed != samples[1].seed and 0 <= samples[0].seed < 2**64
    assert poissontiles.sample(rect, 1.0, samples[0].seed).digest() == samples[0].digest()


REFUSED = [
    ("sample", {"radius": -1.0}, ValueError, "radius must be positive, got -1"),
    ("sample", {"radius": float("nan")}, ValueError, "radius must be finite, got nan"),
    ("sample", {"rect": (0, 0, float("inf"), 1)}, ValueError, "rect must be finite, got inf"),
    ("sample", {"rect": (0, 0, 1, -2)}, ValueError, "rect has its end before its start, got -2"),
    ("sample", {"rect": (0, 0, 1e9, 1)}, ValueError, "rect must be between -5931641.6 and 5931641.6, got 1000000000"),
    ("sample", {"rect": (0, 0, 1e5, 1e5)}, ValueError, "rect requires too many points, got 69"),
    ("sample", {"rect": (0, 0, 1)}, TypeError, "rect must be four numbers, (min_x, min_y, max_x, max_y), got (0, 0, 1)"),
    ("sample", {"rect": "wide"}, TypeError, "rect must be four numbers, (min_x, min_y, max_x, max_y), got 'wide'"),
    ("sample", {"levels": 0}, ValueError, "levels must be between 1 and 8, got 0"),
    ("sample", {"levels": 9}, ValueError, "levels must be between 1 and 8, got 9"),
    ("sample", {"layer": 65536}, ValueError, "layer must be between 0 and 65535, got 65536"),
    ("sample", {"threads": -1}, ValueError, "threads must be between 0 and "),
    ("sample", {"n": 10**6}, ValueError, "count must be between 0 and "),
    ("sample_domain", {"size": (0, 1)}, ValueError, "size must be positive, got 0"),
    ("sample_domain", {"size": (3, 9), "toroidal": True}, ValueError, "size is out of range, got 3; a toroidal domain measures at least 4 radii"),
    ("sample_domain", {"size": (2e5, 9), "precision": "single"}, ValueError, "size is out of range, got 200000; in single precision"),
    ("sample_domain", {"size": (1e6, 1e6)}, ValueError, "size requires too many points, got "),
    ("sample_domain", {"size": [1, 2, 3]}, TypeError, "size must be two numbers, (width, height), got [1, 2, 3]"),
    ("sample_domain", {"method": "best"}, ValueError, "method must be one of 'naive', 'hierarchical', 'accumulator', 'wavefront', 'tiles', got 'best'"),
    ("sample_domain", {"precision": "half"}, ValueError, "precision must be 'single' or 'double', got 'half'"),
    ("sample_domain", {"cell_size": -1.0}, ValueError, "cell_size must be between 0 and 1000, got -1"),
    ("sample_domain", {"darts_each": 0.0}, ValueError, "darts_each must be between 1 and 1000000, got 0"),
    ("sample_surface", {"radius": 0.0}, ValueError, "radius must be positive, got 0"),
    ("sample_surface", {"levels": 9}, ValueError, "levels must be between 1 and 8, got 9"),
    ("sample_surface", {"faces": np.array([[0, 1, 3]])}, ValueError, "faces must have indices of vertices, 0 to 2, got 3"),
    ("sample_surface", {"faces": np.array([[0, 1, -1]])}, ValueError, "faces must have indices of vertices, 0 to 2, got -1"),
    ("sample_surface", {"vertices": np.array([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]])}, ValueError, "vertices must be finite, got nan"),
    ("sample_surface", {"window": (0, 0, 0)}, TypeError, "window must be six numbers, (min_x, min_y, min_z, max_x, max_y, max_z), got (0, 0, 0)"),
    ("sample_surface", {"window": (0, 0, 0, 1, -1, 1)}, ValueError, "window has its end before its start, got -1"),
    ("sample", {"levels": 10**30}, ValueError, "levels must be between 1 and 8, got "),
    ("sample", {"levels": 1.5}, TypeError, "levels must be an integer, got 1.5"),
    ("sample", {"radius": "1"}, TypeError, "radius must be a number, got '1'"),
    ("sample", {"seed": 1.5}, TypeError, "seed must be an integer, None, or a NumPy Generator, BitGenerator or SeedSequence, got 1.5"),
    ("sample", {"progress": 3}, TypeError, "progress must be callable or None, got 3"),
    ("sample", {"cancel": True}, TypeError, "cancel must be a Cancel or None, got True"),
    ("sample_domain", {"method": 2}, TypeError, "method must be a string, got 2"),
    ("sample_surface", {"vertices": np.zeros((3, 2))}, TypeError, "vertices must be an array of numbers of shape (n, 3), got float64 of shape (3, 2)"),
    ("sample_surface", {"faces": np.zeros((1, 3))}, TypeError, "faces must be an array of integers of shape (n, 3), got float64 of shape (1, 3)"),
]
GOOD = {
    "sample": {"rect": (0, 0, 9, 9)},
    "sample_domain": {"size": (9, 9)},
    "sample_surface": {"vertices": np.eye(3), "faces": np.array([[0, 1, 2]])},
}


@pytest.mark.parametrize(("name", "wrong", "error", "sentence"), REFUSED)
def test_arguments_that_the_core_rejects_raise(poissontiles, name, wrong, error, sentence):
    with pytest.raises(error) as raised:
        getattr(poissontiles, name)(**{"radius": 1.0, **GOOD[name], **wrong})
    assert str(raised.value).startswith(sentence)


def test_arrays_without_a_digest_raise(poissontiles):
    for wrong in (np.zeros((4, 3)), np.zeros((4, 2), int), np.zeros((2, 4)).T, [[1.0, 2.0]]):
        with pytest.raises(TypeError):
            poissontiles.domain_digest(wrong)


def test_lack_of_memory_raises(wheel_python):
    text = """
import resource, poissontiles
resource.setrlimit(resource.RLIMIT_AS, (600_000_000, 600_000_000))
for work in (lambda: poissontiles.sample((0, 0, 8000, 8000), 1.0), lambda: poissontiles.sample_domain((8000, 8000), 1.0)):
    try:
        work()
    except MemoryError as error:
        print(error)
print(len(poissontiles.sample((0, 0, 9, 9), 1.0)) > 40)
"""
    completed = script(wheel_python, text)
    assert re.fullmatch(r"rect needs more memory than is available, got .+\nsize needs more memory than is available, got 8000\. .+\nTrue\n", completed.stdout), (
        completed.stdout + completed.stderr
    )


# Calls to each function that take one or two seconds.
LONG = {
    "sample": lambda poissontiles, **watched: poissontiles.sample((0, 0, 2500, 2500), 1.0, **watched),
    "sample by threads": lambda poissontiles, **watched: poissontiles.sample((0, 0, 4000, 2500), 1.0, threads=3, **watched),
    "sample_domain": lambda poissontiles, **watched: poissontiles.sample_domain((1500, 1500), 1.0, **watched),
    "sample_surface": lambda poissontiles, **watched: poissontiles.sample_surface(*ball(80.0, 99), 1.0, **watched),
}


@pytest.mark.parametrize("work", LONG.values(), ids=LONG)
def test_other_threads_run_during_a_call(poissontiles, work):
    """Checks that another thread keeps running during a call. It could not run if the call held the global interpreter lock."""
    ticks: list[float] = []
    end = threading.Event()

    def tick():
        while not end.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.perf_counter()
    work(poissontiles)
    took = time.perf_counter() - start
    end.set()
    ticker.join()
    middle = [each for each in ticks if start + 0.1 * took < each < start + 0.9 * took]
    assert len(middle) > 20, f"{len(middle)} ticks in a call of {took} s"


@pytest.mark.parametrize("work", LONG.values(), ids=LONG)
def test_progress(poissontiles, work):
    seen: list[tuple[float, int, int]] = []
    sample_set = work(poissontiles, progress=lambda fraction, points: seen.append((fraction, points, threading.get_ident())))
    assert len(seen) > 5 and seen == sorted(seen) and seen[0][0] < 0.5
    assert seen[-1][:2] == (1.0, len(sample_set)) and {each[2] for each in seen} == {threading.get_ident()}


@pytest.mark.parametrize("work", LONG.values(), ids=LONG)
def test_cancel(poissontiles, work):
    """Checks that a call can be canceled from another thread and before it begins. An exception of the progress
    function must end the call and propagate."""
    cancel, begun = poissontiles.Cancel(), threading.Event()
    canceller = threading.Thread(target=lambda: (begun.wait(), cancel.cancel()))
    canceller.start()
    with pytest.raises(poissontiles.Cancelled, match="was cancelled"):
        work(poissontiles, cancel=cancel, progress=lambda fraction, points: begun.set())
    canceller.join()
    assert cancel.cancelled
    start = time.perf_counter()
    with pytest.raises(poissontiles.Cancelled):
        work(poissontiles, cancel=cancel)
    assert time.perf_counter() - start < 0.2, "a call with a canceled object ends immediately"
    calls: list[float] = []

    def stop(fraction: float, points: int) -> None:
        calls.append(fraction)
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        work(poissontiles, progress=stop)
    assert len(calls) == 1
    assert poissontiles.sample(SETS[0].rect, 1.0, 1).digest() == SETS[0].digests, "later calls are not affected"


def test_a_progress_function_may_sample(poissontiles):
    inside: list = []
    LONG["sample"](poissontiles, progress=lambda fraction, points: inside.append(poissontiles.sample(SETS[0].rect, 1.0, 1).digest()))
    assert set(inside) == {SETS[0].digests}


def test_threads_agree(poissontiles):
    digests: list = []
    threads = [threading.Thread(target=lambda: digests.extend(poissontiles.sample(SETS[0].rect, 1.0, 1).digest() for _ in range(5))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert digests == [SETS[0].digests] * 20


def test_a_call_with_several_threads_returns_the_same_points(poissontiles):
    for one in SETS:
        alone = poissontiles.sample(one.rect, one.radius, one.seed, levels=one.levels, layer=one.layer)
        for threads in (0, 2, 5):
            shared = poissontiles.sample(one.rect, one.radius, one.seed, levels=one.levels, layer=one.layer, threads=threads)
            assert shared.digest() == one.digests and (shared.ids == alone.ids).all()


def test_control_c_ends_a_call(wheel_python):
    # Sets the handler explicitly, because a program that a shell starts with & ignores SIGINT.
    text = "import signal, poissontiles\nsignal.signal(signal.SIGINT, signal.default_int_handler)\ntry:\n    print('begun', flush=True)\n    poissontiles.sample((0, 0, 5000, 5000), 1.0)\nexcept KeyboardInterrupt:\n    print('ended')"
    process = subprocess.Popen([wheel_python, "-c", text], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20)[0] == "ended\n"


def test_types_and_docstrings(poissontiles):
    """Checks that every public name has a docstring, that the docstrings of functions describe all arguments, units and errors, and that all
    arguments and results have types."""
    folder = Path(poissontiles.__file__).parent
    assert all((folder / name).is_file() for name in ("py.typed", "_core.pyi", "LICENSE", "licenses/highway", "licenses/nanobind"))
    for name in poissontiles.__all__:
        assert len(inspect.getdoc(getattr(poissontiles, name))) > 20, name
    for name in ("sample", "sample_domain", "sample_surface", "domain_digest"):
        words = inspect.getdoc(getattr(poissontiles, name))
        signature = inspect.signature(getattr(poissontiles, name))
        for argument in signature.parameters.values():
            assert argument.annotation is not argument.empty and re.search(rf"^ +(\w+, )*{argument.name}[:,]", words, re.MULTILINE), argument
        assert signature.return_annotation is not signature.empty and "TypeError:" in words
        if name != "domain_digest":
            assert "meters" in words and all(f"{error}:" in words for error in ("ValueError", "MemoryError", "Cancelled"))
    for points in (poissontiles.Points, poissontiles.SurfacePoints):
        words = inspect.getdoc(points)
        assert all(f"    {field}: " in words for field in points.__dataclass_fields__)


@pytest.mark.full
def test_the_package_is_typed(wheel_python, tmp_path):
    """Checks the package with mypy in strict mode."""
    venv = tmp_path / "venv"
    for command in (
        [sys.executable, "-m", "venv", venv],
        [venv / "bin/python", "-m", "pip", "install", "--quiet", "mypy==1.18.2"],
    ):
        result = run(command, timeout=300)
        assert result.returncode == 0, result.stdout + result.stderr
    command = [venv / "bin/python", "-m", "mypy", "--strict", "--no-incremental", "--python-executable", wheel_python, "-p", "poissontiles"]
    result = run(command, 300, cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
