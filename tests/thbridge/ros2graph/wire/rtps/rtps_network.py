"""Participants in one process, on a network that loses, repeats and delays datagrams, with a clock of its own."""

from collections.abc import Callable
from random import Random

from thbridge.ros2graph.wire.rtps.parameters import UdpAddress
from thbridge.ros2graph.wire.rtps.participant import TICK_NS, RtpsParticipant
from thbridge.ros2graph.wire.rtps.ports import initial_addresses, metatraffic_port, reach_on_loopback

HOST = "127.0.0.1"
STAMP = 1_700_000_000_000_000_000


class RtpsNetwork:
    """Network of participants.

    Args:
        loss: probability that a datagram is lost, and that it is repeated or delayed.
        seed: random seed.
    """

    def __init__(self, loss: float = 0.0, seed: int = 0) -> None:
        self.now_ns = 0
        self.faults: list[str] = []
        self._dice = Random(seed)
        self._loss = loss
        self._at: dict[UdpAddress, RtpsParticipant] = {}
        self._late: list[tuple[UdpAddress, bytes]] = []

    def join(self, number: int, datagram_size: int = 16_000) -> RtpsParticipant:
        """Return a new participant."""
        participant = RtpsParticipant(bytes([0, 0, number]) + bytes(9), reach_on_loopback, datagram_size)
        port = metatraffic_port(0, number)
        addresses = UdpAddress(HOST, port), UdpAddress(HOST, port + 1)
        participant.start(*addresses, initial_addresses(0, HOST))
        self._at.update(dict.fromkeys(addresses, participant))
        return participant

    def leave(self, participant: RtpsParticipant) -> Callable[[], None]:
        """Disconnect a participant, as if its program was killed. Return a function that connects it again."""
        gone = {address: each for address, each in self._at.items() if each is participant}
        self._at = {address: each for address, each in self._at.items() if each is not participant}
        return lambda: self._at.update(gone)

    def run(self, until: Callable[[], bool], ticks: int = 4000) -> None:
        """Let time pass until something has happened."""
        for _ in range(ticks):
            if until():
                return
            self.tick()
        raise AssertionError("it has not happened")

    def tick(self) -> None:
        """Let the time of a tick pass."""
        self.now_ns += TICK_NS
        for participant in list(dict.fromkeys(self._at.values())):
            participant.tick(self.now_ns)
        self.settle()

    def settle(self) -> None:
        """Deliver datagrams until no participant has any."""
        for _ in range(1000):
            moving, self._late = self._late, []
            for participant in list(dict.fromkeys(self._at.values())):
                moving += participant.drain()
            if not moving:
                return
            for address, datagram in moving:
                self._deliver(address, datagram)
        raise AssertionError("participants answer each other without end")

    def _deliver(self, address: UdpAddress, datagram: bytes) -> None:
        receiver = self._at.get(address)
        if receiver is None or self._dice.random() < self._loss:
            return
        if self._dice.random() < self._loss:
            self._late.append((address, datagram))
            if self._dice.random() < 0.5:
                return
        fault = receiver.receive(datagram, HOST, self.now_ns, STAMP + self.now_ns)
        if fault is not None:
            self.faults.append(fault)
