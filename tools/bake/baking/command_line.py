"""What the commands that make bakes and read them have in common."""

from __future__ import annotations

from pathlib import Path

REPO = Path(__file__).resolve().parents[3]


def with_values(arguments: list[str], options: tuple[str, ...]) -> list[str]:
    """The arguments with these options joined to their values, which may begin with a minus: argparse would take them for other options."""
    joined: list[str] = []
    for argument in arguments:
        if joined and joined[-1] in options:
            joined[-1] += f"={argument}"
        else:
            joined.append(argument)
    return joined
