"""Checks values from JSON. A check is a function that raises InvalidValue, with the field's name and allowed values, for an
invalid value."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable

Check = Callable[[object], None]

MAX_CHARACTERS = 1000
_MAX_PRINTED = 80  # The number of characters to print of an invalid value.


class InvalidValue(ValueError):
    """Raised for a value that is not allowed. The message has no period at its end: `layers[0].radius must be a number ..., got
    null`."""

    def __init__(self, value: object, allowed: str):
        super().__init__()
        self.value, self.allowed, self.path = value, allowed, ""

    def within(self, name: str) -> InvalidValue:
        """Adds the name of the enclosing field, or an index [I], in front of the path. Returns this error."""
        self.path = name + (f".{self.path}" if self.path and not self.path.startswith("[") else self.path)
        return self

    def __str__(self) -> str:
        return f"{self.path or 'it'} must be {self.allowed}, got {as_text(self.value)}"


class Missing(InvalidValue):
    """Raised if a required field is missing."""

    def __str__(self) -> str:
        return f"{self.path} is missing, but is required"


def as_text(value: object) -> str:
    """Returns the beginning of a value as text; for an object or an array, its number of entries instead."""
    if isinstance(value, (dict, list)):
        return f"an {'object' if isinstance(value, dict) else 'array'} with {len(value)} entries"
    try:
        return json.dumps(value)[:_MAX_PRINTED]
    except ValueError:  # The value is an integer with thousands of digits.
        return "a huge number"


def number(minimum: float, maximum: float, allowed: str = "") -> Check:
    """Returns a check that accepts a finite number in a range."""
    allowed = allowed or f"a number from {minimum:g} to {maximum:g}"

    def check(value: object) -> None:
        if type(value) not in (int, float) or not minimum <= value <= maximum:
            raise InvalidValue(value, allowed)

    return check


def integer(minimum: int, maximum: int) -> Check:
    """Returns a check that accepts an integer in a range."""
    allowed = f"a whole number from {minimum} to {maximum}"

    def check(value: object) -> None:
        if type(value) not in (int, float) or not minimum <= value <= maximum or value != int(value):
            raise InvalidValue(value, allowed)

    return check


def text(pattern: str = "", allowed: str = "", max_length: int = MAX_CHARACTERS) -> Check:
    """Returns a check that accepts a string of at most `max_length` characters. The whole string must match the pattern. By
    default, it must not contain a zero character or half of a surrogate pair."""
    allowed = allowed or f"a string of at most {max_length} characters, none of them a zero or half of a surrogate pair"
    expression = re.compile(pattern or r"[^\0\ud800-\udfff]*")

    def check(value: object) -> None:
        if type(value) is not str or len(value) > max_length or not expression.fullmatch(value):
            raise InvalidValue(value, allowed)

    return check


def flag(value: object) -> None:
    """Checks that the value is true or false."""
    if type(value) is not bool:
        raise InvalidValue(value, "true or false")


def nullable(check: Check) -> Check:
    """Returns a check that accepts null, and any value that `check` accepts."""

    def check_or_null(value: object) -> None:
        if value is not None:
            try:
                check(value)
            except InvalidValue as invalid:
                invalid.allowed += ", or null" if not invalid.path else ""
                raise

    return check_or_null


def items(check: Check, min_count: int = 0, max_count: int = 1 << 20) -> Check:
    """Returns a check that accepts an array with `min_count` to `max_count` values, all of which `check` accepts."""
    allowed = f"an array of {min_count} values" if min_count == max_count else f"an array of {min_count} to {max_count} values"

    def check_items(value: object) -> None:
        if type(value) is not list or not min_count <= len(value) <= max_count:
            raise InvalidValue(value, allowed)
        for index, item in enumerate(value):
            try:
                check(item)
            except InvalidValue as invalid:
                raise invalid.within(f"[{index}]") from None

    return check_items


def members(checks: dict[str, Check], needed: Iterable[str] = ()) -> Check:
    """Returns a check that accepts an object with all `needed` fields. Fields in `checks` must pass their checks. All
    other fields may have any value."""
    needed = tuple(needed)

    def check_members(value: object) -> None:
        if type(value) is not dict:
            raise InvalidValue(value, "an object")
        for name in needed:
            if name not in value:
                raise Missing(None, "").within(name)
        for name, check in checks.items():
            if name in value:
                try:
                    check(value[name])
                except InvalidValue as invalid:
                    raise invalid.within(name) from None

    return check_members


def mapping(key: Check, check: Check, max_count: int) -> Check:
    """Returns a check that accepts an object with at most `max_count` fields whose names pass `key` and whose values
    pass `check`."""

    def check_mapping(value: object) -> None:
        if type(value) is not dict or len(value) > max_count:
            raise InvalidValue(value, f"an object of at most {max_count} fields")
        for name, item in value.items():
            try:
                key(name)
                check(item)
            except InvalidValue as invalid:
                raise invalid.within(f"[{json.dumps(name)[:_MAX_PRINTED]}]") from None

    return check_mapping


def without_repeats(pairs: list[tuple[str, object]]) -> dict:
    """Returns the object with these fields, or raises ValueError if a field occurs twice. For `object_pairs_hook` of
    `json.loads`."""
    fields = dict(pairs)
    if len(fields) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the field {json.dumps(next(name for name in names if names.count(name) > 1))[:_MAX_PRINTED]} occurs twice")
    return fields
