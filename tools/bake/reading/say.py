"""Prints messages for the user of a command."""

from __future__ import annotations

import sys


def say(text: str) -> None:
    """Prints a line to standard error."""
    print(f"thicket: {text}", file=sys.stderr, flush=True)
