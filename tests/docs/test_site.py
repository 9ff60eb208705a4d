"""Builds the documentation site, checks that mistakes are errors, and opens every page in Chromium."""

from __future__ import annotations

import functools
import json
import re
import shutil
import subprocess
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import CACHE, REPO, run

DOCS = REPO / "docs"
SITE = REPO / "build/docs/html"
PYTHON = CACHE / "docs-venv/bin/python"
SCREENSHOTS = REPO / "build/docs/screenshots"
SIZES = {"phone": (390, 844), "desktop": (1280, 900)}
SEARCHED, FOUND = "impostor", "A forest to the horizon"


@pytest.fixture(scope="module")
def site(godot) -> Path:
    """Builds the site as a contributor does, and returns its folder. Without an engine, the test is skipped."""
    if not PYTHON.is_file():
        pytest.skip("the site needs the packages of docs/requirements.txt: run tests/run.sh, which installs them")
    completed = run(["bash", "docs/build.sh"], timeout=300, cwd=REPO)
    assert completed.returncode == 0, completed.stdout[-4000:] + completed.stderr[-4000:]
    return SITE


# --- The content --------------------------------------------------------------------------------------------------------


def text_of(page: Path) -> str:
    """Returns the text of a page without tags."""
    return re.sub(r"<[^>]+>", "", page.read_text(encoding="utf-8"))


def test_every_class_has_a_page_and_a_line_in_the_index(site):
    index = (site / "classes/index.html").read_text(encoding="utf-8")
    for path in (REPO / "extension/doc_classes").glob("*.xml"):
        root = ElementTree.parse(path).getroot()
        page = site / f"classes/class_{path.stem.lower()}.html"
        if "deprecated" in root.attrib:
            assert not page.exists(), path.stem
            continue
        assert f'href="{page.name}"' in index, path.stem
        text = page.read_text(encoding="utf-8")
        for member in [*root.iter("member"), *root.iter("method"), *root.iter("signal")]:
            assert member.get("name").replace("_", "-") in text, f"{path.stem}.{member.get('name')}"


def test_every_tutorial_is_the_one_in_the_editor(site):
    """Checks that the site shows all paragraphs of the add-on's tutorials, so there is one source for both."""
    pages = sorted((REPO / "demo_project/addons/thicket/tutorials").glob("*.md"))
    assert sorted(path.name for path in (DOCS / "tutorials").glob("*.md")) == sorted(["index.md", *(page.name for page in pages)])
    index = (DOCS / "tutorials/index.md").read_text(encoding="utf-8")
    for page in pages:
        title = page.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        assert f"| [{title}](../../demo_project/addons/thicket/tutorials/{page.name}) |" in index
        shown = text_of(site / f"tutorials/{page.stem}.html")
        headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
        assert headings and all(re.sub(r"['’]", "", heading) in re.sub(r"['’]", "", shown) for heading in headings), page.name


def test_a_newcomer_finds_the_download(site):
    """Checks that the first pages link to the forge, and that the front page has the film with its poster."""
    plugin = (REPO / "demo_project/addons/thicket/plugin.cfg").read_text(encoding="utf-8")
    repository = re.search(r'^repository="(.+)"$', plugin, re.MULTILINE).group(1)
    front = (site / "index.html").read_text(encoding="utf-8")
    assert f'href="{repository}/issues"' in front
    for text in (front, (site / "getting_started.html").read_text(encoding="utf-8")):
        assert f'href="{repository}/releases/latest"' in text
    (film,) = re.findall(r"<video.*?>", front, re.DOTALL)
    for attribute in ("src", "poster"):
        assert (site / re.search(rf'{attribute}="(.+?)"', film).group(1)).is_file()


def test_names_of_classes_are_links(site):
    page = (site / "concepts/gameplay.html").read_text(encoding="utf-8")
    assert 'href="../classes/class_terrainscatter3d.html#class-terrainscatter3d-method-make-snapshot"' in page
    layer = (site / "classes/class_scatterlayer.html").read_text(encoding="utf-8")
    assert "en/stable/classes/class_noise.html" in layer and 'href="class_scattermodel.html' in layer


