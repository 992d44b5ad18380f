"""Parameter tree of a ROS master.

Values are never changed in place: setting one rebuilds the branch that leads to it. So a value that was returned, or is
being sent to a subscriber, stays as it was.

Source: ROS's rosmaster/paramserver.py.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.protocols.rosgraph.names import SEPARATOR, is_global, is_private, join, parts
from thbridge.protocols.rosgraph.xmlrpc import MAX_BYTES, MAX_DEPTH, MAX_ELEMENTS, DateTime, XmlRpcValue

_REPLY_DEPTH = 8
"""Levels that a reply may put around a value: its list, and those of a multicall."""

MAX_VALUES = MAX_ELEMENTS // 4
"""Most values, namespaces included: as many as one document may hold, so that all can be asked for at once."""

MAX_CHARACTERS = MAX_BYTES // 2
"""Most characters of all names and values together."""

_Wanted: TypeAlias = dict[str, "_Wanted"]
"""Keys that are subscribed to below a namespace, as nested dicts of the parts of their names."""


@dataclass(frozen=True, slots=True)
class ParameterUpdate:
    """New value of a subscribed parameter.

    Args:
        subscription: the key that was subscribed, with a slash at its end.
        key: the key that changed, at, below or above the subscribed one, with a slash at its end.
        value: the new value; an empty dict when it was deleted.
        own: True when the node that made the change need not be notified, since it knows.
    """

    subscription: str
    key: str
    value: XmlRpcValue
    own: bool


class ParameterTree:
    """Parameters by their global names; a namespace is a dict of what is in it."""

    def __init__(self) -> None:
        self._root: dict[str, XmlRpcValue] = {}
        self._values, self._characters = _size(self._root)

    def get(self, key: str) -> XmlRpcValue:
        """Return a parameter, or the dict of a namespace.

        Raises:
            KeyError: there is none.
        """
        value: XmlRpcValue = self._root
        for part in parts(key):
            if not isinstance(value, dict):
                raise KeyError(key)
            value = value[part]
        return value

    def __contains__(self, key: str) -> bool:
        try:
            self.get(key)
        except KeyError:
            return False
        return True

    def set(self, key: str, value: XmlRpcValue) -> None:
        """Set a parameter, or a whole namespace at once; present values there are replaced.

        Raises:
            ValueError: the root would be no dict, or the tree too deep, too long or of too many values to be sent.
        """
        path = parts(key)
        if len(path) + _depth(value) > MAX_DEPTH - _REPLY_DEPTH:
            raise ValueError("the tree of parameters would be nested too deeply")
        if not path and not isinstance(value, dict):
            raise ValueError("cannot set root of parameter tree to non-dictionary")
        values, characters = self._size_with(path, value)
        if values > MAX_VALUES:
            raise ValueError(f"there would be more than {MAX_VALUES} parameters")
        if characters > MAX_CHARACTERS:
            raise ValueError(f"the parameters would be longer than {MAX_CHARACTERS} characters")
        self._root = _with(self._root, path, value) if path else value if isinstance(value, dict) else {}
        self._values, self._characters = values, characters

    def delete(self, key: str) -> None:
        """Delete a parameter or a namespace.

        Raises:
            KeyError: there is none, or it is the root.
        """
        path = parts(key)
        if not path:
            raise KeyError(key)
        values, characters = _size(self.get(key))
        self._root = _without(self._root, path)
        self._values -= values
        self._characters -= characters + len(path[-1])

    def _size_with(self, path: list[str], value: XmlRpcValue) -> tuple[int, int]:
        """Return the number of values and of characters that there would be with a value at a path."""
        values, characters = _size(value)
        there: XmlRpcValue = self._root
        for at, part in enumerate(path):
            if isinstance(there, dict) and part in there:
                there = there[part]
                continue
            # The rest of the path is new; a value that is in its way becomes a namespace.
            values += len(path) - at - 1
            characters += sum(map(len, path[at:]))
            if isinstance(there, dict):
                return self._values + values, self._characters + characters
            values += 1
            break
        gone, less = _size(there)
        return self._values + values - gone, self._characters + characters - less

    def search(self, space: str, key: str) -> str | None:
        """Look for a parameter in a namespace and then in each that encloses it.

        The first word of the key decides: with ``/robot1/map``, a search for ``map/frame`` from ``/robot1/amcl`` finds
        ``/robot1/map/frame``, whether that is there or not.

        Args:
            space: a global name, usually the node's.
            key: relative, or global to look in one place only.

        Raises:
            ValueError: the key is empty or private, or the namespace is not global.
        """
        if not key or is_private(key):
            raise ValueError("invalid key")
        if not is_global(space):
            raise ValueError("namespace must be global")
        if is_global(key):
            return key if key in self else None
        first = parts(key)[0]
        if join(space, first) in self:
            return join(space, key)
        path = parts(space)
        while path:
            path.pop()
            enclosing = SEPARATOR + SEPARATOR.join(path)
            if join(enclosing, first) in self:
                return join(enclosing, key)
        return None

    def names(self) -> list[str]:
        """Return the global names of all parameters, without namespaces."""
        return [*_leaves(SEPARATOR, self._root)]


def updates(subscriptions: Iterable[str], key: str, value: XmlRpcValue) -> list[ParameterUpdate]:
    """Return the updates that a change causes for the subscribed keys.

    Args:
        subscriptions: the subscribed keys, each with a slash at its end.
        key: the one that was set or deleted.
        value: its new value; an empty dict after a deletion.
    """
    changed = key.removesuffix(SEPARATOR) + SEPARATOR
    subscribed = dict.fromkeys(subscriptions)
    inside = [each for each in subscribed if each.startswith(changed)] if isinstance(value, dict) else []
    wanted: _Wanted = {}
    for subscription in inside:
        level = wanted
        for part in parts(subscription.removeprefix(changed)):
            level = level.setdefault(part, {})
    below = dict(_branches(changed, value, wanted))
    told: list[ParameterUpdate] = []
    gone = {each for each in inside if each not in below}
    for subscription in subscribed:
        if changed.startswith(subscription):
            told.append(ParameterUpdate(subscription, changed, value, own=True))
        elif subscription in gone:
            told.append(ParameterUpdate(subscription, subscription, {}, own=False))
    told += [ParameterUpdate(name, name, inner, own=False) for name, inner in below.items() if name in subscribed]
    return told


def _branches(key: str, value: XmlRpcValue, wanted: _Wanted) -> Iterator[tuple[str, XmlRpcValue]]:
    """Yield the wanted keys below a key, and those on the way to them, with their values, namespaces first."""
    if isinstance(value, dict):
        for name, inner in value.items():
            if name in wanted:
                below = join(key, name) + SEPARATOR
                yield below, inner
                yield from _branches(below, inner, wanted[name])


def _leaves(key: str, tree: dict[str, XmlRpcValue]) -> Iterator[str]:
    for name, value in tree.items():
        if isinstance(value, dict):
            yield from _leaves(join(key, name), value)
        else:
            yield join(key, name)


def _size(value: XmlRpcValue) -> tuple[int, int]:
    """Return the number of values, those inside included, and of characters in a value."""
    values = characters = 0
    waiting = [value]
    while waiting:
        each = waiting.pop()
        values += 1
        if isinstance(each, dict):
            characters += sum(map(len, each))
            waiting += each.values()
        elif isinstance(each, list):
            waiting += each
        elif isinstance(each, str | bytes):
            characters += len(each)
        elif isinstance(each, DateTime):
            characters += len(each.text)
    return values, characters


def _depth(value: XmlRpcValue) -> int:
    if isinstance(value, dict):
        return 1 + max(map(_depth, value.values()), default=0)
    if isinstance(value, list):
        return 1 + max(map(_depth, value), default=0)
    return 1


def _with(tree: dict[str, XmlRpcValue], path: list[str], value: XmlRpcValue) -> dict[str, XmlRpcValue]:
    first, *rest = path
    if not rest:
        return {**tree, first: value}
    inner = tree.get(first)
    return {**tree, first: _with(inner if isinstance(inner, dict) else {}, rest, value)}


def _without(tree: dict[str, XmlRpcValue], path: list[str]) -> dict[str, XmlRpcValue]:
    first, *rest = path
    if not rest:
        if first not in tree:
            raise KeyError(first)
        return {name: value for name, value in tree.items() if name != first}
    inner = tree[first]
    if not isinstance(inner, dict):
        raise KeyError(first)
    return {**tree, first: _without(inner, rest)}
