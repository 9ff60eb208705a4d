"""Records on which platforms tests have played, loaded or built the library, and writes the tables of platforms from these records.

    bash tests/run.sh --full --record-platforms   records all platforms whose tests pass, and writes the tables
    python3 tests/tested_platforms.py                    writes the tables again

A run with `-k` updates only the platforms whose tests it runs. No record and no table is edited by hand.
"""

from __future__ import annotations

import datetime
import json
import re
from dataclasses import dataclass
from pathlib import Path

REPO = Path(__file__).resolve().parent.parent
RECORDS = REPO / "tests/tested_platforms.json"
PAGES = [REPO / "README.md", REPO / "docs/getting_started.md"]

BEGIN = "<!-- The table from here on is written by tests/tested_platforms.py. -->"
END = "<!-- The table ends here. -->"
HEAD = "| System | Processor | Tested | Godot | Tests | Command: `bash tests/run.sh` | Passed on |\n| --- | --- | --- | --- | --- | --- | --- |"


@dataclass(frozen=True)
class Platform:
    """A row of the table. It is recorded if all tests passed whose IDs begin with `tests`."""

    system: str
    processor: str
    how: str  # played: in Godot; loaded: by the program in tests/loader; built: only the file was checked.
    tests: str
    options: str  # The arguments of tests/run.sh that run these tests.

    @property
    def key(self) -> str:
        return f"{self.system}, {self.processor}"


PACKAGE = "tests/build/test_package.py::"
PLATFORMS = [
    Platform("Linux, glibc 2.17 and newer", "x86_64", "played", "tests/engine/test_engine.py::test_script[", "-k test_script"),
    Platform("Linux, glibc 2.17 and newer", "arm64", "played, in an emulator", PACKAGE + "test_the_engine_for_arm_", "--full -k engine_for_arm"),
    Platform("Windows 10 and newer", "x86_64", "loaded, under wine", PACKAGE + "test_the_library_for_windows_loads", "--full -k for_windows_loads"),
    Platform("Windows 10 and newer", "arm64", "built", PACKAGE + "test_libraries_for_windows_", "--full -k libraries_for_windows"),
    Platform("macOS 11 and newer", "arm64, x86_64", "built", PACKAGE + "test_frameworks_for_macos_", "--full -k frameworks_for_macos"),
    Platform("Web, without threads", "wasm32", "played, in Chromium", "tests/build/test_web.py::test_engine_scripts_pass[", "--full -k test_web"),
    Platform("Web, with threads", "wasm32", "loaded, in Node.js", PACKAGE + "test_the_library_for_the_web_loads[True]", "--full -k for_the_web_loads"),
]


def read() -> dict[str, dict]:
    return json.loads(RECORDS.read_text(encoding="utf-8"))


def table(records: dict[str, dict]) -> str:
    """Returns the table. A platform without a record gets a row that says so."""
    rows = []
    for each in PLATFORMS:
        record = records.get(each.key, {"godot": "", "tests": "", "date": "not recorded yet"})
        cells = [each.system, each.processor, each.how, record["godot"], record["tests"], f"`{each.options}`", record["date"]]
        rows.append("| " + " | ".join(str(cell) for cell in cells) + " |")
    return "\n".join([HEAD, *rows])


def put(text: str, written: str) -> str:
    """Returns a page's text with a new table between its two marks."""
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    return f"{before}{BEGIN}\n\n{written}\n\n{END}{after}"


def write(records: dict[str, dict]):
    RECORDS.write_text(json.dumps({key: records[key] for key in sorted(records)}, indent="\t") + "\n", encoding="utf-8")
    for page in PAGES:
        page.write_text(put(page.read_text(encoding="utf-8"), table(records)), encoding="utf-8")


class Recorder:
    """A plugin for pytest that collects the results of a run."""

    def __init__(self):
        self.passed: dict[str, set[str]] = {}  # The IDs of passed tests, for each platform.
        self.unfit: set[str] = set()  # The platforms of which a test failed or was skipped.
        self.engines: dict[str, str] = {}

    def pytest_runtest_logreport(self, report):
        for each in PLATFORMS:
            if not report.nodeid.startswith(each.tests):
                continue
            if report.outcome != "passed":
                self.unfit.add(each.key)
            elif report.when == "call":
                self.passed.setdefault(each.key, set()).add(report.nodeid)
            self.engines.update({each.key: value for name, value in report.user_properties if name == "engine"})

    def results(self, date: str) -> dict[str, dict]:
        """Returns new records, for the platforms of which all tests in this run passed."""
        return {
            key: {"godot": self.engines.get(key, ""), "tests": len(passed), "date": date}
            for key, passed in self.passed.items() if key not in self.unfit
        }  # fmt: skip

    def pytest_sessionfinish(self):
        write({**read(), **self.results(datetime.datetime.now(datetime.timezone.utc).date().isoformat())})


def engine_of(printed: str) -> str:
    """Returns the version in the first line that an engine prints, such as 4.6.3."""
    return re.search(r"^Godot Engine v([\d.]*\d)", printed, re.MULTILINE).group(1)


if __name__ == "__main__":
    write(read())
