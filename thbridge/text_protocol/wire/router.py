"""Text server without its sockets. It stores which party holds each name, and it passes messages on.

`MessageRouter` receives bytes, times and messages. It returns outputs, which its owner carries out. It serves two kinds
of parties, with one set of names and the same rules:

* connections, which send bytes (`connect`, `receive_data`, `eof`, `report_backlog`) and are pinged (`advance`);
* local endpoints, the programs of this process, which exchange `TextMessage` values (`attach`, `submit`, `take`).
  Messages from endpoints and to endpoints wait for `exchange`. All messages of one tick are received in the next tick,
  so that the order of the programs' steps does not matter.

Effect of a connection's line (T is one of the routed commands):

==========================================  ==========================================================
line                                        outputs, in this order
==========================================  ==========================================================
``%%setid NAME``, free or held by itself    ack
``%%setid NAME``, held                      shutdown line to the newcomer, close; no ack
``%%getid``                                 ``%%setid N``, ack
``%%ping``                                  ``%%pong i am here``, ack
``%%sshhuuttddoowwnn``                      close; no ack
``%%send F T C FROM TO ...``, ``T FROM TO`` forwarded line to the holder of TO if there is one, ack
anything else, blank, binary or overlong    ack
==========================================  ==========================================================

Extended clients register with ``%%setid NAME extended [TOKEN]``. Only they

* get a notice of kind ``undelivered`` about a failed delivery, before the ack. (A failed notice causes no such notice.
  Otherwise a stream of notices without a receiver would cause an echo.)
* receive the notices of other extended parties. (Notices to clients of 2016 are withheld, because these clients would
  misread them.)
* replace a dead holder of their name. It must have the same key, or both must have no key. A holder counts as dead
  if it has not answered a ping yet, or if it registered with the same TOKEN. If the TOKEN is the same, the holder is
  this program's own connection from before a network failure.

The game may refuse names, for example of seats that it does not have (`NameRule`). A refused client of ours gets the
reason; for a client of 2016, the name is taken.

A connection from another machine has credentials. With a key it may register the names for which the key has rights,
and send only in its own name. Without a key it is never extended. A client that breaks these rules gets the reason, and
its connection is closed.

For all other clients the server behaves like the server of 2016.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import ClassVar, NewType, TypeAlias

from thbridge.credentials import LOCAL, Credentials, Right
from thbridge.line_splitter import LINE_LIMIT, LineSplitter, OverlongLine
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import (
    EXTENDED,
    TextCommand,
    TextMessage,
    UnreadableText,
    encode_line,
    parse_tokens,
    tokens,
)
from thbridge.text_protocol.wire.notice_format import (
    REFUSED,
    SERVER,
    UNDELIVERED,
    Notice,
    is_notice,
    notice,
    parse_notice,
)

ConnectionId = NewType("ConnectionId", int)

# The exact bytes matter. The clients of 2016 look for words anywhere in a line, and count characters from its end.
ACK_LINE = encode_line(f"{TextCommand.ACK} ")
PING_LINE = encode_line(f"{TextCommand.PING} ")
PONG_LINE = encode_line(f"{TextCommand.PONG} i am here")
SHUTDOWN_LINE = encode_line(f"{TextCommand.SHUTDOWN} ")

_QUOTED = 200
"""Maximum number of characters that a notice quotes from the content of an undelivered message."""


@dataclass(frozen=True, slots=True)
class RouterLimits:
    """Limits of one server.

    Attributes:
        clients: maximum number of connections. A further connection is rejected.
        line: maximum length of a line, bytes.
        backlog: maximum amount of data queued for one receiver: bytes, or characters for a local endpoint.
        ping_after: seconds without a line after which a client is pinged.
        drop_after: seconds after an unanswered ping at which a client is dropped.
        idle: seconds without a line after which a new client may replace a client without a name.
    """

    clients: int = 256
    line: int = LINE_LIMIT
    backlog: int = 1024 * 1024
    ping_after: float = 15.0
    drop_after: float = 15.0
    idle: float = 2.0


class CloseReason(Enum):
    """Reason why the server ends a connection."""

    NAME_TAKEN = "its name is already held"
    ASKED = "it asked to close the connection"
    STOPPED = "the server stops"
    PING_UNANSWERED = "it did not answer a ping"
    SLOW = "it does not read what it is sent"
    REPLACED = "its program has reconnected"
    IDLE = "it has no name and is silent, and its place is needed"
    NOT_ENTITLED = "its key does not allow that"
    NO_SEAT = "the game has no seat for its name"

    @property
    def flush(self) -> bool:
        """True if pending bytes are still sent. False if the other side no longer reads."""
        return self not in (
            CloseReason.PING_UNANSWERED,
            CloseReason.SLOW,
            CloseReason.REPLACED,
            CloseReason.IDLE,
        )


@dataclass(frozen=True, slots=True)
class SendToClient:
    """Bytes to be written to a connection."""

    connection: ConnectionId
    data: bytes


@dataclass(frozen=True, slots=True)
class CloseConnection:
    """Connection to be closed. The router has already removed it and freed its name.

    Attributes:
        connection: the connection.
        reason: kind of reason.
        warning: warning about the client for the people who run the server; empty if there is none.
    """

    connection: ConnectionId
    reason: CloseReason
    warning: str = ""


@dataclass(frozen=True)
class Forwarded:
    """Message that was passed on or could not be passed on. Taps and recorders use this output.

    Attributes:
        message: the message.
        delivered: True if the holder of the receiver's name got it.
        sender_extended: True if it came from an extended client or a local endpoint.
    """

    message: TextMessage
    delivered: bool
    sender_extended: bool

    @cached_property
    def legacy_value(self) -> legacy.LegacyValue | UnreadableText:
        """Value of the message in the dialect of 2016. It is decoded only once for all taps and recorders."""
        return legacy.decode(self.message)


@dataclass(frozen=True, slots=True)
class LineSkipped:
    """Line longer than the limit. It was dropped, and acknowledged like an unknown line."""

    connection: ConnectionId
    length: int


@dataclass(frozen=True, slots=True)
class ClientJoined:
    """Event: a connection has registered a name. It is for logs, and for recorders that note the reachable names."""

    connection: ConnectionId
    name: str
    extended: bool
    credentials: Credentials = LOCAL


@dataclass(frozen=True, slots=True)
class ClientLeft:
    """Event: a connection no longer has its name."""

    connection: ConnectionId
    name: str


RouterOutput: TypeAlias = SendToClient | CloseConnection | Forwarded | LineSkipped | ClientJoined | ClientLeft


@dataclass(frozen=True, slots=True)
class TurnedAway:
    """Rejection of a connection. The owner of the router writes `farewell` to the connection and closes it."""

    farewell: bytes


@dataclass(frozen=True, slots=True)
class NameTaken:
    """Rejection of a local endpoint's name, because another party has this name."""

    name: str


