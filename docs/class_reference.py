"""Writes the pages of the class reference into docs/classes, from extension/doc_classes.

The converter is Godot's own make_rst.py, from the package gddoc2yml. The engine writes the names of its classes and
members, so a reference to an unknown name is an error. docs/conf.py links these names to Godot's documentation.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

REPO = Path(__file__).resolve().parents[1]
OURS = REPO / "extension/doc_classes"
WORK = REPO / "build/docs"
PAGES = REPO / "docs/classes"

# The headings of the index, and the classes below each. Classes of older versions are left out.
GROUPS = {
    "Scattering": ["TerrainScatter3D", "ScatterRegion3D", "ScatterLayer", "ScatterModel", "ScatterLod", "ScatterMask", "ScatterRows", "ScatterRule",
        "ScatterValueSource", "ScatterBiomeMap", "ScatterBiome", "ScatterImpostorBaker"],
    "Grounds": ["ScatterGround", "ScatterGroundColliders", "ScatterGroundCombined", "ScatterGroundFlat", "ScatterGroundHeightmap",
        "ScatterGroundMeshes", "ScatterGroundNode", "ScatterGroundNoise"],
    "Gameplay": ["ScatterInstance", "ScatterInstances", "ScatterRequest", "ScatterSnapshot", "ScatterState", "ScatterDiffLimits",
        "ScatterExplanation"],
    "Tiles": ["ScatterTile", "ScatterTileGrid"],
    "Points without a scene": ["PoissonSampler", "PoissonPoints", "PoissonSurfacePoints"],
}  # fmt: skip


def write_engine_reference(folder):
    """Lets the engine write the names of all of its classes and members."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    completed = subprocess.run([REPO / "tools/godot", "--headless", "--doctool", folder], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if completed.returncode or not (folder / "doc/classes/Node3D.xml").is_file():
        raise SystemExit("class_reference: the engine wrote no class reference:\n" + completed.stdout + completed.stderr)


def prepare(source):
    """Returns the XML of a class in the form that make_rst requires: code is indented by spaces, and words in [code] that are
    also names of members are not reported. Links to tutorials become links to the pages of the site."""
    text = source.read_text(encoding="utf-8")
    text = re.sub(r"\[codeblock\].*?\[/codeblock\]", with_spaces, text, flags=re.DOTALL)
    text = text.replace("[code]", "[code skip-lint]")
    return re.sub(r"res://addons/thicket/tutorials/(\w+)\.md", r"../tutorials/\1.html", text)


def with_spaces(block):
    """Replaces the tabs after the common indentation of a code block with four spaces each."""
    lines = block.group(0).split("\n")
    common = min((len(line) - len(line.lstrip("\t")) for line in lines[1:] if line.strip()), default=0)
    return "\n".join(line if number == 0 or not line.strip() else line[:common] + line[common:].replace("\t", "    ") for number, line in enumerate(lines))


def is_former(path):
    """Returns whether the engine shows the class as deprecated: it exists only for scripts of an older version."""
    return "deprecated" in ElementTree.parse(path).getroot().attrib


def write_pages(engine, prepared):
    command = [sys.executable, "-m", "gddoc2yml.make_rst", "--output", PAGES, "--filter", "^" + re.escape(str(prepared)), prepared,
        engine / "doc/classes", engine / "modules"]  # fmt: skip
    completed = subprocess.run(command, capture_output=True, text=True)
    if completed.returncode:
        raise SystemExit("class_reference: fix extension/doc_classes:\n" + completed.stdout + completed.stderr)


def tidy_pages():
    """Removes what make_rst adds for Godot's own repository, and gives code its language."""
    for page in PAGES.glob("class_*.rst"):
        text = page.read_text(encoding="utf-8")
        text = re.sub(r"^:github_url: hide\n\n|^\.\. (DO NOT EDIT|Generated|Generator|XML source).*\n", "", text, flags=re.MULTILINE)
        text = re.sub(r"^::\n\n(?= )", ".. code-block:: gdscript\n\n", text, flags=re.MULTILINE)
        page.write_text(text, encoding="utf-8")


def write_index(names):
    (PAGES / "index.rst").unlink()  # It also lists classes of the engine.
    listed = {name for group in GROUPS.values() for name in group}
    if listed != names:
        raise SystemExit(f"class_reference: GROUPS must list the classes of extension/doc_classes, not {sorted(listed ^ names)}")
    lines = ["# Class reference", "", "The editor shows the same pages: press F1 and search for a class.", ""]
    for heading, group in GROUPS.items():
        lines += [f"## {heading}", "", "| Class | Purpose |", "|---|---|"]
        for name in group:
            brief = ElementTree.parse(OURS / f"{name}.xml").findtext("brief_description").strip()
            lines.append(f"| [{name}](class_{name.lower()}.rst) | {as_markdown(brief)} |")
        lines += ["", "```{toctree}", ":hidden:", *(f"class_{name.lower()}" for name in group), "```", ""]
    (PAGES / "index.md").write_text("\n".join(lines), encoding="utf-8")


def as_markdown(text):
    text = re.sub(r"\[/?code\]", "`", text)
    return re.sub(r"\[(?:\w+ )?([\w.]+)\]", r"`\1`", text)


def main():
    shutil.rmtree(PAGES, ignore_errors=True)
    prepared = WORK / "classes"
    shutil.rmtree(prepared, ignore_errors=True)
    prepared.mkdir(parents=True)
    names = {path.stem for path in OURS.glob("*.xml") if not is_former(path)}
    for name in names:
        (prepared / f"{name}.xml").write_text(prepare(OURS / f"{name}.xml"), encoding="utf-8")
    write_engine_reference(WORK / "engine")
    write_pages(WORK / "engine", prepared)
    tidy_pages()
    write_index(names)


if __name__ == "__main__":
    main()
