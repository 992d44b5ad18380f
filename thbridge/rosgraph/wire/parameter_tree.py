"""Parameter tree of a ROS master.

Values are never changed in place. Setting a value builds new dicts along its path. So a value that was returned, or is
being sent to a subscriber, does not change.

Source: ROS's rosmaster/paramserver.py.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.rosgraph.values.names import SEPARATOR, is_global, is_private, join, parts
from thbridge.rosgraph.wire.xmlrpc import MAX_BYTES, MAX_DEPTH, MAX_ELEMENTS, DateTime, XmlRpcValue

_REPLY_DEPTH = 8
"""Maximum number of levels that a reply adds around a value: its own list, and the lists of a multicall."""

MAX_VALUES = MAX_ELEMENTS // 4
"""Maximum number of values, including namespaces. All of them fit into one document, so one call can return them."""

MAX_CHARACTERS = MAX_BYTES // 2
"""Maximum number of characters of all names and values together."""

_Wanted: TypeAlias = dict[str, "_Wanted"]
"""Subscribed keys below a namespace, as nested dicts. The keys of the dicts are the parts of their names."""


@dataclass(frozen=True, slots=True)
class ParameterUpdate:
    """New value of a subscribed parameter.

    Args:
        subscription: the subscribed key. It ends with a slash.
        key: the changed key: the subscribed key, a key above it, or a key below it. It ends with a slash.
        value: the new value. After a deletion, it is an empty dict.
        own: True if the node that has made the change must not be notified.
    """

    subscription: str
    key: str
    value: XmlRpcValue
    own: bool


@dataclass(frozen=True, slots=True)
class _Measure:
    """Size of a value: number of values with nested values, number of characters with names, number of levels."""

    values: int
    characters: int
    depth: int = 0


class ParameterTree:
    """Parameters by their global names. A namespace is a dict of its parameters and inner namespaces."""

    def __init__(self) -> None:
        self._root: dict[str, XmlRpcValue] = {}
        self._size = _measured(self._root)

    def get(self, key: str) -> XmlRpcValue:
        """Return a parameter, or the dict of a namespace.

        Raises:
            KeyError: there is no such parameter.
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
        """Set a parameter, or all parameters of a namespace. The present values are replaced.

        Raises:
            ValueError: the root would not be a dict, or one document could not contain the tree, because of its depth,
                its length or its number of values.
        """
        path = parts(key)
        measure = _measured(value)
        if len(path) + measure.depth > MAX_DEPTH - _REPLY_DEPTH:
            raise ValueError("the tree of parameters would be nested too deeply")
        if not path and not isinstance(value, dict):
            raise ValueError("cannot set root of parameter tree to non-dictionary")
        size = self._size_with(path, measure)
        if size.values > MAX_VALUES:
            raise ValueError(f"there would be more than {MAX_VALUES} parameters")
        if size.characters > MAX_CHARACTERS:
            raise ValueError(f"the parameters would be longer than {MAX_CHARACTERS} characters")
        self._root = _with(self._root, path, value) if path else value if isinstance(value, dict) else {}
        self._size = size

    def delete(self, key: str) -> None:
        """Delete a parameter or a namespace.

        Raises:
            KeyError: there is no such parameter, or it is the root.
        """
        path = parts(key)
        if not path:
            raise KeyError(key)
        gone = _measured(self.get(key))
        self._root = _without(self._root, path)
        self._size = _Measure(self._size.values - gone.values, self._size.characters - gone.characters - len(path[-1]))

    def _size_with(self, path: list[str], new: _Measure) -> _Measure:
        """Return the size of the tree with a new value at a path."""
        values, characters = self._size.values + new.values, self._size.characters + new.characters
        there: XmlRpcValue = self._root
        for at, part in enumerate(path):
            if isinstance(there, dict) and part in there:
                there = there[part]
                continue
            # The rest of the path is new. If there is a value on the path, it becomes a namespace.
            values += len(path) - at - 1
            characters += sum(map(len, path[at:]))
            if isinstance(there, dict):
                return _Measure(values, characters)
            values += 1
            break
        gone = _measured(there)
        return _Measure(values - gone.values, characters - gone.characters)

    def search(self, space: str, key: str) -> str | None:
        """Search for a parameter in a namespace, and then in each namespace that encloses it.

        Only the first part of the key is searched. If ``/robot1/map`` exists, a search for ``map/frame`` from
        ``/robot1/amcl`` finds ``/robot1/map/frame``, even if that parameter does not exist.

        Args:
            space: a global name, usually the name of the node.
            key: a relative key. A global key is searched only under exactly this name.

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
        names: list[str] = []
        _add_leaves(names, SEPARATOR, self._root)
        return names


def updates(subscriptions: Iterable[str], key: str, value: XmlRpcValue) -> list[ParameterUpdate]:
    """Return the updates that a change causes for the subscribed keys.

    Args:
        subscriptions: the subscribed keys. Each ends with a slash.
        key: the key that was set or deleted.
        value: its new value. After a deletion, it is an empty dict.
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
    caused: list[ParameterUpdate] = []
    gone = {each for each in inside if each not in below}
    for subscription in subscribed:
        if changed.startswith(subscription):
            caused.append(ParameterUpdate(subscription, changed, value, own=True))
        elif subscription in gone:
            caused.append(ParameterUpdate(subscription, subscription, {}, own=False))
    caused += [ParameterUpdate(name, name, inner, own=False) for name, inner in below.items() if name in subscribed]
    return caused


def _branches(key: str, value: XmlRpcValue, wanted: _Wanted) -> Iterator[tuple[str, XmlRpcValue]]:
    """Yield the wanted keys below a key, and all keys on the paths to them, with their values. Namespaces are first."""
    if isinstance(value, dict):
        for name, inner in value.items():
            if name in wanted:
                below = join(key, name) + SEPARATOR
                yield below, inner
                yield from _branches(below, inner, wanted[name])


def _add_leaves(names: list[str], space: str, tree: dict[str, XmlRpcValue]) -> None:
    for name, value in tree.items():
        whole = join(space, name) if name[:1] in ("", SEPARATOR, "~") else space + name
        if isinstance(value, dict):
            _add_leaves(names, whole.removesuffix(SEPARATOR) + SEPARATOR, value)
        else:
            names.append(whole)


def _measured(value: XmlRpcValue) -> _Measure:
    # A loop instead of recursion, because the depth is checked only after this.
    values = characters = depth = 0
    level = [value]
    while level:
        depth += 1
        values += len(level)
        below: list[XmlRpcValue] = []
        for each in level:
            if isinstance(each, str | bytes):
                characters += len(each)
            elif isinstance(each, dict):
                characters += sum(map(len, each))
                below += each.values()
            elif isinstance(each, list):
                below += each
            elif isinstance(each, DateTime):
                characters += len(each.text)
        level = below
    return _Measure(values, characters, depth)


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
