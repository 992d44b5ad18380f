"""What the master's methods take for valid arguments.

Source: ROS's rosmaster/validators.py, whose order of checks and texts these are.
"""

from __future__ import annotations

from thbridge.wire.rosgraph.names import ANY_TYPE, SEPARATOR, resolve
from thbridge.wire.rosgraph.xmlrpc import XmlRpcValue


class InvalidArgumentError(Exception):
    """An argument is not what the method wants; the text is for the caller."""


def graph_name(value: XmlRpcValue, what: str, caller: str, root: bool = False) -> str:
    """The global name of a node, topic or service that is meant; the root namespace is one where ``root`` says so."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] must be a non-empty string")
    if ":" in value or " " in value:  # a URI, most likely
        raise InvalidArgumentError(f"ERROR: parameter [{what}] contains illegal chars")
    if value == SEPARATOR and not root:
        raise InvalidArgumentError(f"ERROR: parameter [{what}] cannot be the global namespace")
    return resolve(value, caller)


def subgraph(value: XmlRpcValue, caller: str) -> str:
    """The global name of a namespace; empty for the whole graph."""
    if not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [subgraph] must be a string")
    return value and resolve(value, caller)


def api_uri(value: XmlRpcValue, what: str = "caller_api") -> str:
    """The URI of a node's slave API or of a service."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] is not an XMLRPC URI")
    if not value.startswith(("http://", "rosrpc://")):
        raise InvalidArgumentError(f"ERROR: parameter [{what}] is not an RPC URI")
    return value


def topic_type(value: XmlRpcValue) -> str:
    """A type's name, package and all, or the one that stands for any."""
    if not value or not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [topic_type] must be a non-empty string")
    if value != ANY_TYPE and value.count("/") != 1:
        raise InvalidArgumentError("ERROR: parameter [topic_type] is not a valid package resource name")
    return value


def relative_key(value: XmlRpcValue) -> str:
    """A parameter's name as the caller says it."""
    if not value:
        raise InvalidArgumentError("ERROR: parameter [key] must be specified and non-empty")
    if not isinstance(value, str):
        raise InvalidArgumentError("ERROR: parameter [key] must be a string")
    return value


def global_key(value: XmlRpcValue, caller: str) -> str:
    """The global name of a parameter that is meant."""
    return resolve(relative_key(value), caller)
