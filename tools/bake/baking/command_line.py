"""Code shared by the commands that write and read bakes."""

from __future__ import annotations

from pathlib import Path

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