@dataclass(frozen=True, slots=True)
class NameRefusal:
    """Refusal of a program's name.

    Attributes:
        reason: the reason, as a clause.
        answer: line for a program of 2016; None if it gets no line.
    """

    reason: str
    answer: TextMessage | None = None


NameRule: TypeAlias = Callable[[str, bool], NameRefusal | None]
"""Rule of a game about the names of programs. The arguments are a name, and True if the client is extended."""


@dataclass(slots=True)
class _Connection:
    """TCP client. `pinged` is the time of the last ping, or None if a line has arrived since then."""

    id: ConnectionId
    lines: LineSplitter
    last_line: float
    credentials: Credentials
    pinged: float | None = None
    name: str | None = None
    extended: bool = False
    token: str | None = None

    def obstacle(self, message: TextMessage, is_extension: bool, backlog: int) -> str | None:
        """Return the reason why a message cannot be delivered, or None."""
        return "its receiver is a program of 2016" if is_extension and not self.extended else None

    def hand_over(self, message: TextMessage) -> list[RouterOutput]:
        """Send a message."""
        return [SendToClient(self.id, encode_line(message.line()))]


@dataclass(slots=True)
class _Endpoint:
    """Program of this process. `exchange` moves `arriving` to `inbox`. `waiting` counts the characters of both."""

    extended: ClassVar[bool] = True
    name: str
    arriving: list[TextMessage] = field(default_factory=list)
    inbox: list[TextMessage] = field(default_factory=list)
    waiting: int = 0

    def obstacle(self, message: TextMessage, is_extension: bool, backlog: int) -> str | None:
        """Return the reason why a message cannot be delivered, or None."""
        return "too many messages are queued for its receiver" if self.waiting + _size(message) > backlog else None

    def hand_over(self, message: TextMessage) -> list[RouterOutput]:
        """Queue a message until the next exchange."""
        self.arriving.append(message)
        self.waiting += _size(message)
        return []


