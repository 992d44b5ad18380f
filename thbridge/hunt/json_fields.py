"""Strict reading of JSON objects: every field is typed, none may be missing or left over."""

import json
import math
from collections.abc import Mapping, Sequence

Json = None | bool | int | float | str | Sequence["Json"] | Mapping[str, "Json"]
"""A value that JSON can represent."""


def dumps(value: Json) -> str:
    """Return compact JSON on one line, keys in the order given; ASCII only. Raises ValueError for NaN and infinity."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


class Fields:
    """The fields of one JSON object, each to be taken exactly once.

    Every method raises ValueError with a sentence naming the field when it is missing or not of that type.
    """

    def __init__(self, value: object) -> None:
        if not isinstance(value, dict):
            raise ValueError("expected a JSON object")
        self._left: dict[str, object] = dict(value)

    @classmethod
    def of_text(cls, text: str) -> "Fields":
        """Parse a JSON text. Raises ValueError if it is not JSON, not an object, or has a key twice."""
        try:
            return cls(json.loads(text, object_pairs_hook=_unique))
        except RecursionError:
            raise ValueError("JSON nested too deeply") from None

    def take(self, name: str) -> object:
        """Return a field of any type."""
        if name not in self._left:
            raise ValueError(f"the field {name!r} is missing")
        return self._left.pop(name)

    def integer(self, name: str) -> int:
        """Return an integer; true and false are none."""
        value = self.take(name)
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError(f"the field {name!r} is not a whole number")
        return value

    def number(self, name: str) -> float:
        """Return a finite number."""
        return _number(name, self.take(name))

    def text(self, name: str) -> str:
        """Return a string."""
        value = self.take(name)
        if not isinstance(value, str):
            raise ValueError(f"the field {name!r} is not a text")
        return value

    def optional_integer(self, name: str) -> int | None:
        """Return an integer, or None for null."""
        return None if self._is_null(name) else self.integer(name)

    def optional_text(self, name: str) -> str | None:
        """Return a string, or None for null."""
        return None if self._is_null(name) else self.text(name)

    def objects(self, name: str) -> tuple["Fields", ...]:
        """Return a list of objects."""
        return tuple(Fields(value) for value in _list(name, self.take(name)))

    def number_rows(self, name: str, null: float) -> tuple[tuple[float, ...], ...]:
        """Return a list of lists of numbers, with `null` for each null."""
        return tuple(
            tuple(null if value is None else _number(name, value) for value in _list(name, row))
            for row in _list(name, self.take(name))
        )

    def end(self) -> None:
        """Raise ValueError if a field has not been taken, because its meaning is unknown."""
        if self._left:
            raise ValueError(f"unknown field {min(self._left)!r}")

    def _is_null(self, name: str) -> bool:
        if name in self._left and self._left[name] is None:
            del self._left[name]
            return True
        return False


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"the field {name!r} is not a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"the field {name!r} is not a finite number")
    return number


def _list(name: str, value: object) -> list[object]:
    if not isinstance(value, list):
        raise ValueError(f"the field {name!r} is not a list")
    return value


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    fields = dict(pairs)
    if len(fields) != len(pairs):
        raise ValueError("a field is said twice")
    return fields
