"""Finds sources and separates those with a main function from those that programs share."""

import glob
import os
import re

MAIN = re.compile(r"^\s*(?:auto|int)\s+main\s*\(|LLVMFuzzerTestOneInput\s*\(", re.MULTILINE)


def find(root, patterns):
    """Returns the sorted paths, relative to root, of all files that match a pattern. Skips hidden files and folders."""
    found = set()
    for pattern in patterns:
        found.update(glob.glob(pattern, root_dir=root, recursive=True))
    return sorted(path.replace(os.sep, "/") for path in found)


def split(root, pattern):
    """Returns (programs, shared): the files with a main function, each of which becomes a program, and the files that
    are linked into all of them."""
    mains, shared = [], []
    for path in find(root, [pattern]):
        with open(os.path.join(root, path), encoding="utf-8") as source:
            (mains if MAIN.search(source.read()) else shared).append(path)
    return mains, shared