class LocalEndpoints:
    """Programs of this process at a router.

    Args:
        holders: holders of all names, including connections.
    """

    def __init__(self, holders: dict[str, _Connection | _Endpoint]) -> None:
        self._holders = holders
        self._endpoints: dict[str, _Endpoint] = {}
        self._submitted: list[tuple[_Endpoint, TextMessage]] = []

    def attach(self, name: str) -> NameTaken | None:
        """Register a name for a program of this process. The program counts as an extended client and is never pinged.

        Raises:
            ValueError: the name is not one token.
        """
        # White space separates the names in a line, so messages could not be addressed to such a name.
        if tokens(name) != [name]:
            raise ValueError(f"not one token: {name!r}")
        if name in self._holders:
            return NameTaken(name)
        self._endpoints[name] = self._holders[name] = _Endpoint(name)
        return None

    def detach(self, name: str) -> None:
        """Free the name of a local endpoint. Messages that it has submitted are still passed on.

        Raises:
            KeyError: no endpoint is attached under this name.
        """
        del self._endpoints[name]
        del self._holders[name]

    def submit(self, name: str, message: TextMessage) -> None:
        """Send a message as a local endpoint. The next `exchange` passes it on.

        Raises:
            KeyError: no endpoint is attached under this name.
        """
        self._submitted.append((self._endpoints[name], message))

    def take(self, name: str) -> list[TextMessage]:
        """Take the messages that a local endpoint received up to the last `exchange`, oldest first.

        Raises:
            KeyError: no endpoint is attached under this name.
        """
        endpoint = self._endpoints[name]
        if not endpoint.inbox:
            return []
        messages, endpoint.inbox = endpoint.inbox, []
        endpoint.waiting = sum(_size(message) for message in endpoint.arriving)  # of integers
        return messages

    def take_submitted(self) -> list[tuple[_Endpoint, TextMessage]]:
        """Return the messages that were submitted since the last call, in order."""
        submitted, self._submitted = self._submitted, []
        return submitted

    def hand_out(self) -> None:
        """Make arrived messages available to the endpoints."""
        for endpoint in self._endpoints.values():
            if endpoint.arriving:
                endpoint.inbox += endpoint.arriving
                endpoint.arriving.clear()