# --- Mistakes -----------------------------------------------------------------------------------------------------------


def test_mistakes_are_errors(site, tmp_path):
    """Checks that each of these lines is reported and fails the build."""
    for path in REPO.iterdir():
        if path.name not in ("docs", ".git"):
            (tmp_path / path.name).symlink_to(path)
    shutil.copytree(DOCS, tmp_path / "docs", ignore=shutil.ignore_patterns("__pycache__"))
    mistakes = {
        "[a page](nowhere_page.md)": "nowhere_page.md",
        "[a heading](concepts/points.md#nowhere-heading)": "nowhere-heading",
        "[a file](../tools/nowhere_file.md)": "nowhere_file.md",
        "![a picture](../demo_project/pictures/nowhere_picture.jpg)": "nowhere_picture.jpg",
        "`ScatterNowhere`": "ScatterNowhere",
        "`ScatterLayer.nowhere_member`": "nowhere_member",
    }
    with (tmp_path / "docs/faq.md").open("a", encoding="utf-8") as page:
        page.write("\n\n" + "\n\n".join(mistakes) + "\n")
    flags = re.search(r"--fail-on-warning.*--nitpicky", (DOCS / "build.sh").read_text(encoding="utf-8")).group(0).split()
    completed = run([PYTHON, "-m", "sphinx", "--builder", "html", *flags, "-d", tmp_path / "trees", tmp_path / "docs", tmp_path / "html"], timeout=120)
    assert completed.returncode != 0
    warnings = [line for line in completed.stderr.splitlines() if "WARNING" in line]
    for line, name in mistakes.items():
        assert any("faq.md" in warning or "faq:" in warning for warning in warnings if name in warning), f"{line}: {warnings}"


@pytest.mark.parametrize("mistake", ["[ScatterNowhere]", "[member ScatterLayer.nowhere]", "[NowhereOfTheEngine]", "[method Node3D.nowhere]"])
def test_an_unknown_name_in_the_class_reference_is_an_error(site, tmp_path, mistake):
    ours = tmp_path / "doc_classes"
    shutil.copytree(REPO / "extension/doc_classes", ours)
    text = (ours / "ScatterLod.xml").read_text(encoding="utf-8")
    (ours / "ScatterLod.xml").write_text(text.replace("<description>\n", f"<description>\nSee {mistake}.\n", 1), encoding="utf-8")
    (tmp_path / "engine").symlink_to(REPO / "build/docs/engine")
    script = (
        "import sys, pathlib; sys.path.insert(0, 'docs'); import class_reference as reference\n"
        "reference.OURS, reference.WORK, reference.PAGES = (pathlib.Path(path) for path in sys.argv[1:])\n"
        "reference.write_engine_reference = lambda folder: None\n"
        "reference.main()\n"
    )
    completed = run([PYTHON, "-c", script, ours, tmp_path, tmp_path / "pages"], timeout=60, cwd=REPO)
    assert completed.returncode != 0 and "fix extension/doc_classes" in completed.stderr and "ScatterLod.xml" in completed.stderr, completed.stderr


# --- In a browser -------------------------------------------------------------------------------------------------------

