"""Carrier of a ROS 2 graph by DDS: our own RTPS participant on UDP sockets."""

import asyncio
import errno
import ipaddress
import logging
import os
import socket
import time
from collections.abc import Callable, Sequence

from thbridge.ros2.qos import QosProfile
from thbridge.ros2.supports import MessageSupport, ServiceSupport
from thbridge.ros2graph.sockets.carrier import GraphClient, GraphWriter, OnMessage, OnRequest
from thbridge.ros2graph.sockets.fair_queue import FairQueue
from thbridge.ros2graph.values.graph import GraphEndpoint, NodeName
from thbridge.ros2graph.wire.rtps import ports
from thbridge.ros2graph.wire.rtps.dds_graph import DdsGraph
from thbridge.ros2graph.wire.rtps.guids import PREFIX_SIZE
from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.participant import TICK_NS, RtpsParticipant
from thbridge.ros2graph.wire.rtps.submessages import VENDOR
from thbridge.sockets.addresses import LOCALHOST
from thbridge.sockets.admission import OWN_MACHINE, Admission
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.warn_once import WarnOnce

DATAGRAM_SIZE, NETWORK_DATAGRAM_SIZE = 16_000, 1_400
"""Maximum number of bytes of a datagram on loopback, and on a network. There, it fits into one Ethernet frame."""

_AT_ONCE, _AT_ONCE_NS = 512, 3_000_000
"""Maximum number of datagrams that a socket reads in one round of the event loop, and maximum time for reading and for
processing. Other work follows."""
_BUFFER = 4 << 20
_LARGEST_DATAGRAM = 65_536
_NANO = 1_000_000_000

_log = logging.getLogger(__name__)