class MessageRouter:
    """Router of the text server. See the module's description.

    Times are seconds on any clock that does not run backward. Not safe for use by several threads at once.

    Args:
        limits: limits of the server.
        name_rule: rule about names. If None, all names are allowed.

    Attributes:
        limits: limits of the server.
        local: programs of this process.
    """

    def __init__(self, limits: RouterLimits | None = None, name_rule: NameRule | None = None) -> None:
        self.limits = limits or RouterLimits()
        self._name_rule = name_rule
        self._connections: dict[ConnectionId, _Connection] = {}
        self._holders: dict[str, _Connection | _Endpoint] = {}
        self.local = LocalEndpoints(self._holders)
        self._connection_count = 0
        self._number = 0
        self._stopped = False

    # Connections

    def make_room(self, now: float) -> list[RouterOutput]:
        """If the server is full, close the connection that has no name and has been silent longest.

        If no such connection has been silent for `RouterLimits.idle` seconds, all connections stay.
        """
        if self._stopped or len(self._connections) < self.limits.clients:
            return []
        nameless = [client for client in self._connections.values() if client.name is None]
        idle = [client for client in nameless if now - client.last_line >= self.limits.idle]
        if not idle:
            return []
        return self._close(min(idle, key=lambda client: client.last_line), CloseReason.IDLE)

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """Accept a connection, which has no name at first. Reject it if the server is full or has stopped."""
        if self._stopped or len(self._connections) >= self.limits.clients:
            return TurnedAway(SHUTDOWN_LINE)
        self._connection_count += 1
        connection = ConnectionId(self._connection_count)
        self._connections[connection] = _Connection(connection, LineSplitter(self.limits.line), now, credentials)
        return connection

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        """Handle bytes from a connection. Bytes from a closed connection are ignored."""
        client = self._connections.get(connection)
        if client is None:
            return []
        outputs: list[RouterOutput] = []
        for line in client.lines.feed(data):
            # Any line shows that the client is alive, not only the answer to a ping.
            client.last_line, client.pinged = now, None
            if isinstance(line, OverlongLine):
                outputs += [LineSkipped(connection, line.length), SendToClient(connection, ACK_LINE)]
            else:
                outputs += self._handle(client, tokens(line))
            if connection not in self._connections:
                break  # The line has closed the connection, so the bytes after it are ignored.
        return outputs

    def admits(self, connection: ConnectionId) -> bool:
        """Return True, because a router itself does not limit the number of lines."""
        return True

    def eof(self, connection: ConnectionId) -> list[RouterOutput]:
        """Remove a connection that has ended or is lost, and free its name. An incomplete line is dropped."""
        client = self._connections.pop(connection, None)
        return [] if client is None else self._release(client)

    def report_backlog(self, connection: ConnectionId, size: int) -> list[RouterOutput]:
        """Record the number of bytes in a connection's outgoing buffer. Close the connection if there are too many."""
        client = self._connections.get(connection)
        if client is None or size <= self.limits.backlog:
            return []
        return self._close(client, CloseReason.SLOW)

    def advance(self, now: float) -> list[RouterOutput]:
        """Ping silent connections, and drop connections that did not answer a ping. Must be called once a second."""
        outputs: list[RouterOutput] = []
        for client in list(self._connections.values()):
            if client.pinged is not None:
                if now - client.pinged >= self.limits.drop_after:
                    outputs += self._close(client, CloseReason.PING_UNANSWERED)
            elif now - client.last_line >= self.limits.ping_after:
                client.pinged = now
                outputs.append(SendToClient(client.id, PING_LINE))
        return outputs

    def stop(self) -> list[RouterOutput]:
        """Send the shutdown line to all connections, close them, and reject further connections."""
        self._stopped = True
        outputs: list[RouterOutput] = []
        for client in list(self._connections.values()):
            outputs.append(SendToClient(client.id, SHUTDOWN_LINE))
            outputs += self._close(client, CloseReason.STOPPED)
        return outputs

    def dismiss(self, name: str, reason: str) -> list[RouterOutput]:
        """End the connection of a program of ours whose name the game no longer allows, and send it the reason."""
        holder = self._holders.get(name)
        if not isinstance(holder, _Connection):
            return []
        return self._refuse_name(holder, name, NameRefusal(reason), extended=True)

    def display_name(self, connection: ConnectionId) -> str | None:
        """Return a connection's name for people, or its number if it has no name. If it is not open, return None."""
        client = self._connections.get(connection)
        return None if client is None else client.name or f"connection {connection}"

    def keyed_programs(self) -> list[ClientJoined]:
        """Return the programs that have presented a key and have a name, in the order of their connections."""
        return [
            ClientJoined(client.id, client.name, client.extended, client.credentials)
            for client in self._connections.values()
            if client.name is not None and client.credentials.key
        ]

    def exchange(self) -> list[RouterOutput]:
        """Pass on all submitted messages in order. Then local endpoints may `take` their messages.

        As this is called once per tick, a run of several local programs is deterministic.
        """
        outputs: list[RouterOutput] = []
        for endpoint, message in self.local.take_submitted():
            outputs += self._forward(endpoint, message)
        # Hand out only now, so that all messages of a tick are received in the next tick, in any order of the programs.
        self.local.hand_out()
        return outputs

    # Effects of lines

    def _handle(self, client: _Connection, parts: list[str]) -> list[RouterOutput]:
        outputs: list[RouterOutput] = []
        match parts:
            case [TextCommand.SETID, name, *extras]:
                outputs += self._register(client, name, extras)
            case [TextCommand.GETID, *_]:
                name = self._fresh_number()
                reason = _not_entitled(client.credentials, name, client.extended)
                if reason is not None:
                    return self._turn_out(client, name, reason)
                outputs += self._rename(client, name, client.extended)
                outputs.append(SendToClient(client.id, encode_line(f"{TextCommand.SETID} {name}")))
            case [TextCommand.PING, *_]:
                outputs.append(SendToClient(client.id, PONG_LINE))
            case [TextCommand.SHUTDOWN, *_]:
                outputs += self._close(client, CloseReason.ASKED)
            case _:
                message = parse_tokens(parts)
                if isinstance(message, TextMessage):
                    outputs += self._forward(client, message)
        # The server of 2016 acknowledged every line, even if it did not know the command.
        if client.id in self._connections:
            outputs.append(SendToClient(client.id, ACK_LINE))
        return outputs

    def _register(self, client: _Connection, name: str, extras: Sequence[str]) -> list[RouterOutput]:
        extended = extras[:1] == [EXTENDED]
        token = extras[1] if extended and len(extras) > 1 else None
        outputs: list[RouterOutput] = []
        # No program may hold the server's name. A client that wants it asks if it may have the name in its token.
        asked = token if name == SERVER and token is not None else name
        reason = _not_entitled(client.credentials, asked, extended)
        if reason is not None:
            return self._turn_out(client, name, reason)
        refused = None if self._name_rule is None else self._name_rule(asked, extended)
        if refused is not None:
            return self._refuse_name(client, name, refused, extended=extended)
        holder = self._holders.get(name)
        # No program may hold SERVER, because the server sends its own notices under this name.
        if name == SERVER or (holder is not None and holder is not client):
            if not (extended and isinstance(holder, _Connection) and _is_dead(holder, client, token)):
                return [SendToClient(client.id, SHUTDOWN_LINE), *self._close(client, CloseReason.NAME_TAKEN)]
            outputs += self._close(holder, CloseReason.REPLACED)
        client.token = token
        return outputs + self._rename(client, name, extended)

    def _turn_out(self, client: _Connection, name: str, reason: str) -> list[RouterOutput]:
        sent = SendToClient(client.id, farewell(name, reason))
        return [sent, *self._close(client, CloseReason.NOT_ENTITLED)]

    def _refuse_name(
        self, client: _Connection, name: str, refused: NameRefusal, *, extended: bool
    ) -> list[RouterOutput]:
        if extended:
            said = farewell(name, refused.reason)
        else:
            said = b"" if refused.answer is None else encode_line(refused.answer.line())
            said += SHUTDOWN_LINE
        warning = f"the program {name} is refused: {refused.reason}"
        return [
            SendToClient(client.id, said),
            *self.eof(client.id),
            CloseConnection(client.id, CloseReason.NO_SEAT, warning),
        ]

    def _forward(self, origin: _Connection | _Endpoint, message: TextMessage) -> list[RouterOutput]:
        """Pass a message on. If this is not possible, send a notice to the sender if it is extended."""
        extended = origin.extended
        is_extension = extended and is_notice(message)
        withheld = _withheld(origin, message) if isinstance(origin, _Connection) else None
        if withheld is not None:
            # Taps do not get this message either. The keeper would believe the false sender's name in it.
            reported = extended and not is_extension
            return origin.hand_over(_undelivered(origin.name or SERVER, message, withheld)) if reported else []
        holder = self._holders.get(message.receiver)
        if holder is None:
            failure: str | None = "no program has that name"
        else:
            failure = holder.obstacle(message, is_extension, self.limits.backlog)
        to_ours = holder is not None and holder.extended
        if to_ours and isinstance(origin, _Connection) and message.sender != origin.name and is_notice(message):
            # Our own programs act on notices, so a connection may not send them in another program's name.
            failure = "a program may send notices only in its own name"
        outputs: list[RouterOutput] = [Forwarded(message, failure is None, extended)]
        if holder is not None and failure is None:
            outputs += holder.hand_over(message)
        elif failure is not None and extended and not is_extension:
            outputs += origin.hand_over(_undelivered(origin.name or message.sender, message, failure))
        return outputs

    # Names

    def _fresh_number(self) -> str:
        self._number += 1
        # A program may have registered a number as its name.
        while str(self._number) in self._holders:
            self._number += 1
        return str(self._number)

    def _rename(self, client: _Connection, name: str, extended: bool) -> list[RouterOutput]:
        left = self._release(client)
        client.name, client.extended = name, extended
        self._holders[name] = client
        return [*left, ClientJoined(client.id, name, extended, client.credentials)]

    def _release(self, client: _Connection) -> list[RouterOutput]:
        if client.name is None:
            return []
        name, client.name = client.name, None
        del self._holders[name]
        return [ClientLeft(client.id, name)]

    def _close(self, client: _Connection, reason: CloseReason) -> list[RouterOutput]:
        return [*self.eof(client.id), CloseConnection(client.id, reason)]


