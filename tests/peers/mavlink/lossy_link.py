"""A bad link between robots and a ground station: of all datagrams, whichever way they go, some are lost."""

import random
import select
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_LARGEST = 65535


class LossyLink:
    """Carries datagrams between robots that speak to `port` and a station that listens at another one.

    Attributes:
        port: where robots speak to.
        lost: how many datagrams have been lost, by whether they were the robots'.
        carried: how many have not.
    """

    def __init__(self, station: int, loss: float, seed: int) -> None:
        self._near, self._far = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
        self._near.bind(("127.0.0.1", 0))
        # What a socket is ready for may be an error that a sending takes away before it is read.
        self._near.setblocking(False)
        self._far.setblocking(False)
        self._far.connect(("127.0.0.1", station))
        self._loss = loss
        # Each way has its own, so that it depends on nobody's pace which of its datagrams are lost.
        self._random = {from_robots: random.Random(f"{seed} {from_robots}") for from_robots in (True, False)}
        self._robots: tuple[str, int] | None = None
        self._over = threading.Event()
        self.port = int(self._near.getsockname()[1])
        self.lost = {True: 0, False: 0}
        self.carried = {True: 0, False: 0}

    def run(self) -> None:
        while not self._over.is_set():
            for ready in select.select([self._near, self._far], [], [], 0.1)[0]:
                try:
                    data, address = ready.recvfrom(_LARGEST)
                    self._carry(data, address, ready is self._near)
                except (BlockingIOError, ConnectionRefusedError):
                    pass  # The station is not there yet.
        self._near.close()
        self._far.close()

    def end(self) -> None:
        self._over.set()

    def _carry(self, data: bytes, address: tuple[str, int], from_robots: bool) -> None:
        if from_robots:
            self._robots = address
        if self._random[from_robots].random() < self._loss:
            self.lost[from_robots] += 1
            return
        self.carried[from_robots] += 1
        if from_robots:
            self._far.send(data)
        elif self._robots is not None:
            self._near.sendto(data, self._robots)


@contextmanager
def lossy_link(station: int, loss: float = 0.3, seed: int = 1) -> Iterator[LossyLink]:
    """A link that loses this part of all datagrams, to a station at this port."""
    link = LossyLink(station, loss, seed)
    thread = threading.Thread(target=link.run, daemon=True)
    thread.start()
    try:
        yield link
    finally:
        link.end()
        thread.join()