class DdsCarrier:
    """Connection to a ROS 2 graph whose nodes use rmw_fastrtps or rmw_cyclonedds.

    Args:
        domain: domain id, as in ROS_DOMAIN_ID.
        interface: IPv4 address of the network interface. On loopback, only programs on this machine take part.
        clock: returns nanoseconds since 1970, for the times of messages.
        admission: decides by address whose datagrams are processed; those of this machine always are.
        drops: returns True if the next datagram is to be lost. Tests use it.
    """

    def __init__(
        self,
        domain: int = 0,
        interface: str = LOCALHOST,
        clock: Callable[[], int] = time.time_ns,
        drops: Callable[[], bool] | None = None,
        admission: Admission = OWN_MACHINE,
    ) -> None:
        self._domain = domain
        self._interface = interface
        self._clock = clock
        self._drops = drops
        self._admission = admission
        self._warnings = WarnOnce(_log)
        self._sockets: list[socket.socket] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._is_woken = False
        self._queue = FairQueue()
        self._is_queued = False
        is_local = ports.is_loopback(interface)
        self._participant = RtpsParticipant(
            VENDOR + os.urandom(PREFIX_SIZE - len(VENDOR)),
            ports.reach_on_loopback if is_local else self._reach_admitted,
            DATAGRAM_SIZE if is_local else NETWORK_DATAGRAM_SIZE,
        )
        self._graph = DdsGraph(self._participant, clock, self._wake, self._warn)

    async def start(self) -> CannotListen | None:
        """Join the graph. Return the reason if this is not possible."""
        try:
            participant = self._bind()
        except (OSError, ValueError) as error:
            await self.stop()
            port = ports.metatraffic_port(self._domain, 0)
            if isinstance(error, OSError):
                return CannotListen.because(error, self._interface, port)
            return CannotListen(self._interface, port, str(error))
        port = ports.metatraffic_port(self._domain, participant)
        self._participant.start(
            UdpAddress(self._interface, port),
            UdpAddress(self._interface, port + 1),
            ports.initial_addresses(self._domain, self._interface),
        )
        self._loop = asyncio.get_running_loop()
        for each in self._sockets:
            self._loop.add_reader(each, self._receive, each)
        self._tick()
        return None

    async def stop(self) -> None:
        """Leave the graph, and announce it to the other programs."""
        if self._loop is not None:
            self._participant.leave()
            self._send()
            for each in self._sockets:
                self._loop.remove_reader(each)
        if self._timer is not None:
            self._timer.cancel()
        for each in self._sockets:
            each.close()
        self._sockets, self._timer, self._loop = [], None, None

    def add_node(self, node: NodeName) -> None:
        """Announce a node."""
        self._graph.add_node(node)

    def publish(self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile) -> GraphWriter:
        """Announce a publisher."""
        return self._graph.publish(node, topic, support, qos)

    def subscribe(
        self, node: NodeName, topic: str, support: MessageSupport, qos: QosProfile, on_message: OnMessage
    ) -> None:
        """Announce a subscription. Messages of publishers of this program are not delivered."""
        self._graph.subscribe(node, topic, support, qos, on_message)

    def serve(self, node: NodeName, service: str, support: ServiceSupport, on_request: OnRequest) -> None:
        """Announce a server of a service."""
        self._graph.serve(node, service, support, on_request)

    def client(self, node: NodeName, service: str, support: ServiceSupport) -> GraphClient:
        """Announce a client of a service."""
        return self._graph.client(node, service, support)

    def nodes(self) -> Sequence[NodeName]:
        """Return the nodes of other programs that are known at this time."""
        return self._graph.nodes()

    def endpoints(self) -> Sequence[GraphEndpoint]:
        """Return the endpoints of other programs that are known at this time."""
        return self._graph.endpoints()

    def node_of(self, gid: bytes) -> str:
        """Return the full name of the node of an endpoint; its gid as hexadecimal digits if the node is unknown."""
        return self._graph.node_of(gid)

    def _bind(self) -> int:
        """Open the sockets of the first free participant id, and return it. The last socket opened also sends."""
        if not 0 <= self._domain <= ports.LARGEST_DOMAIN:
            raise ValueError(f"domain {self._domain} is not in the range 0 to {ports.LARGEST_DOMAIN}")
        if ipaddress.ip_address(self._interface).version != 4:
            raise ValueError("the interface needs an IPv4 address")
        for participant in range(ports.PARTICIPANT_IDS):
            port = ports.metatraffic_port(self._domain, participant)
            opened: list[socket.socket] = []
            try:
                opened.append(_udp_socket(self._interface, port))
                opened.append(_udp_socket(self._interface, port + 1))
            except OSError as error:
                for each in opened:
                    each.close()
                if error.errno != errno.EADDRINUSE:
                    raise
                continue
            self._sockets += opened
            if not ports.is_loopback(self._interface):
                host = socket.inet_aton(self._interface)
                opened[-1].setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, host)
                self._sockets.insert(0, self._multicast_socket())
            return participant
        raise OSError(errno.EADDRINUSE, os.strerror(errno.EADDRINUSE))

    def _multicast_socket(self) -> socket.socket:
        group = socket.inet_aton(ports.MULTICAST_HOST) + socket.inet_aton(self._interface)
        opened = _udp_socket(ports.MULTICAST_HOST, ports.multicast_port(self._domain), shared=True)
        opened.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        return opened

    def _receive(self, bound: socket.socket) -> None:
        """Read datagrams without processing them: the system's buffer would keep those of all senders in one line."""
        began_ns = time.thread_time_ns()
        for _ in range(_AT_ONCE):
            try:
                datagram, source = bound.recvfrom(_LARGEST_DATAGRAM)
            except (BlockingIOError, InterruptedError):
                break
            except OSError as error:
                self._warn(f"receiving failed: {error.strerror}")
                break
            if self._drops is not None and self._drops():
                continue
            if not self._admits(source[0]):
                self._warn(f"datagrams from {source[0]} are dropped: its network is not admitted (--open-to)")
                continue
            host = self._queue.add(source, datagram)
            if host is not None:
                self._warn(f"a program at {host} sends more than this program can process; some messages are lost")
            if time.thread_time_ns() - began_ns > _AT_ONCE_NS:
                break
        self._continue()

    def _continue(self) -> None:
        """Process datagrams in the next round of the event loop, after all sockets were read."""
        if self._loop is not None and not self._is_queued:
            self._is_queued = True
            self._loop.call_soon(self._process)

    def _process(self) -> None:
        self._is_queued = False
        now_ns, stamp_ns = self._now_ns(), self._clock()
        self._queue.advance(now_ns)
        began_ns = before_ns = time.thread_time_ns()
        while (queued := self._queue.take()) is not None:
            fault = self._participant.receive(queued.content, queued.host, now_ns, stamp_ns)
            if fault is not None:
                self._warn(f"a datagram from {queued.host} was dropped: {fault}")
            spent_ns = time.thread_time_ns()
            self._queue.spend(queued.turn, spent_ns - before_ns)
            before_ns = spent_ns
            if spent_ns - began_ns > _AT_ONCE_NS:
                self._continue()
                break
        self._send()

    def _admits(self, host: str) -> bool:
        return host == self._interface or self._admission.admits(host)

    def _reach_admitted(self, addresses: Sequence[UdpAddress], source: str) -> UdpAddress | None:
        """Select the address of a participant. Nothing is sent to machines that are not admitted."""
        return ports.reach_on_network([each for each in addresses if self._admits(each.host)], source)

    def _send(self) -> None:
        self._is_woken = False
        if not self._sockets:
            return
        self._graph.flush()
        for outgoing in self._participant.drain():
            if self._drops is not None and self._drops():
                continue
            try:
                self._sockets[-1].sendto(outgoing.datagram, outgoing.address)
            except (BlockingIOError, InterruptedError):
                # The system's buffer is full. Reliable readers request lost samples again.
                self._warn("datagrams were dropped because the system's send buffer was full")
            except OSError as error:
                self._warn(f"sending to {outgoing.address.host} failed: {error.strerror}")
        if self._participant.outbox.dropped:
            self._warn("datagrams were dropped because too many waited")

    def _tick(self) -> None:
        self._timer = asyncio.get_running_loop().call_later(TICK_NS / _NANO, self._tick)
        self._graph.tick(self._now_ns())
        self._process()

    def _wake(self) -> None:
        """Send at the end of this round of the event loop, together with what else is written in it."""
        if self._loop is not None and not self._is_woken:
            self._is_woken = True
            self._loop.call_soon(self._send)

    def _now_ns(self) -> int:
        return time.monotonic_ns()

    def _warn(self, fault: str) -> None:
        self._warnings.warn(f"ROS 2 (DDS): {fault}")


def _udp_socket(host: str, port: int, *, shared: bool = False) -> socket.socket:
    """Open a socket that does not block. If `shared`, other programs may open the same port."""
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.setblocking(False)
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER)
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _BUFFER)
        if shared:
            opened.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        opened.bind((host, port))
    except OSError:
        opened.close()
        raise
    return opened