def _is_dead(holder: _Connection, newcomer: _Connection, token: str | None) -> bool:
    # Otherwise a program with one key could take over the name of a program with another key.
    if holder.credentials.key != newcomer.credentials.key:
        return False
    # With the same token, the newcomer is the same program, which has reconnected after a network failure.
    return holder.pinged is not None or (token is not None and holder.token == token)


def farewell(name: str, reason: str) -> bytes:
    """Return the last lines for a client of ours if its key does not allow a request or is no longer valid."""
    return encode_line(notice(SERVER, name, REFUSED, reason=reason).line()) + SHUTDOWN_LINE


RESEARCHER = "Researcher-"
"""Beginning of the names of programs with which researchers play seats of a game."""
_RIGHTS = {legacy.SIMR: Right.ROBOTS, legacy.HIDER: Right.HIDER}
"""Right that each program's name requires; a researcher's program needs the right to intervene. All other names require
a participant's right."""
_NEEDS_KEY = "programs of thbridge on another machine need a key"
PLAY_AGAIN = "PlayAgain"
"""Kind of the notice by which a participant begins another game."""


def right_of(name: str) -> Right:
    """Return the right that is required to register a name."""
    return Right.INTERVENE if name.startswith(RESEARCHER) else _RIGHTS.get(name, Right.PARTICIPANT)


