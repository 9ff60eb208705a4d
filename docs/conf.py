"""Configures Sphinx for docs/build.sh, and resolves the links that Sphinx does not know: to files of the repository, to
Godot's documentation, and from names of classes to the class reference."""

import configparser
import os
import re
from pathlib import Path

from docutils import nodes
from docutils.nodes import make_id
from pygments.lexers import GDScriptLexer
from pygments.token import Name
from sphinx.addnodes import pending_xref
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

logger = logging.getLogger(__name__)
DOCS = Path(__file__).resolve().parent
REPO = DOCS.parent
ENGINE = REPO / "build/docs/engine"
ENGINE_PAGES = "https://docs.godotengine.org/en/stable/classes/"
ADDON = REPO / "demo_project/addons/thicket"

# plugin.cfg is the only file with the version and with the addresses of the repository and of this site.
plugin = configparser.ConfigParser()
plugin.read(ADDON / "plugin.cfg", encoding="utf-8")
repository = plugin["thicket"]["repository"].strip('"')

project = "Thicket"
author = "The Thicket authors"
project_copyright = author
version = release = plugin["plugin"]["version"].strip('"')
language = "en"

extensions = ["myst_parser"]
exclude_patterns = ["requirements.txt"]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
highlight_language = "none"
pygments_style = "default"
pygments_dark_style = "github-dark"

html_theme = "furo"
html_title = f"Thicket {version}"
html_baseurl = plugin["thicket"]["documentation"].strip('"')
html_favicon = "../demo_project/icon.svg"
html_static_path = ["_static", "../demo_project/icon.svg", "../demo_project/pictures/film.mp4", "../demo_project/pictures/film.jpg"]
html_css_files = ["thicket.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "source_repository": repository + "/",
    "source_branch": "main",
    "source_directory": "docs/",
    "top_of_page_buttons": [],
    "light_logo": "icon.svg",
    "dark_logo": "icon.svg",
    "footer_icons": [],
}
# A Markdown link to a file of the repository outside docs/, which is not an image.
OUTSIDE = re.compile(r"(?<!!)(\[[^\[\]]+\])\(((?:\.\./)+[^)#\s]*)(#[^)]*)?\)")
# A name in code that must be a class or a member of a class: `ScatterLayer`, `ScatterLayer.density`, `PoissonSampler.sample()`.
OF_A_CLASS = re.compile(r"((?:Scatter|Poisson|TerrainScatter3D)\w*)(?:\.(\w+))?(?:\([^)]*\))?")
# The forge's pages that links of the documentation may lead to. A forge shows this folder three levels below them.
FORGE_PAGES = ("issues", "releases/latest")
# The pages that also contain names of older versions.
WITH_FORMER_NAMES = {"migration", "changelog"}


def link_to_repository(app, docname, source):
    """Makes links to files outside docs/, and to FORGE_PAGES, addresses in the repository. The files must exist."""
    folder = (DOCS / docname).parent

    def replaced(link):
        path = Path(os.path.normpath(folder / link.group(2)))
        if path.is_relative_to(DOCS):
            return link.group(0)
        for page in FORGE_PAGES:
            if path == REPO.parent.parent / page:
                return f"{link.group(1)}({repository}/{page})"
        if not path.is_relative_to(REPO) or not path.exists():
            logger.warning("the link to %s has no target", link.group(2), location=docname)
            return link.group(0)
        if path.parent == ADDON / "tutorials" and path.suffix == ".md":  # The site shows the same page.
            return f"{link.group(1)}({os.path.relpath(DOCS / 'tutorials' / path.name, folder)}{link.group(3) or ''})"
        kind = "tree" if path.is_dir() else "blob"
        return f"{link.group(1)}({repository}/{kind}/main/{path.relative_to(REPO).as_posix()}{link.group(3) or ''})"

    source[0] = OUTSIDE.sub(replaced, source[0])


