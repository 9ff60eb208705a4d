"""Prints the release notes of a version: its section of CHANGELOG.md. Fails if the tag, the add-on's version and the section do not match.

python3 tools/package/notes.py v0.3.0
"""

import re
import sys

import contents


def notes(changes, version):
    """Returns the text below the heading "## [VERSION] - DATE" of a change log, or None if there is no such section or it is
    empty."""
    match = re.search(r"^## \[%s\] - [^\n]*\n(.*?)(?=^## |^\[[\d.]+\]: |\Z)" % re.escape(version), changes, re.MULTILINE | re.DOTALL)
    return (match.group(1).strip() or None) if match else None


def main(tag):
    version = contents.version()
    if tag != "v" + version:
        raise SystemExit("thicket: the tag must be v%s, the version in plugin.cfg, got %s: change the version, or create that tag" % (version, tag))
    text = notes((contents.REPO / "CHANGELOG.md").read_text(encoding="utf-8"), version)
    if text is None:
        raise SystemExit("thicket: CHANGELOG.md must have a section '## [%s] - DATE' with the changes: add it" % version)
    print(contents.with_addresses(text))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit("usage: python3 tools/package/notes.py TAG")
    main(sys.argv[1])