def _not_entitled(credentials: Credentials, name: str, extended: bool) -> str | None:
    """Return the reason, as a clause, why a connection may not have a name. Return None if it may."""
    if extended and not credentials.extended:
        return _NEEDS_KEY
    if credentials.may(right_of(name)):
        others = credentials.seats and right_of(name) is Right.PARTICIPANT
        if others and name not in {f"{legacy.TABUI}-{seat}" for seat in credentials.seats}:
            return f"the key {credentials.key} is not for this seat; use --seat with: {', '.join(credentials.seats)}"
        return None
    return f"the key {credentials.key} does not allow the name {name}; its rights: {', '.join(credentials.rights)}"


def _withheld(client: _Connection, message: TextMessage) -> str | None:
    """Return the reason why a client's credentials do not allow a message, or None if they do."""
    if not client.credentials.extended and is_notice(message):
        return _NEEDS_KEY
    # Without a key, a message may have any sender, as at the server of 2016.
    if not client.credentials.key:
        return None
    if message.sender != client.name:
        return f"the key {client.credentials.key} only allows messages of {client.name}"
    said = parse_notice(message) if client.credentials.one_game and is_notice(message) else None
    if isinstance(said, Notice) and said.kind == PLAY_AGAIN:
        return f"the key {client.credentials.key} is for one game only"
    return None


def _undelivered(to: str, message: TextMessage, reason: str) -> TextMessage:
    return notice(
        SERVER,
        to,
        UNDELIVERED,
        command=message.command,
        receiver=message.receiver,
        content=message.text[:_QUOTED],
        reason=reason,
    )


def _size(message: TextMessage) -> int:
    return len(message.line())
