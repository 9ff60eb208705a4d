"""Tests that the speed tables in docs/benchmarks.md match the stored results of the benchmarks and state how they were measured."""

import importlib.util
import json
import subprocess

import pytest
from conftest import REPO

SPEC = importlib.util.spec_from_file_location("speed_table", REPO / "tests/bench/speed_table.py")
speed_table = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(speed_table)

SAMPLER = [
    ["tiles of 64 r: sampler", "7.00 M points/s", "6.90 to 7.10", "9"],
    ["tiles of 16 r: sampler", "3.00 M points/s", "2.90 to 3.10", "9"],
]
FLIGHT = [["flight with 1,234 tiles: longest", "543 µs", '{ "upload": 3 }', "1202 frames"]]


@pytest.fixture
def kept():
    return speed_table.keep({}, {"sampler": SAMPLER, "flight": FLIGHT}, "2 cores of a processor", "2026-01-02")


def test_the_page_shows_the_stored_rows():
    """Checks that no value was edited by hand, and that the tables were rewritten after the last change to SECTIONS."""
    text = speed_table.PAGE.read_text(encoding="utf-8")
    kept = json.loads(speed_table.KEPT.read_text(encoding="utf-8"))
    assert speed_table.put(text, speed_table.tables(kept, speed_table.SECTIONS)) == text


def test_rows_of_a_folder_are_read(tmp_path):
    (tmp_path / "sampler").write_text("| tiles of 64 r: sampler | 7.00 M points/s | 6.90 to 7.10 | 9 |\n")
    assert speed_table.read(tmp_path) == {"sampler": SAMPLER[:1]}


@pytest.mark.parametrize("text", ["", "| half a row | 1 |\n"])
def test_a_part_without_rows_is_rejected(tmp_path, text):
    (tmp_path / "sampler").write_text(text)
    with pytest.raises(SystemExit, match="sampler must contain rows of four cells"):
        speed_table.read(tmp_path)


def test_a_part_that_was_not_measured_is_kept(kept):
    updated = speed_table.keep(kept, {"sampler": SAMPLER[:1]}, "another machine", "2026-03-04")
    assert updated["flight"] == kept["flight"]
    assert updated["sampler"] == {"machine": "another machine", "date": "2026-03-04", "rows": SAMPLER[:1]}
    assert "from 2026-01-02 to 2026-03-04: another machine; 2 cores of a processor." in speed_table.tables(updated, {})


def test_rows_come_in_the_order_of_their_patterns(kept):
    text = speed_table.tables(kept, {"Sampler": ["tiles of 16*", "tiles of 64*"], "On the way": ["flight with * tiles: longest"]})
    assert [line for line in text.splitlines() if line.startswith(("###", "| t", "| f"))] == [
        "### Sampler",
        "| tiles of 16 r: sampler | 3.00 M points/s | 2.90 to 3.10 | 9 |",
        "| tiles of 64 r: sampler | 7.00 M points/s | 6.90 to 7.10 | 9 |",
        "### On the way",
        '| flight with 1,234 tiles: longest | 543 µs | { "upload": 3 } | 1202 frames |',
    ]


def test_a_pattern_without_a_row_is_an_error(kept):
    with pytest.raises(SystemExit, match="no row is called tiles of 8 r"):
        speed_table.tables(kept, {"Sampler": ["tiles of 8 r"]})


def test_only_the_tables_change():
    page = f"before\n{speed_table.BEGIN}\nold\n{speed_table.END}\nafter"
    assert speed_table.put(page, "new") == f"before\n{speed_table.BEGIN}\n\nnew\n\n{speed_table.END}\nafter"
    with pytest.raises(SystemExit, match="must contain these two lines"):
        speed_table.put("no tables here", "new")


def test_an_unknown_part_is_rejected():
    completed = subprocess.run(["bash", REPO / "tests/bench/run.sh", "--only", "sampler,nothing"], capture_output=True, text=True, check=False)
    assert completed.returncode == 2
    assert "--only must be followed by some of sampler tile" in completed.stderr and "got nothing" in completed.stderr
