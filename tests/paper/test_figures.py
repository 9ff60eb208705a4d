"""Tests the reproduction of the paper's figures: the command must complete with small sizes, and its estimators must
reproduce known results."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
from bench.figures import billion, data, paper, speed, tables
from bench.figures.contenders import CONTENDERS, OURS, Contender
from bench.figures.parts import PARTS, TABLES
from bench.figures.point_sets import read_sets
from bench.figures.programs import Failed, Programs, run_lines
from bench.figures.settings import FULL, LOSS_FROM, LOSS_TO, QUICK, half_decades
from bench.figures.spectra import AveragedSpectrum, noise_level, ring_edges
from conftest import REPO, run

BENCH = REPO / "tests" / "bench"
LARGEST_PICTURE = 300_000  # Maximum size in bytes.
SVG_MARKS = 20  # Every plot has more paths than this.


def fingerprint() -> dict[str, str]:
    """Returns the digests of the committed data files."""
    files = [*(BENCH / "data").glob("*")]
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files if path.is_file()}


class Quick:
    """A quick run of the command, with the programs of the test build."""

    def __init__(self, folder: Path, build_dir: Path):
        self.folder = folder
        before = fingerprint()
        command = ["bash", BENCH / "figures.sh", "--quick", "--out", folder, "--programs", build_dir]
        self.done = run(command, timeout=600, cwd=folder)
        assert self.done.returncode == 0, self.done.stderr
        self.untouched = fingerprint() == before
        self.page = (folder / "RESULTS.md").read_text(encoding="utf-8")
        self.tables = {Path(name).stem: tables.read(folder / name) for name in TABLES}


@pytest.fixture(scope="module")
def quick(tmp_path_factory, build_dir) -> Quick:
    return Quick(tmp_path_factory.mktemp("figures"), build_dir)


def test_quick_run_does_not_change_the_data(quick):
    assert quick.untouched
    assert "This is a quick run" in quick.page


def test_tables_are_complete(quick):
    for name, rows in quick.tables.items():
        assert rows or name == "section43_large", f"{name} is empty"
        for row in rows:
            assert not [key for key, cell in row.items() if isinstance(cell, float) and not np.isfinite(cell)], (
                name,
                row,
            )
    for contender in CONTENDERS:
        rows = tables.where(quick.tables["figure4"], contender=contender.key)
        assert rows and all(row["lowest"] <= row["median"] <= row["highest"] for row in rows), contender.key
        # The number of points is close to the requested one. Methods other than dart throwing may deviate more.
        close = 0.05 if contender.family == OURS and contender.method != "naive" else 0.3
        assert all(abs(row["points"] / row["asked"] - 1.0) < close for row in rows), rows


def test_counts_are_as_in_the_paper(quick):
    counts = quick.tables["figure6"]
    assert all(paper.SQUARES_LEAST.value < row["squares"] < paper.SQUARES_MOST.value for row in counts)
    assert all(row["checks"] < paper.LIST_CHECKS_MOST.value for row in counts)
    assert all(abs(row["z"]) < 4.5 for row in quick.tables["figure5_coverage"] if row["ends"])


def test_both_orders_produce_the_same_points(quick):
    rows = quick.tables["billion"]
    assert [row["order"] for row in rows] == list(billion.ORDERS)
    assert len({row["digest"] for row in rows}) == 1
    assert not any(row["broken"] for row in rows)


def shown_pictures(text: str, beside: Path) -> list[Path]:
    return [beside / name for name in re.findall(r'(?:src|srcset)="([^"]+)"', text)]


def check_pictures(pictures: list[Path]) -> None:
    assert len(pictures) >= 2 * 6, pictures  # Each plot has a light and a dark version.
    for picture in pictures:
        assert 2_000 < picture.stat().st_size < LARGEST_PICTURE, picture
        if picture.suffix == ".svg":
            text = picture.read_text(encoding="utf-8")
            assert text.count("<path") + text.count("<use") > SVG_MARKS, picture
            assert not re.search(r"https?://(?!www\.w3\.org/)", text), picture


def test_plots_of_a_run_exist(quick):
    check_pictures(shown_pictures(quick.page, quick.folder))


@pytest.fixture(scope="module")
def rendered(tmp_path_factory) -> Path:
    """Returns the folder with the page and its plots, rendered from the committed data."""
    folder = tmp_path_factory.mktemp("rendered")
    result = run(["bash", BENCH / "figures.sh", "--render", "--out", folder], timeout=300)
    assert result.returncode == 0 and "done" in result.stderr, result.stderr
    return folder


def test_the_page_is_rendered_from_committed_data(rendered):
    text = (rendered / "RESULTS.md").read_text(encoding="utf-8")
    check_pictures(shown_pictures(text, rendered))
    assert "quick run" not in text and "nan" not in text
    for heading in ("Figure 4", "Figure 5", "Figure 6", "Section 4.2", "Section 4.3", "Passed"):
        assert f"\n## {heading}" in text
    for contender in CONTENDERS:
        assert f"| {contender.label}, {contender.precision} |" in text


def test_committed_data_is_complete():
    """Checks that the committed data contains all parts, comes from a full run, and is small enough to commit."""
    tables_there, facts = data.read(BENCH / "data/figures.json")
    assert set(facts) == set(PARTS) and not any(one["quick"] for one in facts.values())
    assert (BENCH / "data/figures.json").stat().st_size < 100_000
    rates = tables_there["figure4"]
    assert {row["asked"] for row in rates} <= set(FULL.sizes) and {LOSS_FROM, LOSS_TO} <= {row["asked"] for row in rates}
    assert all(row["lowest"] <= row["median"] <= row["highest"] for row in rates)
    assert len({row["digest"] for row in tables_there["billion"]}) == 1


def test_committed_data_has_the_columns_of_a_run(quick, tmp_path):
    table = data.compact(quick.tables)
    data.write(tmp_path / "data.json", table, {})
    again, _ = data.read(tmp_path / "data.json")
    committed, _ = data.read(BENCH / "data/figures.json")
    assert again.keys() == committed.keys()
    for name, rows in again.items():
        if rows:
            assert set(rows[0]) >= set(committed[name][0]), name


def test_a_part_can_be_measured_alone(quick, tmp_path, build_dir):
    """Checks that measuring one part into an empty folder writes a page that names the other parts, whose numbers are the
    committed ones. In a complete folder, it must replace only the tables of that part."""
    command = ["bash", BENCH / "figures.sh", "--quick", "--programs", build_dir, "--only", "billion", "--out"]
    before = fingerprint()
    alone = run([*command, tmp_path], timeout=300)
    assert alone.returncode == 0 and "speed, sets, memory, large" in alone.stderr, alone.stderr
    assert {path.name for path in tmp_path.glob("*.*")} == {"billion.csv", "machine.json", "RESULTS.md"}
    page = (tmp_path / "RESULTS.md").read_text(encoding="utf-8")
    named = ", ".join(PARTS[name].shows for name in ("speed", "sets", "memory", "large"))
    assert f"Not measured in this run, and taken from tests/bench/data: {named}." in page
    points = tables.read(tmp_path / "billion.csv")[0]["points"]
    assert f"## Passed: {points:,} points" in page and "## Figure 4" in page and fingerprint() == before
    times = {name: (quick.folder / name).stat().st_mtime_ns for name in TABLES if (quick.folder / name).is_file()}
    again = run([*command, quick.folder], timeout=300)
    assert again.returncode == 0 and "done" in again.stderr, again.stderr
    changed = {name for name, at in times.items() if (quick.folder / name).stat().st_mtime_ns != at}
    assert changed == set(PARTS["billion"].tables)


@pytest.mark.parametrize("arguments", [["--fast"], ["--only", "nothing"], ["--out"], ["--programs"]])
def test_wrong_options_are_rejected(arguments):
    result = run(["bash", BENCH / "figures.sh", *arguments], timeout=60)
    assert result.returncode == 2 and arguments[0] in result.stderr, result.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["hierarchical"],
        ["unknown", "double", "1000", "1"],
        ["tile", "single", "1000", "1"],
        ["tile", "double", "1000", "1", "torus"],
        ["hierarchical", "double", "many", "1"],
        ["hierarchical", "double", "1000", "1", "cell=-1"],
        ["hierarchical", "double", "1000", "1", "speed=high"],
        ["naive", "double", "1000", "1", "darts=0"],
    ],
)
def test_domain_run_rejects_bad_arguments(core_tool, words):
    result = core_tool("bench/domain_run", *words)
    assert result.returncode == 1 and result.stderr.startswith("domain_run: ") and not result.stdout, result.stderr


def test_domain_run_dumps_the_counted_points(core_tool, tmp_path):
    """Checks that the points are the same whether they are returned or left in the cells, and that they lie inside the
    domain."""
    sets = {}
    for flags in ([], ["fill"]):
        dump = tmp_path / "sets"
        result = core_tool(
            "bench/domain_run", "wavefront", "double", "2000", "7", "torus", "sets=2", f"dump={dump}", *flags
        )
        lines = [json.loads(line) for line in result.stdout.splitlines()]
        sets[len(flags)] = read_sets(dump)
        assert [len(points) for points in sets[len(flags)]] == [line["points"] for line in lines]
        assert all((points >= 0.0).all() and (points < lines[0]["size"]).all() for points in sets[len(flags)])
    for handed_out, left in zip(*sets.values(), strict=True):
        assert set(map(tuple, handed_out)) == set(map(tuple, left))


def test_limited_memory_is_limited(build_dir):
    """Checks that a set that is too large for the memory limit is rejected, and that it succeeds with a larger limit. The small
    limit is the memory that the call itself reports, so the test stays valid if the sampler needs less memory."""
    programs = Programs(build_dir, peer=lambda *_: [], contenders=[])
    call = ("accumulator", "double", 300_000, 1, "torus", "fill")
    unlimited = programs.domain(*call)[0]
    wide = programs.domain(*call, limit_bytes=2**30)[0]
    assert wide["points"] == unlimited["points"] > 290_000
    with pytest.raises(Failed, match="memory"):
        programs.domain(*call, limit_bytes=unlimited["workspace_bytes"])


SIDE = 40.0
MODES = 80
EDGES = ring_edges(MODES, SIDE, 20)


def test_independent_points_have_a_flat_isotropic_spectrum():
    random = np.random.default_rng(1)
    spectrum = AveragedSpectrum([random.random((1500, 2)) * SIDE for _ in range(20)], SIDE, MODES, EDGES)
    assert np.abs((spectrum.radial() - 1.0) / spectrum.radial_error()).max() < 4.5
    # The first rings have few waves and a large spread. The taper correlates neighboring waves.
    assert np.abs(spectrum.anisotropy()[3:] - noise_level(20)).max() < 1.5
    assert abs(spectrum.anisotropy()[3:].mean() - noise_level(20)) < 0.4
    assert noise_level(10) == pytest.approx(-10.0)


def test_lattice_has_an_anisotropic_symmetric_spectrum():
    """Checks that a jittered lattice has power at whole waves per cell, on the axes of the image."""
    random = np.random.default_rng(2)
    cells = np.stack(np.meshgrid(np.arange(SIDE), np.arange(SIDE)), axis=-1).reshape(-1, 2)
    sets = [(cells + 0.5 + 0.1 * random.standard_normal(cells.shape)) % SIDE for _ in range(10)]
    spectrum = AveragedSpectrum(sets, SIDE, MODES, EDGES)
    assert spectrum.anisotropy().max() > noise_level(10) + 10.0
    image = spectrum.image()
    assert np.array_equal(image, image[::-1, ::-1])
    peak = image[MODES, MODES + int(SIDE)]
    assert peak > 100.0 * np.median(image) and image[MODES, MODES] == 0.0


def test_sizes_are_half_decades():
    assert half_decades(3, 5) == [1000, 3200, 10_000, 32_000, 100_000]
    assert {LOSS_FROM, LOSS_TO, paper.RATE_POINTS} <= set(FULL.sizes)
    assert paper.LARGE_CELL in FULL.cells and paper.LARGE_CELL in QUICK.cells


def test_tables_are_read_back_unchanged(tmp_path):
    rows = [
        {"name": "a", "count": 3, "share": 0.25, "there": True},
        {"name": "b", "count": 4, "share": 1e-9, "there": False},
    ]
    tables.write(tmp_path / "table.csv", rows)
    assert tables.read(tmp_path / "table.csv") == rows
    assert tables.read(tmp_path / "none.csv") == []


class FakePrograms:
    """A stand-in for Programs. A run takes a fixed time per point, and twice as long above 10,000 points."""

    def __init__(self, seconds_a_point: float):
        self.seconds_a_point = seconds_a_point
        self.calls: list[tuple[float, int]] = []

    def domain(self, _method, _precision, points, seed, *_flags, sets=1):
        self.calls.append((points, seed))
        seconds = points * self.seconds_a_point * (2.0 if points > 10_000 else 1.0)
        return [{"points": points, "seconds": seconds, "resident_peak": 1}] * sets


def test_contenders_take_turns_and_slow_ones_end():
    fast, slow = FakePrograms(1e-8), FakePrograms(5e-4)
    contender = Contender("one", "double", "one", OURS)
    assert {row["asked"] for row in speed.measure(fast, [contender], QUICK)} == set(QUICK.sizes)
    assert {row["asked"] for row in speed.measure(slow, [contender], QUICK)} == {1000, 3200}
    assert len(set(fast.calls[1:])) == len(fast.calls) - 1, "a seed was used twice"
    rates = speed.summarise(speed.measure(fast, [contender], QUICK))
    assert speed.losses(rates, 1000, 100_000)[0]["loss"] == pytest.approx(0.5)


def test_failures_have_a_reason():
    with pytest.raises(Failed, match="no such file"):
        run_lines(["bash", "-c", "echo no such file >&2; exit 3"])
    assert run_lines(["bash", "-c", "echo '{\"a\": 1}'; exit 1"], accepted=(0, 1)) == [{"a": 1}]
