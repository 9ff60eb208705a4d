"""Tests the C library with a C11 program that prints points. Checks the guarantees of extension/core/c_api/thicket.h by calling
the shared library from Python."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import CACHE, REPO, run
from golden.cases import DOMAINS, SETS

HEADER = REPO / "extension/core/c_api/thicket.h"
STRICT = ["-Wall", "-Wextra", "-Werror", "-pedantic"]
CODES = dict(re.findall(r"^\tTHICKET_(\w+) = (\d+)", HEADER.read_text(encoding="utf-8"), re.MULTILINE))
METHODS = ["naive", "hierarchical", "accumulator", "wavefront"]
PROGRESS = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_uint64)
U64 = ctypes.c_uint64


class Set(ctypes.Structure):
    _fields_ = [("seed", U64), ("radius", ctypes.c_double), ("levels", ctypes.c_uint32), ("layer", ctypes.c_uint16)]


class Rect(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("min_x", "min_y", "max_x", "max_y")]


class Point(ctypes.Structure):
    _fields_ = [("x", ctypes.c_double), ("y", ctypes.c_double), ("id", U64), ("rank", ctypes.c_uint32), ("level", ctypes.c_uint32)]


class Domain(ctypes.Structure):
    _fields_ = [
        *((name, ctypes.c_double) for name in ("size_x", "size_y", "radius", "cell_size", "darts_each")),
        ("seed", U64),
        *((name, ctypes.c_int32) for name in ("method", "toroidal", "single_precision")),
    ]


class Watch(ctypes.Structure):
    _fields_ = [("progress", PROGRESS), ("user", ctypes.c_void_p)]


def code(name: str) -> int:
    return int(CODES[name])


class Sampler:
    """A sampler of the library. `sample` and `fill` return the error code."""

    def __init__(self, library: ctypes.CDLL):
        self.library = library
        self.handle = ctypes.c_void_p(library.thicket_sampler_new())
        assert self.handle.value

    def sample(self, rect=(0.0, 0.0, 20.0, 20.0), watch: Watch | None = None, **names) -> int:
        new_set = Set(**{"seed": 1, "radius": 1.0, "levels": 1, **names})
        return self.library.thicket_sample(self.handle, ctypes.byref(new_set), ctypes.byref(Rect(*rect)), watch and ctypes.byref(watch), None)

    def fill(self, size=(20.0, 20.0), watch: Watch | None = None, **names) -> int:
        new_domain = Domain(*size, **{"radius": 1.0, "method": 2, **names})
        return self.library.thicket_sample_domain(self.handle, ctypes.byref(new_domain), watch and ctypes.byref(watch), None)

    def count(self) -> int:
        return self.library.thicket_count(self.handle)

    def points(self, first: int, count: int) -> tuple[int, list[tuple]]:
        room = (Point * max(count, 1))()
        status = self.library.thicket_read_points(self.handle, U64(first), U64(count), room)
        return status, [(p.x, p.y, p.id, p.rank, p.level) for p in room[:count]]

    def positions(self, first: int, count: int) -> tuple[int, list[float]]:
        room = (ctypes.c_double * max(2 * count, 1))()
        return self.library.thicket_read_positions(self.handle, U64(first), U64(count), room), list(room)[: 2 * count]

    def digest(self) -> tuple[int, int]:
        places, ranks = U64(), U64()
        assert self.library.thicket_digest(self.handle, ctypes.byref(places), ctypes.byref(ranks)) == 0
        return places.value, ranks.value

    def message(self) -> str:
        return self.library.thicket_message(self.handle).decode()

    def cancel(self) -> None:
        self.library.thicket_cancel(self.handle)


@pytest.fixture(scope="module")
def folder(build_dir: Path) -> Path:
    assert (build_dir / "c/thicket.h").is_file(), "the library is not built: scons c_library"
    return build_dir / "c"


@pytest.fixture(scope="module")
def library(folder: Path) -> ctypes.CDLL:
    loaded_library = ctypes.CDLL(str(folder / "libthicket_c.so"))
    loaded_library.thicket_sampler_new.restype = ctypes.c_void_p
    loaded_library.thicket_message.restype = ctypes.c_char_p
    loaded_library.thicket_count.restype = U64
    return loaded_library


@pytest.fixture
def sampler(library: ctypes.CDLL):
    new_sampler = Sampler(library)
    yield new_sampler
    library.thicket_sampler_free(new_sampler.handle)


@pytest.fixture(scope="module")
def program(folder: Path, tmp_path_factory) -> Path:
    made = tmp_path_factory.mktemp("c_api") / "points"
    command = ["gcc", "-std=c11", *STRICT, f"-I{folder}", REPO / "tests/c_api/points.c", folder / "libthicket_c.a", "-lstdc++", "-lm", "-o", made]
    result = run(command, timeout=120)
    assert result.returncode == 0, result.stderr
    return made


@pytest.mark.parametrize("one", SETS, ids=lambda one: one.name)
def test_a_program_in_c_prints_points(program, one):
    result = run([program, one.seed, repr(one.radius), one.levels, one.layer, *map(repr, one.rect)], timeout=60)
    assert result.returncode == 0 and not result.stderr, result.stderr
    *points, last = result.stdout.splitlines()
    assert last == "digest {:016x} ranks {:016x}".format(*one.digests)
    assert len(points) > 100
    for x, y, *_ in map(str.split, points):
        assert one.rect[0] <= float(x) < one.rect[2] and one.rect[1] <= float(y) < one.rect[3]


def test_a_program_in_c_prints_the_error(program):
    result = run([program, 1, -2.5, 1, 0, 0, 0, 9, 9], timeout=60)
    assert result.returncode != 0
    assert result.stderr == f"error {code('NOT_POSITIVE')}: radius must be positive, got -2.5\n"


def test_the_example_in_the_readme_runs(folder, tmp_path):
    (example,) = re.findall(r"^```c\n(.*?)^```", (HEADER.parent / "README.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    source, made = tmp_path / "example.c", tmp_path / "example"
    source.write_text(example)
    result = run(["gcc", "-std=c11", *STRICT, f"-I{folder}", source, folder / "libthicket_c.a", "-lstdc++", "-lm", "-o", made], timeout=120)
    assert result.returncode == 0, result.stderr
    assert re.match(r"3\d{3} points; the first at -?\d", run([made], timeout=60).stdout)


@pytest.mark.parametrize("compiler", [["gcc", "-std=c11"], ["g++", "-xc++", "-std=c++11"], ["g++", "-xc++", "-std=c++20"]], ids=" ".join)
def test_the_header_compiles_alone(compiler, tmp_path):
    unit = tmp_path / "unit.c"
    unit.write_text('#include "thicket.h"\nint main(void) { return (int)thicket_c_version() - THICKET_C_VERSION; }\n')
    result = run([*compiler, *STRICT, f"-I{HEADER.parent}", "-fsyntax-only", unit], timeout=60)
    assert result.returncode == 0, result.stderr


def test_the_library_exports_only_what_the_header_declares(folder):
    listed = run(["nm", "-D", "--defined-only", folder / "libthicket_c.so"], timeout=60)
    exported_names = {line.split()[-1].split("@")[0] for line in listed.stdout.splitlines()}
    assert exported_names == set(re.findall(r"\b(thicket_\w+)\([^)]*\) THICKET_NOEXCEPT", HEADER.read_text(encoding="utf-8"), re.DOTALL))


@pytest.fixture(scope="module")
def installed(folder: Path, tmp_path_factory) -> Path:
    """Returns a folder in which the library is installed."""
    prefix = tmp_path_factory.mktemp("c_install")
    result = run(["scons", "-Q", "c_install", f"prefix={prefix}"], timeout=600, cwd=REPO)
    assert result.returncode == 0, result.stdout + result.stderr
    return prefix


WRAPPER = """#include <thicket.hpp>

