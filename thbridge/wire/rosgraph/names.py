"""Names of the ROS graph: nodes, topics, services, parameters.

Source: http://wiki.ros.org/Names; ROS's rosgraph/names.py, whose results these functions share, odd names included.
"""

from __future__ import annotations

SEPARATOR = "/"
ANY_TYPE = "*"
"""The type of a topic whose type its subscriber does not mind."""


def is_global(name: str) -> bool:
    """Whether a name says its whole path, like ``/robot1/odom``."""
    return name.startswith("/")


def is_private(name: str) -> bool:
    """Whether a name is below that of its node, like ``~rate``."""
    return name.startswith("~")


def canonical(name: str) -> str:
    """A name without doubled slashes and without one at its end."""
    path = SEPARATOR.join(parts(name))
    return SEPARATOR + path if is_global(name) else path


def parts(name: str) -> list[str]:
    """The words between a name's slashes."""
    return [part for part in name.split(SEPARATOR) if part]


def namespace(name: str) -> str:
    """What a name stands in, with a slash at its end: that of ``/robot1/odom`` is ``/robot1/``."""
    return name.removesuffix(SEPARATOR).rpartition(SEPARATOR)[0] + SEPARATOR


def join(space: str, name: str) -> str:
    """A name below a namespace; one that is global or private stays as it is."""
    if is_global(name) or is_private(name) or not space:
        return name
    return space.removesuffix(SEPARATOR) + SEPARATOR + name


def resolve(name: str, node: str) -> str:
    """The global name that a node means.

    Args:
        name: as the node says it; the empty one is the node's namespace.
        node: the node's own global name, its caller id.
    """
    if not name:
        return namespace(node)
    if is_private(name):
        return canonical(f"{node}/{name[1:]}")
    return canonical(name) if is_global(name) else namespace(node) + canonical(name)
