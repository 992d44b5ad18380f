"""Log levels of a session. Clients such as rqt_logger_level use the same services as for each node of roscpp."""

import logging

from thbridge.app.live_graph.typed_node import TypedNode
from thbridge.ros import clients
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.messages.pack.fields import UINT32, string
from thbridge.ros.names import CALLER
from thbridge.rosgraph.wire.links import ServiceFailed

LOGGERS = ("thbridge", "sim", "ui")
"""Loggers whose levels can be read and set, one for each package."""
_LEVELS = {
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warn": logging.WARNING,
    "error": logging.ERROR,
    "fatal": logging.CRITICAL,
}


def offer_loggers(node: TypedNode) -> None:
    """Offer the services `get_loggers` and `set_logger_level` of our node."""
    node.serve(f"{CALLER}/get_loggers", types.GET_LOGGERS, _get)
    node.serve(f"{CALLER}/set_logger_level", types.SET_LOGGER_LEVEL, _set)


def _get(request: bytes) -> bytes:
    rows = [string(name) + string(_word(logging.getLogger(name).getEffectiveLevel())) for name in LOGGERS]
    return UINT32.pack(len(rows)) + b"".join(rows)


def _word(level: int) -> str:
    """Return the ROS name of a Python level: the highest ROS level that is not above the Python level."""
    return next((word for word, known in reversed(_LEVELS.items()) if known <= level), "debug")


def _set(request: bytes) -> bytes | ServiceFailed:
    asked = clients.logger_level(request)
    if isinstance(asked, InvalidMessage):
        return ServiceFailed(asked.sentence)
    level = _LEVELS.get(asked.level.lower())
    if level is None:
        return ServiceFailed(f"there is no level {asked.level!r}. Use one of these levels: {', '.join(_LEVELS)}")
    if asked.logger not in LOGGERS:
        return ServiceFailed(f"there is no logger {asked.logger!r}. Use one of these loggers: {', '.join(LOGGERS)}")
    logging.getLogger(asked.logger).setLevel(level)
    return b""
