"""Finds errors and warnings in the output of an engine."""

import re

COMPLAINT = re.compile(r"^(?:SCRIPT |USER |SHADER )?(?:ERROR|WARNING)\b.*", re.MULTILINE)
# Parts of messages that the software renderer prints, or machines without sound or certificates.
HARMLESS = ("V-Sync mode", "audio driver", "X509")


def complaints(printed: str) -> list[str]:
    """Returns the lines with an error or a warning, except those that the machine causes."""
    return [line for line in COMPLAINT.findall(printed) if not any(words in line for words in HARMLESS)]