#include <cstdio>

int main() {
	thicket::Sampler sampler;
	const thicket_set set{%d, %r, %d, %d};
	const auto points = sampler.sample(set, {%r, %r, %r, %r});
	const thicket::Digest digest = sampler.digest();
	std::printf("%%zu %%016llx\\n", points.size(), static_cast<unsigned long long>(digest.places));
	thicket_domain domain{};
	domain.size_x = domain.size_y = 20.0;
	domain.radius = 1.0;
	domain.method = THICKET_HIERARCHICAL;
	std::printf("%%d\\n", sampler.sample_domain(domain).size() > 200);
	try {
		domain.radius = -1.0;
		sampler.sample_domain(domain);
	} catch (const thicket::Error &error) {
		std::printf("%%d %%s\\n", error.code(), error.what());
	}
}
"""
CMAKE = """cmake_minimum_required(VERSION 3.20)
project(example CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(thicket_c 1.0 REQUIRED)
add_executable(shared example.cpp)
target_link_libraries(shared PRIVATE thicket_c::thicket_c)
add_executable(static example.cpp)
target_link_libraries(static PRIVATE thicket_c::static)
"""


@pytest.fixture
def example(tmp_path) -> Path:
    one = SETS[0]
    (tmp_path / "example.cpp").write_text(WRAPPER % (one.seed, one.radius, one.levels, one.layer, *map(float, one.rect)))
    return tmp_path


def assert_prints_points(program: Path, **options):
    result = run([program], 60, **options)
    assert result.returncode == 0, result.stderr
    first, domain, error = result.stdout.splitlines()
    assert first.split()[1] == "{:016x}".format(SETS[0].digests[0]) and int(first.split()[0]) > 100
    assert domain == "1" and error == f"{code('NOT_POSITIVE')} radius must be positive, got -1"


@pytest.mark.skipif(shutil.which("pkg-config") is None, reason="pkg-config is not installed")
def test_pkg_config_finds_the_installed_library(installed, example):
    env = {**os.environ, "PKG_CONFIG_PATH": str(installed / "lib/pkgconfig"), "LD_LIBRARY_PATH": str(installed / "lib")}
    flags = run(["pkg-config", "--cflags", "--libs", "thicket_c"], 60, env=env).stdout.split()
    result = run(["g++", "-std=c++17", *STRICT, "example.cpp", *flags, "-o", "example"], 120, cwd=example)
    assert result.returncode == 0, result.stderr
    assert_prints_points(example / "example", env=env)
    needed = run(["objdump", "-p", example / "example"], 60).stdout
    assert re.search(r"NEEDED\s+libthicket_c\.so\.1$", needed, re.MULTILINE), "the program requests the major version"


def test_cmake_finds_the_installed_library(installed, example):
    (example / "CMakeLists.txt").write_text(CMAKE)
    cmake = next(CACHE.glob("wheel-python*/bin/cmake"))
    for arguments in (["-B", "build", f"-DCMAKE_PREFIX_PATH={installed}"], ["--build", "build"]):
        result = run([cmake, *arguments], 300, cwd=example)
        assert result.returncode == 0, result.stdout + result.stderr
    assert_prints_points(example / "build/shared")
    assert_prints_points(example / "build/static")


def test_versions_agree(library):
    version = int(re.search(r"#define THICKET_C_VERSION (\d+)", HEADER.read_text(encoding="utf-8")).group(1))
    assert library.thicket_c_version() == version


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("one", DOMAINS, ids=lambda one: one.name)
def test_domains(sampler, one, precision):
    given = sampler.fill(
        one.size,
        radius=one.radius,
        seed=one.seed,
        method=METHODS.index(one.method) + 1,
        toroidal=one.toroidal,
        single_precision=precision == "single",
        cell_size=one.cell_size,
    )
    assert given == 0, sampler.message()
    assert sampler.digest() == (one.digest(precision), 0)
    given, numbers = sampler.positions(0, sampler.count())
    assert given == 0 and len(numbers) == 2 * sampler.count() > 200
    assert all(0.0 <= x < one.size[0] for x in numbers[::2]) and all(0.0 <= y < one.size[1] for y in numbers[1::2])


def test_points_can_be_read_in_parts(sampler):
    assert sampler.sample(levels=3) == 0 and sampler.message() == ""
    count = sampler.count()
    given, points = sampler.points(0, count)
    assert given == 0 and len({point[2] for point in points}) == count > 200
    assert sampler.points(7, 30) == (0, points[7:37])
    assert sampler.positions(7, 30) == (0, [number for point in points[7:37] for number in point[:2]])
    assert sampler.points(count, 0) == (0, [])
    for first, requested, parameter in ((0, count + 1, "count"), (count + 1, 0, "first"), (1, 2**64 - 1, "count"), (2**64 - 1, 2, "first")):
        given = sampler.library.thicket_read_points(sampler.handle, U64(first), U64(requested), None)
        assert given == code("OUT_OF_RANGE") and sampler.message().startswith(f"{parameter} must be at most ")
    assert sampler.count() == count, "an invalid request does not remove points"


REFUSED_SETS = [
    ({"radius": -1.0}, "NOT_POSITIVE", "radius must be positive, got -1"),
    ({"radius": float("nan")}, "NOT_FINITE", "radius must be finite, got nan"),
    ({"radius": 2e6}, "OUT_OF_RANGE", "radius must be between 0.001 and 1000000, got 2000000"),
    ({"levels": 0}, "OUT_OF_RANGE", "levels must be between 1 and 8, got 0"),
    ({"levels": 9}, "OUT_OF_RANGE", "levels must be between 1 and 8, got 9"),
    ({"rect": (0.0, 0.0, float("inf"), 1.0)}, "NOT_FINITE", "rect must be finite, got inf"),
    ({"rect": (0.0, 0.0, -3.0, 1.0)}, "INVERTED", "rect has its end before its start, got -3"),
    ({"rect": (0.0, 0.0, 1e9, 1.0)}, "OUT_OF_RANGE", "rect must be between -5931641.6 and 5931641.6, got 1000000000"),
    ({"rect": (0.0, 0.0, 1e5, 1e5)}, "TOO_MANY_POINTS", "rect requires too many points, got "),
]


@pytest.mark.parametrize(("wrong", "name", "sentence"), REFUSED_SETS)
def test_bad_sets_are_rejected(sampler, wrong, name, sentence):
    assert sampler.sample() == 0
    assert sampler.sample(**wrong) == code(name)
    assert sampler.message().startswith(sentence)
    assert sampler.count() == 0
    assert sampler.sample() == 0 and sampler.count() > 200 and sampler.message() == ""


REFUSED_DOMAINS = [
    ({"size": (0.0, 5.0)}, "NOT_POSITIVE", "size must be positive, got 0"),
    ({"size": (5.0, float("nan"))}, "NOT_FINITE", "size must be finite, got nan"),
    ({"size": (1e6, 1e6)}, "TOO_MANY_POINTS", "size requires too many points, got "),
    ({"size": (3.0, 9.0), "toroidal": 1}, "OUT_OF_RANGE", "size is out of range, got 3; a toroidal domain measures at least 4 radii on each axis"),
    (
        {"size": (2e5, 9.0), "single_precision": 1},
        "OUT_OF_RANGE",
        "size is out of range, got 200000; in single precision a domain measures at most 131072 radii",
    ),
    ({"radius": 0.0}, "NOT_POSITIVE", "radius must be positive, got 0"),
    ({"method": 0}, "OUT_OF_RANGE", "method must be between 1 and 4, got 0"),
    ({"method": 5}, "OUT_OF_RANGE", "method must be between 1 and 4, got 5"),
    ({"toroidal": 2}, "OUT_OF_RANGE", "toroidal must be between 0 and 1, got 2"),
    ({"single_precision": -1}, "OUT_OF_RANGE", "single_precision must be between 0 and 1, got -1"),
    ({"cell_size": 1001.0}, "OUT_OF_RANGE", "cell_size must be between 0 and 1000, got 1001"),
    ({"darts_each": 0.5}, "OUT_OF_RANGE", "darts_each must be between 1 and 1000000, got 0.5"),
]


@pytest.mark.parametrize(("wrong", "name", "sentence"), REFUSED_DOMAINS)
def test_bad_domains_are_rejected(sampler, wrong, name, sentence):
    assert sampler.sample() == 0
    assert sampler.fill(**wrong) == code(name)
    assert sampler.message().startswith(sentence)
    assert sampler.count() == 0
    assert sampler.fill() == 0 and sampler.count() > 200


def test_missing_arguments_are_reported_by_name(sampler):
    library, handle = sampler.library, sampler.handle
    missing = code("MISSING")
    some, count, rect = Set(1, 1.0, 1, 0), U64(77), Rect(0.0, 0.0, 9.0, 9.0)
    for given, sentence in (
        (lambda: library.thicket_sample(handle, None, ctypes.byref(rect), None, ctypes.byref(count)), "set is missing"),
        (lambda: library.thicket_sample(handle, ctypes.byref(some), None, None, ctypes.byref(count)), "rect is missing"),
        (lambda: library.thicket_sample_domain(handle, None, None, ctypes.byref(count)), "domain is missing"),
        (lambda: library.thicket_digest(handle, None, None), "r_places is missing"),
    ):
        assert given() == missing and sampler.message() == sentence
    assert count.value == 77, "after an error, nothing is written"
    assert sampler.fill() == 0
    assert sampler.points(0, 1)[0] == missing and sampler.message() == "a previous call to thicket_sample is missing"
    assert library.thicket_read_positions(handle, U64(0), U64(1), None) == missing and sampler.message() == "buffer is missing"
    assert library.thicket_sample(None, None, None, None, None) == missing
    assert library.thicket_message(None) == b"sampler is missing" and library.thicket_count(None) == 0
    library.thicket_cancel(None)
    library.thicket_sampler_free(None)


LONG = {"sample": lambda sampler, watch: sampler.sample((0.0, 0.0, 3000.0, 3000.0), watch), "fill": lambda sampler, watch: sampler.fill((3000.0, 3000.0), watch)}


@pytest.mark.parametrize("work", LONG.values(), ids=LONG)
def test_a_call_can_be_watched_and_canceled(sampler, work: Callable):
    """Checks that a call can be canceled by the result of its progress function and from another thread, and that a nested call
    is rejected."""
    seen: list[tuple[float, int]] = []
    inside: list = []

    def progress(user, fraction, points):
        seen.append((fraction, points))
        if len(seen) == 3:
            inside.extend([sampler.sample(), sampler.message(), sampler.count(), user])
        return int(len(seen) == 5)

    assert work(sampler, Watch(PROGRESS(progress), 4711)) == code("CANCELLED")
    assert "was cancelled" in sampler.message() and sampler.count() == 0
    assert len(seen) == 5 and seen == sorted(seen) and seen[-1][0] < 0.9
    assert inside == [code("BUSY"), "another call to this sampler is running", 0, 4711]

    has_begun = threading.Event()

    def begin(user, fraction, points):
        has_begun.set()
        return 0

    canceller = threading.Thread(target=lambda: (has_begun.wait(), sampler.cancel()))
    canceller.start()
    assert work(sampler, Watch(PROGRESS(begin), None)) == code("CANCELLED")
    canceller.join()
    sampler.cancel()
    assert sampler.sample() == 0 and sampler.count() > 200, "canceling does not affect later calls"


def test_progress_ends_at_one(sampler):
    seen: list[tuple[float, int]] = []
    assert sampler.fill((300.0, 300.0), Watch(PROGRESS(lambda user, fraction, points: seen.append((fraction, points)) or 0), None)) == 0
    assert seen[-1] == (1.0, sampler.count()) and seen == sorted(seen)


def test_samplers_on_threads_agree(library):
    """Checks that samplers on several threads produce the same points. ctypes releases the global interpreter lock
    during a call."""
    digests: list = []

    def work():
        separate = Sampler(library)
        for _ in range(5):
            assert separate.sample((-60.0, -45.0, 70.0, 52.5)) == 0
            digests.append(separate.digest())
        library.thicket_sampler_free(separate.handle)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert digests == [SETS[0].digests] * 20
