"""MAVLink server of a session. It opens and closes the session's UDP targets and ports and its TCP port together."""

import logging
from collections.abc import Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass

from thbridge.mavlink.sockets.links import MavlinkLinks, MavlinkSession, TimestampStore
from thbridge.mavlink.sockets.tcp import TcpPort, tcp_port
from thbridge.mavlink.sockets.udp import UdpPort, udp_listener, udp_port
from thbridge.mavlink.wire.frames.signing import SigningKey
from thbridge.mavlink.wire.traffic import OutgoingFrame
from thbridge.sockets.addresses import Address, UdpTarget
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class MavlinkPorts:
    """Addresses at which a session serves ground stations.

    Attributes:
        udp: targets to which robots send heartbeats from the start.
        tcp: address to listen on, or None.
        key: key to sign and verify frames, or None.
        udp_listen: UDP address at which stations may send first, or None.
        admission: decides by address which stations that send first are accepted.
        store: keeps timestamps of signatures between runs, or None.
    """

    udp: tuple[UdpTarget, ...]
    tcp: Address | None
    key: SigningKey | None
    udp_listen: Address | None = None
    admission: Admission = OWN_MACHINE
    store: TimestampStore | None = None


class MavlinkServer:
    """MAVLink server of a session."""

    def __init__(self, ports: MavlinkPorts) -> None:
        self._ports = ports
        self._links = MavlinkLinks(ports.key, store=ports.store)
        self._udp_ports: list[UdpPort] = []
        self._tcp_port: TcpPort | None = None
        self._opened = AsyncExitStack()

    async def open(self) -> list[str] | CannotListen:
        """Open all ports, but do not use them yet. Return their names for people, or the first failure."""
        names = []
        for target in self._ports.udp:
            udp = self._kept(await udp_port(self._links, target))
            if isinstance(udp, CannotListen):
                return udp
            names.append(f"udp {target}")
        if self._ports.udp_listen is not None:
            udp = self._kept(await udp_listener(self._links, self._ports.udp_listen, self._ports.admission))
            if isinstance(udp, CannotListen):
                return udp
            names.append(f"udp from {udp.where}")
        if self._ports.tcp is not None:
            tcp = await tcp_port(self._links, self._ports.tcp, self._ports.admission)
            if isinstance(tcp, CannotListen):
                return tcp
            self._opened.push_async_callback(tcp.close)
            self._tcp_port = tcp
            names.append(f"tcp {tcp.where}")
        return names

    def _kept(self, port: UdpPort | CannotListen) -> UdpPort | CannotListen:
        """Add a port to the ports that are served and closed together, and return it."""
        if isinstance(port, UdpPort):
            self._opened.callback(port.close)
            self._udp_ports.append(port)
        return port

    def transmit(self, sent: Sequence[OutgoingFrame]) -> None:
        """Send frames of the session, each on its link. Frames of unknown links are dropped."""
        self._links.transmit(sent)

    async def serve(self, exchange: MavlinkSession) -> None:
        """Connect all ports to a session."""
        self._links.serve(exchange)
        for port in self._udp_ports:
            port.serve()
        if self._tcp_port is not None:
            await self._tcp_port.serve()

    async def close(self) -> None:
        """Close all ports, after TCP peers had a moment to read the last frames."""
        await self._opened.aclose()
        self._links.store_timestamps()
        totals = self._links.totals
        summary = f"{totals.received} frames received, {totals.sent} sent, {totals.unsent} could not be sent"
        if totals.dropped:
            summary += f", {totals.dropped} dropped because too many arrived"
        _log.log(logging.WARNING if totals.unsent or totals.dropped else logging.INFO, "MAVLink: %s", summary)
