"""What is said to whoever runs the command."""

from __future__ import annotations

import sys


def say(text: str) -> None:
    """A line on the standard error: what is written goes to files."""
    print(f"thicket: {text}", file=sys.stderr, flush=True)