class LinkFromIncludedFiles(SphinxTransform):
    """Resolves the links in a file outside docs/ that a page includes: to the page with the same content, or into the
    repository."""

    default_priority = 400

    def apply(self, **options):
        for node in list(self.document.findall(pending_xref)):
            if node.get("reftype") == "myst" and node["reftarget"].startswith("../../") and Path(node.source or "").parent == REPO:
                self.link(node, f"{repository}/{node['reftarget'].removeprefix('../../')}")  # A page of the forge.
                continue
            target, _, fragment = node["reftarget"].partition("#")
            path = Path(os.path.normpath(Path(node.source or "").parent / target))
            if path.is_relative_to(DOCS) and Path(node.source or "").parent == REPO and path.suffix == ".md" and path.is_file():
                node["refdomain"], node["reftarget"], node["reftargetid"] = "doc", path.relative_to(DOCS).with_suffix("").as_posix(), fragment or None
                continue
            if node.get("reftype") != "myst" or path.is_relative_to(DOCS) or not path.is_relative_to(REPO) or not path.exists():
                continue
            page = f"tutorials/{path.stem}" if path.parent == ADDON / "tutorials" else None
            page = "changelog" if path == REPO / "CHANGELOG.md" else page
            if page:
                node["refdomain"], node["reftarget"], node["reftargetid"] = "doc", page, None
            else:
                self.link(node, f"{repository}/blob/main/{path.relative_to(REPO).as_posix()}")

    def link(self, node, address):
        node.replace_self(nodes.reference("", "", *node.children, refuri=address, internal=False))


def link_to_engine(app, env, node, contnode):
    """Links a class, or a member, of the engine to Godot's documentation. make_rst.py has checked that the member exists."""
    found = re.match(r"(?:class|enum)_(@?[a-z0-9]+)(_|$)", node["reftarget"].lower()) if node.get("reftype") == "ref" else None
    if not found or found.group(1) not in engine_classes():
        return None
    anchor = "#" + make_id(node["reftarget"]) if found.group(2) or node["reftarget"].startswith("enum") else ""
    address = f"{ENGINE_PAGES}class_{found.group(1)}.html{anchor}"
    return nodes.reference("", "", contnode, refuri=address, internal=False)


def engine_classes():
    """Returns the lower-case names of all classes of the engine."""
    if not engine_classes.names:
        engine_classes.names = {path.stem.lower() for path in ENGINE.rglob("*.xml")}
    return engine_classes.names


engine_classes.names = set()


class LinkNames(SphinxTransform):
    """Links the names of classes in code to the class reference. An unknown class or member is an error, except for classes
    of the add-on's scripts, which have no page."""

    default_priority = 400

    def apply(self, **options):
        if self.env.docname in WITH_FORMER_NAMES:
            return
        for literal in list(self.document.findall(nodes.literal)):
            found = OF_A_CLASS.fullmatch(literal.astext())
            if not found or isinstance(literal.parent, (nodes.reference, pending_xref)) or found.group(1) in script_classes():
                continue
            name, member = found.groups()
            target = self.label(name, member)
            if target is None:
                logger.warning("%s is not in extension/doc_classes", literal.astext(), location=literal)
                continue
            link = pending_xref("", reftype="ref", refdomain="std", reftarget=target, refexplicit=True, refwarn=True, refdoc=self.env.docname)
            literal.replace_self(link)
            link += literal

    def label(self, name, member):
        page = DOCS / f"classes/class_{name.lower()}.rst"
        if not page.is_file():
            return None
        if not member:
            return f"class_{name}".lower()
        found = re.search(rf"^\.\. _((?:class_{name}_(?:property|method|private_method|signal|constant)|enum_{name})_{member}):$", page.read_text(encoding="utf-8"), re.MULTILINE)
        return found.group(1).lower() if found else None


def script_classes():
    """Returns the names of the global classes of the add-on's scripts."""
    return {name for path in ADDON.rglob("*.gd") for name in re.findall(r"^class_name (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)}


class Gdscript(GDScriptLexer):
    """Pygments' lexer of GDScript, with annotations such as @export."""

    tokens = {**GDScriptLexer.tokens, "root": [(r"@\w+", Name.Decorator), *GDScriptLexer.tokens["root"]]}


def setup(app):
    app.connect("source-read", link_to_repository)
    app.connect("missing-reference", link_to_engine)
    app.add_lexer("gdscript", Gdscript)
    app.add_transform(LinkFromIncludedFiles)
    app.add_transform(LinkNames)
    return {"parallel_read_safe": True}
