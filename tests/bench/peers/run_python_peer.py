"""Times one sampler of the Python packages with which the benchmarks compare. Generates one set and prints a JSON line.

    python tests/bench/peers/run_python_peer.py NAME POINTS SEED [dump=FILE]

NAME is hdt_sampling or scipy_poisson_disk. The radius is 1. The domain is a bounded square whose area times the density
of jammed disks is POINTS, as in tests/bench/domain_run.cpp. dump=FILE writes the set as domain_run does: its count
(uint64) and its coordinates (float64 x, y), little-endian. The line has the keys

    method, points, seconds, size, maximal_claimed, toroidal, precision, version

`seconds` is the CPU time of this process for creating and calling the sampler, after a call for a small set. `points`
counts all returned points, and `size` is the width of the square. Needs the packages in
tests/bench/peers/requirements.txt.

Behavior of the packages, read from their sources and measured with the versions pinned there:

hdt_sampling 0.2.0: hierarchical dart throwing (White, Cline, Egbert 2007) in Rust, double precision, one thread. The
radius is the minimum distance between points, and the domain is bounded. Its base squares are r / sqrt(2) wide and do
not divide the domain evenly. Therefore, a strip of up to that width beyond the right and upper edges also gets points: under 1
% of them for 10^4 points. The call returns a list of tuples, whose creation is part of its time. It claims maximal
sets. It stops when a running sum of areas, which accumulates rounding errors, is used up or no longer matches the
squares. In 7 sets of 10^4 to 10^6 points, one gap of a millionth of the radius remained. Distances are correct.

scipy.stats.qmc.PoissonDisk 1.17.1: Bridson (2007) in Python and NumPy, one thread. Candidates are in the whole disk of
two radii around a point (its defaults: "volume", 30 candidates), and each point is tried once. The radius is the
minimum distance between points, and the domain is bounded. `fill_space` neither claims nor produces maximal sets:
coverage 0.47, gaps of 1.29 radii. The grid of earlier points is in single precision, so distances are correct up to
that rounding. It is a hundred to a thousand times as slow as compiled code, so sets above 10^5 points take hours.
"""

from __future__ import annotations

import importlib.metadata
import json
import math
import sys
import time
from collections.abc import Callable

import numpy

# Points per unit of area at which randomly thrown disks of diameter 1 jam: coverage 0.547070.
JAMMED_DENSITY = 0.547070 * 4 / math.pi

WARM_UP_POINTS = 1000


def hdt_sampling(side: float, seed: int) -> object:
    from hdt_sampling import HDTSampler

    return HDTSampler(side, side, 1.0, seed).generate()


def scipy_poisson_disk(side: float, seed: int) -> object:
    from scipy.stats import qmc

    rng = numpy.random.default_rng(seed)
    return qmc.PoissonDisk(2, radius=1.0, rng=rng, l_bounds=[0.0, 0.0], u_bounds=[side, side]).fill_space()


# The function of each sampler, its package, and whether it claims maximal sets.
PEERS: dict[str, tuple[Callable[[float, int], object], str, bool]] = {
    "hdt_sampling": (hdt_sampling, "hdt_sampling", True),
    "scipy_poisson_disk": (scipy_poisson_disk, "scipy", False),
}


def side_for(points: float) -> float:
    return math.sqrt(points / JAMMED_DENSITY)


def main(arguments: list[str]) -> int:
    if len(arguments) not in (3, 4) or arguments[0] not in PEERS:
        print(f"usage: run_python_peer.py {'|'.join(PEERS)} POINTS SEED [dump=FILE]", file=sys.stderr)
        return 2
    name, points, seed = arguments[0], float(arguments[1]), int(arguments[2])
    sample, package, maximal = PEERS[name]
    sample(side_for(WARM_UP_POINTS), seed)
    start = time.process_time()
    sample_points = sample(side_for(points), seed)
    seconds = time.process_time() - start
    positions = numpy.asarray(sample_points, dtype="<f8").reshape(-1, 2)
    for option in arguments[3:]:
        with open(option.removeprefix("dump="), "wb") as file:
            file.write(len(positions).to_bytes(8, "little"))
            file.write(positions.tobytes())
    line = {
        "method": name,
        "points": len(positions),
        "seconds": seconds,
        "size": side_for(points),
        "maximal_claimed": maximal,
        "toroidal": False,
        "precision": "double",
        "version": importlib.metadata.version(package),
    }
    print(json.dumps(line))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
