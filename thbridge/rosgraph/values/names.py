"""Names of the ROS graph: nodes, topics, services, parameters.

Source: http://wiki.ros.org/Names; ROS's rosgraph/names.py, with the same results, even for malformed names.
"""

from __future__ import annotations

SEPARATOR = "/"
ANY_TYPE = "*"
"""Type of a subscription to a topic of any type."""


def is_global(name: str) -> bool:
    """Return True for a global name: a complete path, such as ``/robot1/odom``."""
    return name.startswith("/")


def is_private(name: str) -> bool:
    """Return True for a private name, which is relative to its node, such as ``~rate``."""
    return name.startswith("~")


def canonical(name: str) -> str:
    """Return a name without double slashes and without a slash at its end."""
    path = SEPARATOR.join(parts(name))
    return SEPARATOR + path if is_global(name) else path


def parts(name: str) -> list[str]:
    """Return the parts between a name's slashes."""
    return [part for part in name.split(SEPARATOR) if part]


def namespace(name: str) -> str:
    """Return the namespace of a name, with a slash at its end: ``/robot1/`` for ``/robot1/odom``."""
    return name.removesuffix(SEPARATOR).rpartition(SEPARATOR)[0] + SEPARATOR


def join(space: str, name: str) -> str:
    """Return a name below a namespace. Global and private names do not change."""
    if is_global(name) or is_private(name) or not space:
        return name
    return space.removesuffix(SEPARATOR) + SEPARATOR + name


def resolve(name: str, node: str) -> str:
    """Resolve a name used by a node to the global name.

    Args:
        name: name that the node uses. The empty name means the node's namespace.
        node: the node's own global name (its caller id).
    """
    if not name:
        return namespace(node)
    if is_private(name):
        return canonical(f"{node}/{name[1:]}")
    return canonical(name) if is_global(name) else namespace(node) + canonical(name)
