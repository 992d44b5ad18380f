"""Master of a graph. If there is none, this program may start one."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from enum import Enum
from urllib.parse import urlsplit

from thbridge.rosgraph.sockets.http_client import CallFailed, XmlRpcClient
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.sockets.addresses import ROS_MASTER_PORT, ROS_MASTER_URI
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen

_ANSWER_TIMEOUT = 2.0
"""Timeout in seconds for a master's answer to the first call."""
_OURS = frozenset({"127.0.0.1", "localhost", "::1"})


@dataclass(frozen=True, slots=True)
class GraphAddress:
    """Address of a ROS graph.

    Attributes:
        master_uri: URI of the master, ``http://HOST:PORT``.
        host: own address. This program listens on it, and other nodes call it there. Every program that can connect to
            it can drive robots.
        admission: decides by address which nodes and tools are accepted.
    """

    master_uri: str = ROS_MASTER_URI
    host: str = "127.0.0.1"
    admission: Admission = OWN_MACHINE


class MasterPresence(Enum):
    """State of a graph's master."""

    FOUND = "a master exists"
    OURS = "there was no master on this machine, so this program is the master"
    AWAITED = "there is no master yet"


def is_master_uri(text: str) -> bool:
    """Return True for a valid URI of a master."""
    try:
        parts = urlsplit(text)
        return parts.scheme == "http" and bool(parts.hostname) and parts.port is not None
    except ValueError:
        return False


@asynccontextmanager
async def ensure_master(graph: GraphAddress) -> AsyncIterator[MasterPresence | CannotListen]:
    """Run a master inside the context if there is none and the address belongs to this machine."""
    client = XmlRpcClient()
    answer = await client.call(graph.master_uri, "getPid", "/thbridge", timeout=_ANSWER_TIMEOUT)
    await client.close()
    parts = urlsplit(graph.master_uri)
    if not isinstance(answer, CallFailed):
        yield MasterPresence.FOUND
    elif parts.hostname not in _OURS | {graph.host}:
        yield MasterPresence.AWAITED
    else:
        async with MasterServer(graph.host, parts.port or ROS_MASTER_PORT, admission=graph.admission) as own:
            yield own if isinstance(own, CannotListen) else MasterPresence.OURS
