"""Checks of the arguments of the master's methods.

Source: ROS's rosmaster/validators.py, with the same order of checks and the same texts.

Differences from ROS: the length of names, types and URIs is limited.
"""

from __future__ import annotations

from thbridge.rosgraph.values.names import ANY_TYPE, SEPARATOR, resolve
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue

LONGEST_NAME = 1024
"""Maximum number of characters of a name or a type."""

LONGEST_URI = 256
"""Maximum number of characters of a URI. The URIs of all subscribers of a topic are sent in one message."""


class InvalidArgumentError(Exception):
    """Raised for an argument that the method does not accept. The text is for the caller."""


def graph_name(value: XmlRpcValue, what: str, caller: str, root: bool = False) -> str:
    """Return the global name of a node, topic or service. If ``root``, the root namespace is allowed."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] must be a non-empty string")
    if ":" in value or " " in value:  # The value is probably a URI.
        raise InvalidArgumentError(f"ERROR: parameter [{what}] contains illegal chars")
    if value == SEPARATOR and not root:
        raise InvalidArgumentError(f"ERROR: parameter [{what}] cannot be the global namespace")
    return resolve(_short(value, what), caller)


def caller_id(value: XmlRpcValue) -> str:
    """Return the name of the calling node."""
    if not isinstance(value, str):
        raise InvalidArgumentError("caller_id must be a string")
    return _short(value, "caller_id")


def subgraph(value: XmlRpcValue, caller: str) -> str:
    """Return the global name of a namespace, or an empty text for the complete graph."""
    if not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [subgraph] must be a string")
    return value and resolve(_short(value, "subgraph"), caller)


def api_uri(value: XmlRpcValue, what: str = "caller_api") -> str:
    """Return the URI of a node's slave API or of a service."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] is not an XMLRPC URI")
    if not value.startswith(("http://", "rosrpc://")):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] is not an RPC URI")
    return _short(value, what, LONGEST_URI)


def topic_type(value: XmlRpcValue) -> str:
    """Return the name of a type with its package, or `ANY` for any type."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [topic_type] must be a non-empty string")
    if value != ANY_TYPE and value.count("/") != 1:
        raise InvalidArgumentError("ERROR: parameter [topic_type] is not a valid package resource name")
    return _short(value, "topic_type")


def relative_key(value: XmlRpcValue) -> str:
    """Return a parameter's name in the form that the caller used."""
    if not value:
        raise InvalidArgumentError("ERROR: parameter [key] must be specified and non-empty")
    if not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [key] must be a string")
    return _short(value, "key")


def global_key(value: XmlRpcValue, caller: str) -> str:
    """Return the global name of a parameter."""
    return resolve(relative_key(value), caller)


def _short(value: str, what: str, longest: int = LONGEST_NAME) -> str:
    if len(value) > longest:
        raise InvalidArgumentError(f"ERROR: parameter [{what}] is longer than {longest} characters")
    return value
