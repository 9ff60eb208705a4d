"""Checks values from JSON. A check is a function that raises Refused, with the field's name and allowed values, for an
invalid value."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable

Check = Callable[[object], None]

MAX_CHARACTERS = 1000
_SHOWN = 80  # The number of characters to print of an invalid value.


class Refused(ValueError):
    """Raised for a value that is not allowed. The message has no period at its end: `layers[0].radius must be a number ..., got
    null`."""

    def __init__(self, value: object, allowed: str):
        super().__init__()
        self.value, self.allowed, self.path = value, allowed, ""

    def within(self, name: str) -> Refused:
        """Adds the name of the enclosing field, or an index [I], in front of the path. Returns this error."""
        self.path = name + (f".{self.path}" if self.path and not self.path.startswith("[") else self.path)
        return self

    def __str__(self) -> str:
        return f"{self.path or 'it'} must be {self.allowed}, got {shown(self.value)}"


class Missing(Refused):
    """Raised if a required field is missing."""

    def __str__(self) -> str:
        return f"{self.path} is missing, but is required"


def shown(value: object) -> str:
    """Returns the beginning of a value as text; for an object or an array, its number of entries instead."""
    if isinstance(value, (dict, list)):
        return f"an {'object' if isinstance(value, dict) else 'array'} with {len(value)} entries"
    try:
        return json.dumps(value)[:_SHOWN]
    except ValueError:  # The value is an integer with thousands of digits.
        return "a huge number"


def number(least: float, most: float, allowed: str = "") -> Check:
    """Returns a check that accepts a finite number in a range."""
    allowed = allowed or f"a number from {least:g} to {most:g}"

    def check(value: object) -> None:
        if type(value) not in (int, float) or not least <= value <= most:
            raise Refused(value, allowed)

    return check


def whole(least: int, most: int) -> Check:
    """Returns a check that accepts an integer in a range."""
    allowed = f"a whole number from {least} to {most}"

    def check(value: object) -> None:
        if type(value) not in (int, float) or not least <= value <= most or value != int(value):
            raise Refused(value, allowed)

    return check


def text(pattern: str = "", allowed: str = "", most: int = MAX_CHARACTERS) -> Check:
    """Returns a check that accepts a string of at most `most` characters. The whole string must match the pattern. By default,
    it must not contain a zero character or half of a surrogate pair."""
    allowed = allowed or f"a string of at most {most} characters, none of them a zero or half of a surrogate pair"
    form = re.compile(pattern or r"[^\0\ud800-\udfff]*")

    def check(value: object) -> None:
        if type(value) is not str or len(value) > most or not form.fullmatch(value):
            raise Refused(value, allowed)

    return check


def flag(value: object) -> None:
    """Checks that the value is true or false."""
    if type(value) is not bool:
        raise Refused(value, "true or false")


def nullable(check: Check) -> Check:
    """Returns a check that accepts null, and any value that `check` accepts."""

    def check_or_null(value: object) -> None:
        if value is not None:
            try:
                check(value)
            except Refused as refused:
                refused.allowed += ", or null" if not refused.path else ""
                raise

    return check_or_null


def items(check: Check, least: int = 0, most: int = 1 << 20) -> Check:
    """Returns a check that accepts an array with `least` to `most` values, all of which `check` accepts."""
    allowed = f"an array of {least} values" if least == most else f"an array of {least} to {most} values"

    def check_items(value: object) -> None:
        if type(value) is not list or not least <= len(value) <= most:
            raise Refused(value, allowed)
        for number, item in enumerate(value):
            try:
                check(item)
            except Refused as refused:
                raise refused.within(f"[{number}]") from None

    return check_items


def members(checks: dict[str, Check], needed: Iterable[str] = ()) -> Check:
    """Returns a check that accepts an object with all `needed` fields. Fields in `checks` must pass their checks. All
    other fields may have any value."""
    needed = tuple(needed)

    def check_members(value: object) -> None:
        if type(value) is not dict:
            raise Refused(value, "an object")
        for name in needed:
            if name not in value:
                raise Missing(None, "").within(name)
        for name, check in checks.items():
            if name in value:
                try:
                    check(value[name])
                except Refused as refused:
                    raise refused.within(name) from None

    return check_members


def mapping(key: Check, check: Check, most: int) -> Check:
    """Returns a check that accepts an object with at most `most` fields whose names pass `key` and whose values pass
    `check`."""

    def check_mapping(value: object) -> None:
        if type(value) is not dict or len(value) > most:
            raise Refused(value, f"an object of at most {most} fields")
        for name, item in value.items():
            try:
                key(name)
                check(item)
            except Refused as refused:
                raise refused.within(f"[{json.dumps(name)[:_SHOWN]}]") from None

    return check_mapping


def without_repeats(pairs: list[tuple[str, object]]) -> dict:
    """Returns the object with these fields, or raises ValueError if a field occurs twice. For `object_pairs_hook` of
    `json.loads`."""
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the field {json.dumps(next(name for name in names if names.count(name) > 1))[:_SHOWN]} occurs twice")
    return found
