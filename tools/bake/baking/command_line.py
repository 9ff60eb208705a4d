"""Code shared by the commands that write and read bakes."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from urllib.parse import unquote, urlsplit

REPO = Path(__file__).resolve().parents[3]


def with_values(arguments: list[str], options: tuple[str, ...]) -> list[str]:
    """Joins these options and their values with "=". Otherwise argparse would treat a value that begins with a minus
    sign as an option."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in options:
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined


def folder_argument(text: str) -> Path:
    """Returns the folder for an argument of the command line: a path, or a file:// URL. Rejects all other URLs, because they
    would become folders with the name of the scheme."""
    if not re.match(r"[A-Za-z][A-Za-z0-9+.-]*://", text):
        return Path(text)
    url = urlsplit(text)
    if url.scheme.lower() != "file" or url.netloc not in ("", "localhost"):
        raise argparse.ArgumentTypeError(f"'{text}' must be a folder on this machine or a file:///... URL. Use a local folder and copy it, or mount the store as a folder")
    return Path(unquote(url.path))
