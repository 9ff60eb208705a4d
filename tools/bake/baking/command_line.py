"""Code shared by the commands that write and read bakes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from .location import CannotLocate, is_local, location

if TYPE_CHECKING:
    from .location import Location

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


def place_argument(text: str) -> Location:
    """Returns the location for an argument of the command line: a path, a file:// URL, or the URL of an object store."""
    try:
        result = location(text)
    except CannotLocate as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if text.startswith("memory://"):
        raise argparse.ArgumentTypeError(f"'{text}' is the memory of this process, which other processes cannot read. Use a folder or an object store")
    return result


def folder_argument(text: str) -> Path:
    """Returns the folder for an argument of the command line: a path or a file:// URL."""
    try:
        result = location(text)
    except CannotLocate:
        result = None
    if result is None or not is_local(result):
        raise argparse.ArgumentTypeError(f"'{text}' must be a folder on this machine or a file:///... URL")
    return result
