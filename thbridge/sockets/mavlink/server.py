"""Where ground stations reach a session: its UDP targets and ports, and its TCP port, opened and closed together."""

import logging
from contextlib import AsyncExitStack
from dataclasses import dataclass

from thbridge.sockets.addresses import Address
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.mavlink.links import MavlinkLinks, MavlinkSession
from thbridge.sockets.mavlink.tcp import TcpPort, tcp_port
from thbridge.sockets.mavlink.udp import UdpPort, UdpTarget, udp_listener, udp_port
from thbridge.wire.mavlink.frames.signing import SigningKey

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class MavlinkPorts:
    """Where ground stations reach a session.

    Attributes:
        udp: to whom heartbeats go from the start; whoever answers is heard.
        tcp: where to listen; None for nowhere.
        key: with which frames are signed and verified; None for none.
        udp_listen: where to listen by UDP for those who speak first; None for nowhere.
    """

    udp: tuple[UdpTarget, ...]
    tcp: Address | None
    key: SigningKey | None
    udp_listen: Address | None = None


class MavlinkServer:
    """Speaks MAVLink for a session."""

    def __init__(self, ports: MavlinkPorts) -> None:
        self._ports = ports
        self._links = MavlinkLinks(ports.key)
        self._udp_ports: list[UdpPort] = []
        self._tcp_port: TcpPort | None = None
        self._opened = AsyncExitStack()

    async def open(self) -> list[str] | CannotListen:
        """Take all ports, still silent; what ground stations find them by, or the first that cannot be had."""
        names = []
        for target in self._ports.udp:
            udp = self._kept(await udp_port(self._links, target))
            if isinstance(udp, CannotListen):
                return udp
            names.append(f"udp {target}")
        if self._ports.udp_listen is not None:
            udp = self._kept(await udp_listener(self._links, self._ports.udp_listen))
            if isinstance(udp, CannotListen):
                return udp
            names.append(f"udp from {udp.where}")
        if self._ports.tcp is not None:
            tcp = await tcp_port(self._links, self._ports.tcp)
            if isinstance(tcp, CannotListen):
                return tcp
            self._opened.push_async_callback(tcp.close)
            self._tcp_port = tcp
            names.append(f"tcp {tcp.where}")
        return names

    def _kept(self, port: UdpPort | CannotListen) -> UdpPort | CannotListen:
        """The port, to be served and closed with the others."""
        if isinstance(port, UdpPort):
            self._opened.callback(port.close)
            self._udp_ports.append(port)
        return port

    async def serve(self, exchange: MavlinkSession) -> None:
        """Bring everything that comes in there, and take from there what is said."""
        self._links.serve(exchange)
        for port in self._udp_ports:
            port.serve()
        if self._tcp_port is not None:
            await self._tcp_port.serve()

    async def close(self) -> None:
        """Close everything; what was sent last over TCP has a moment to be read."""
        await self._opened.aclose()
        carried = self._links.totals
        told = f"{carried.received} frames came in, {carried.sent} went out, {carried.unsent} could not be sent"
        _log.log(logging.WARNING if carried.unsent else logging.INFO, "MAVLink: %s", told)