# Opens each page in a frame of each size, and then searches for a word from the field in the sidebar. Writes what it
# has seen as JSON. A frame has the width that the page's style rules see.
DRIVER = """<!doctype html><meta charset="utf-8"><pre id="out"></pre><script>
const load = (frame, page) => new Promise(done => { frame.onload = () => setTimeout(done, 20); frame.src = page; });
const frameOf = size => {
	const frame = document.createElement("iframe");
	[frame.width, frame.height] = size;
	document.body.append(frame);
	return frame;
};
(async () => {
	const seen = [];
	for (const [name, size] of Object.entries(SIZES)) {
		const frame = frameOf(size);
		for (const page of PAGES) {
			await load(frame, page);
			const root = frame.contentDocument;
			const broken = [...root.images].filter(image => image.naturalWidth === 0).map(image => image.src);
			const sidebar = root.querySelector(".sidebar-drawer").getBoundingClientRect();
			seen.push({name, page, wider: root.documentElement.scrollWidth - size[0], broken, sidebar: sidebar.right > 0, title: root.title});
		}
		await load(frame, "index.html");
		const field = frame.contentDocument.querySelector("input[name=q]");
		field.value = WORD;
		const submitted = new Promise(done => frame.onload = done);
		field.form.submit();
		await submitted;
		let results = [];
		for (let tries = 0; tries < 200 && results.length < 3; tries++) {
			await new Promise(done => setTimeout(done, 50));
			results = [...frame.contentDocument.querySelectorAll("#search-results li a")].map(link => link.textContent);
		}
		seen.push({name, results});
		frame.remove();
	}
	document.getElementById("out").textContent = JSON.stringify(seen);
})();
</script>"""
FRAME = '<!doctype html><body style="margin:0"><iframe src="%s" width="%d" height="%d" style="border:0"></iframe>'


@pytest.fixture(scope="module")
def address(site) -> Iterator[str]:
    """Serves the site and the pages that open it, and returns the address."""
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html") if "_static" not in path.parts)
    made = {"/driver.html": DRIVER.replace("SIZES", json.dumps(SIZES), 1).replace("PAGES", json.dumps(pages), 1).replace("WORD", json.dumps(SEARCHED), 1)}
    for size, (width, height) in SIZES.items():
        for page in pages:
            made[f"/frame/{size}/{page}"] = FRAME % ("/" + page, width, height)

    class Handler(SimpleHTTPRequestHandler):
        def do_GET(self):  # noqa: N802 (the name that the base class calls)
            if self.path not in made:
                super().do_GET()
                return
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(made[self.path].encode())

        def log_message(self, *arguments):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=site)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield "http://%s:%d" % server.server_address[:2]
        server.shutdown()


def chromium(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    program = shutil.which("chromium")
    if not program:
        pytest.skip("no Chromium to open the site in: run tests/run.sh, which installs it")
    return run([program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={folder}", *arguments], timeout=200)


@pytest.fixture(scope="module")
def seen(address, tmp_path_factory) -> list[dict]:
    completed = chromium(tmp_path_factory.mktemp("chromium"), "--virtual-time-budget=600000", "--dump-dom", f"{address}/driver.html")
    found = re.search(r'<pre id="out">(.+?)</pre>', completed.stdout, re.DOTALL)
    assert found, completed.stdout[-2000:] + completed.stderr[-2000:]
    return json.loads(found.group(1))


@pytest.mark.parametrize("size", SIZES)
def test_pages_fit_the_screen(seen, size):
    """Checks that no page is wider than the screen, that all images are displayed, and that the phone hides the sidebar."""
    pages = [page for page in seen if page["name"] == size and "page" in page]
    assert len(pages) > 60
    assert not [page["page"] for page in pages if page["wider"] > 0], "these scroll sideways"
    assert not {page["page"]: page["broken"] for page in pages if page["broken"]}
    assert all(page["sidebar"] == (size == "desktop") for page in pages)
    assert all("Thicket" in page["title"] for page in pages)


@pytest.mark.parametrize("size", SIZES)
def test_the_search_finds_pages(seen, size):
    (results,) = [page["results"] for page in seen if page["name"] == size and "results" in page]
    assert FOUND in results and "Drawing" in results, results


@pytest.mark.parametrize("size", SIZES)
def test_screenshots(address, tmp_path, size):
    """Takes screenshots for a person to check, and tests that they are not blank."""
    from PIL import Image

    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    width, height = SIZES[size]
    for page in ("index", "getting_started", "concepts/rules", "classes/class_scatterlayer", "benchmarks"):
        picture = SCREENSHOTS / f"{size}_{page.replace('/', '_')}.png"
        chromium(tmp_path, f"--window-size={max(width, 500)},{height + 120}", f"--screenshot={picture}", f"{address}/frame/{size}/{page}.html")
        with Image.open(picture) as image:
            assert len(image.crop((0, 0, width, height)).convert("RGB").getcolors(1 << 24)) > 50, picture
