"""Router of a session for outside connections, with the record of their inputs."""

from thbridge.app.session import inputs
from thbridge.app.session.inputs import InputQueue
from thbridge.credentials import LOCAL, Credentials
from thbridge.text_protocol.wire.router import (
    ClientJoined,
    ConnectionId,
    Forwarded,
    MessageRouter,
    RouterOutput,
    TurnedAway,
)

_LINE = 256
"""Bytes added to the length of each line when lines are counted, so that many short lines reach the limits too."""
_FEW_LINES, _MOST_OF_ONE, _MOST_OF_ALL = 2 * 1024, 32 * 1024, 128 * 1024
"""Limits of bytes received between two ticks: always accepted from one connection, largest for one connection, largest
for all connections together."""


class RecordedRouter:
    """Router for a server of outside connections; everything received is an input of the next tick.

    See `RouterInterface` for the methods.

    Args:
        router: makes the decisions.
        queue: queue of the inputs.
    """

    def __init__(self, router: MessageRouter, queue: InputQueue) -> None:
        self._router = router
        self._inputs = queue
        self._said: dict[ConnectionId, int] = {}
        self._said_by_all = 0
        self._forwarded: list[Forwarded] = []
        self._joined: list[ClientJoined] = []

    def make_room(self, now: float) -> list[RouterOutput]:
        """See the router. This call is not recorded, because a replay makes room before each recorded connection."""
        return self._noted(self._router.make_room(now))

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """See the router, also for the methods below. Only calls that have an effect are recorded as inputs."""
        connection = self._router.connect(now, credentials)
        if not isinstance(connection, TurnedAway):
            self._inputs.add(inputs.ConnectionOpened(connection, now, credentials))
        return connection

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        """Handle received bytes of a connection; each line is a separate input."""
        outputs: list[RouterOutput] = []
        for line in data.splitlines(keepends=True):
            sender = self._router.display_name(connection)
            if sender is None:
                break
            self._said[connection] = self._said.get(connection, 0) + len(line) + _LINE
            self._said_by_all += len(line) + _LINE
            self._inputs.add(inputs.BytesReceived(connection, sender, line, now))
            outputs += self._noted(self._router.receive_data(connection, line, now))
        self._joined += [each for each in outputs if isinstance(each, ClientJoined) and each.credentials.key]
        return outputs

    def admits(self, connection: ConnectionId) -> bool:
        """Return True when a connection may send another line before the next tick.

        Until the next tick, lines are kept in memory, during a pause for a long time. They are also recorded. Therefore
        their amount is limited. The few lines of a well-behaved program are always accepted, even if other programs
        send many lines.
        """
        said = self._said.get(connection, 0)
        return said < _FEW_LINES or (said < _MOST_OF_ONE and self._said_by_all < _MOST_OF_ALL)

    def eof(self, connection: ConnectionId) -> list[RouterOutput]:
        """Note the end of a connection."""
        sender = self._router.display_name(connection)
        if sender is not None:
            self._inputs.add(inputs.ConnectionClosed(connection, sender))
        return self._noted(self._router.eof(connection))

    def report_backlog(self, connection: ConnectionId, size: int) -> list[RouterOutput]:
        """Note that a connection's client does not read."""
        sender = self._router.display_name(connection)
        outputs = self._noted(self._router.report_backlog(connection, size))
        if sender is not None and outputs:
            self._inputs.add(inputs.ConnectionBacklogged(connection, sender, size))
        return outputs

    def advance(self, now: float) -> list[RouterOutput]:
        """Advance the router's clock."""
        outputs = self._noted(self._router.advance(now))
        if outputs:
            self._inputs.add(inputs.ClockAdvanced(now))
        return outputs

    def stop(self) -> list[RouterOutput]:
        """Stop the router; no input follows."""
        return self._noted(self._router.stop())

    def exchange(self) -> list[RouterOutput]:
        """Begin a tick: pass on all submitted messages, and reset the limits of received bytes."""
        self._said, self._said_by_all = {}, 0
        return self._noted(self._router.exchange())

    def take_forwarded(self) -> tuple[Forwarded, ...]:
        """Return the lines that were forwarded since the last call."""
        forwarded, self._forwarded = tuple(self._forwarded), []
        return forwarded

    def take_joined(self) -> list[ClientJoined]:
        """Return the programs that have joined with keys since the last call."""
        joined, self._joined = self._joined, []
        return joined

    def _noted(self, outputs: list[RouterOutput]) -> list[RouterOutput]:
        """Note the lines that the router forwarded, for the keeper and the record; return the router's outputs."""
        self._forwarded += [output for output in outputs if isinstance(output, Forwarded)]
        return outputs
