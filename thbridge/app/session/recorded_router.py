"""Router of a session for connections from outside, which records their inputs."""

from thbridge.app.session import inputs
from thbridge.app.session.inputs import InputQueue
from thbridge.credentials import LOCAL, Credentials
from thbridge.text_protocol.wire.router import (
    ClientJoined,
    ClientLeft,
    ConnectionId,
    Forwarded,
    MessageRouter,
    RouterOutput,
    TurnedAway,
)

_LINE = 256
"""Each line counts as its length plus this number of bytes, so that many short lines also reach the limits."""
_FEW_LINES, _MOST_OF_ONE, _MOST_OF_ALL = 2 * 1024, 32 * 1024, 128 * 1024
"""Limits for the number of bytes received between two ticks.

The first number is always accepted from a connection. The second is the limit for one connection, the third for all
connections together.
"""


class RecordedRouter:
    """Router for a server of connections from outside. All received data are inputs of the next tick.

    `RouterInterface` describes the methods.

    Args:
        router: router that makes the decisions.
        queue: queue of the inputs.
    """

    def __init__(self, router: MessageRouter, queue: InputQueue) -> None:
        self._router = router
        self._inputs = queue
        self._said: dict[ConnectionId, int] = {}
        self._said_by_all = 0
        self._forwarded: list[Forwarded] = []
        self._joined: list[ClientJoined] = []
        self._left: list[str] = []

    def make_room(self, now: float) -> list[RouterOutput]:
        """Make room for a connection. This is not recorded, because replays make room before each connection."""
        return self._noted(self._router.make_room(now))

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """Open a connection. This call and all later calls are recorded as inputs only if they have an effect."""
        connection = self._router.connect(now, credentials)
        if not isinstance(connection, TurnedAway):
            self._inputs.add(inputs.ConnectionOpened(connection, now, credentials))
        return connection

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        """Process received bytes of a connection; each line is a separate input."""
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
        """Return True if a connection may send another line before the next tick.

        Lines are stored in memory until the next tick. A pause can make this time long. Lines are also recorded. So the
        number of lines is limited. A few lines are always accepted from each program, even if other programs
        send many lines.
        """
        said = self._said.get(connection, 0)
        return said < _FEW_LINES or (said < _MOST_OF_ONE and self._said_by_all < _MOST_OF_ALL)

    def eof(self, connection: ConnectionId) -> list[RouterOutput]:
        """Record the end of a connection."""
        sender = self._router.display_name(connection)
        if sender is not None:
            self._inputs.add(inputs.ConnectionClosed(connection, sender))
        return self._noted(self._router.eof(connection))

    def dismiss(self, name: str, reason: str) -> list[RouterOutput]:
        """End a program's connection for a reason of the game. This is not recorded, because replays do it, too."""
        return self._noted(self._router.dismiss(name, reason))

    def report_backlog(self, connection: ConnectionId, size: int) -> list[RouterOutput]:
        """Record that the client of a connection does not read."""
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
        """Stop the router, after which no input follows."""
        return self._noted(self._router.stop())

    def exchange(self) -> list[RouterOutput]:
        """Begin a tick: pass on all submitted messages, and reset the counts of received bytes."""
        self._said, self._said_by_all = {}, 0
        return self._noted(self._router.exchange())

    def take_forwarded(self) -> tuple[Forwarded, ...]:
        """Return the lines forwarded since the last call."""
        forwarded, self._forwarded = tuple(self._forwarded), []
        return forwarded

    def take_joined(self) -> list[ClientJoined]:
        """Return the programs that have joined with keys since the last call."""
        joined, self._joined = self._joined, []
        return joined

    def take_left(self) -> list[str]:
        """Return the names of programs that were disconnected since the last call, and have not joined again."""
        left, self._left = self._left, []
        return left

    def _noted(self, outputs: list[RouterOutput]) -> list[RouterOutput]:
        """Store forwarded lines and the names of programs that have left, for the keeper; return the outputs."""
        if not outputs:
            return outputs
        for output in outputs:
            match output:
                case ClientLeft(_, name):
                    self._left.append(name)
                case ClientJoined(_, name) if name in self._left:
                    self._left.remove(name)
                case _:
                    pass
        self._forwarded += [output for output in outputs if isinstance(output, Forwarded)]
        return outputs
