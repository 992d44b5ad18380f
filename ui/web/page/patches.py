"""Trees of JSON values, and the differences between two of them.

A browser keeps the tree of its page. The server sends only the difference to the next tree. A difference is an object
with one key:

- `v`: the new value replaces the old one;
- `f`: an object with the differences of fields; all other fields are unchanged;
- `l`: a list of three: the new length of the list, an object with the differences of elements by their index, and the
  values of the elements that follow them.

`static/patches.js` applies them.
"""

from dataclasses import fields, is_dataclass
from enum import Enum
from typing import TypeAlias

from ui.model.playing.screen import Act

Json: TypeAlias = "bool | int | float | str | list[Json] | dict[str, Json] | None"


UNCHANGED: dict[str, Json] = {"f": {}}
"""Difference between two equal trees that are objects."""


def tree(value: object) -> Json:
    """Return a value as JSON: a dataclass as an object with its fields, an act also with the name of its class.

    Raises:
        TypeError: the value has no form in JSON.
    """
    match value:
        case None | bool() | int() | float() | str():
            return value.value if isinstance(value, Enum) else value
        case tuple() | list():
            return [tree(each) for each in value]
        case dict():
            return {str(key): tree(each) for key, each in value.items()}
        case Act():
            return {"act": type(value).__name__, **{name: tree(getattr(value, name)) for name in _names(type(value))}}
        case _ if is_dataclass(value):
            return {name: tree(getattr(value, name)) for name in _names(type(value))}
        case _:
            raise TypeError(f"{type(value).__name__} has no form in JSON")


def patch(before: object, after: object) -> dict[str, Json] | None:
    """Return the difference that leads from one value to another; None if they are equal."""
    if before is after:
        return None
    if type(before) is not type(after) or isinstance(after, Act):
        return None if before == after else {"v": tree(after)}
    if is_dataclass(after):
        changed: dict[str, Json] = {}
        for name in _names(type(after)):
            difference = patch(getattr(before, name), getattr(after, name))
            if difference is not None:
                changed[name] = difference
        return {"f": changed} if changed else None
    if isinstance(before, tuple) and isinstance(after, tuple):
        return _patch_list(before, after)
    return None if before == after else {"v": tree(after)}


def _patch_list(before: tuple[object, ...], after: tuple[object, ...]) -> dict[str, Json] | None:
    changed: dict[str, Json] = {}
    for index, (old, new) in enumerate(zip(before, after, strict=False)):
        difference = patch(old, new)
        if difference is not None:
            changed[str(index)] = difference
    if not changed and len(before) == len(after):
        return None
    if changed and len(changed) == len(after):
        # Every element differs, so their differences save nothing.
        return {"v": tree(after)}
    return {"l": [len(after), changed, [tree(each) for each in after[len(before) :]]]}


_NAMES: dict[type, tuple[str, ...]] = {}


def _names(kind: type) -> tuple[str, ...]:
    """Return the names of a class's fields; computed once for each class."""
    names = _NAMES.get(kind)
    if names is None:
        names = _NAMES[kind] = tuple(field.name for field in fields(kind))
    return names
