"""Errors and warnings in the output of an engine."""

import re

COMPLAINT = re.compile(r"^(?:SCRIPT |USER |SHADER )?(?:ERROR|WARNING)\b.*", re.MULTILINE)
# The software renderer and a machine without sound or certificates print these.
HARMLESS = ("V-Sync mode", "audio driver", "X509")


def complaints(printed: str) -> list[str]:
    """The lines with an error or a warning, except those that the machine causes."""
    return [line for line in COMPLAINT.findall(printed) if not any(words in line for words in HARMLESS)]
