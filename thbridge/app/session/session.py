"""The session: roles of this process around one router, and the tick they share.

Inputs from outside come in between two ticks, by the methods of `Session` (or of `SimrSession`, for robots whose
server is another process), and are recorded as an `Input` of the next one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from thbridge.app.session import inputs
from thbridge.app.session.inputs import Input
from thbridge.credentials import LOCAL, Credentials
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.hunt.events import Event, GameStarted, JournalEntry, KeyUsed
from thbridge.hunt.game import GameState
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.links import HubLink
from thbridge.mavlink.wire.outgoing import LinkId, VehicleStatus
from thbridge.mavlink.wire.traffic import FrameOutcome, OutgoingFrame, Traffic
from thbridge.roles.keeper.keeper import Keeper, ProgramRefusal
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.shared.robot_requests import GameRequest, Request
from thbridge.roles.shared.robots_role import RobotsRole
from thbridge.roles.shared.role import Role
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import (
    ClientJoined,
    ConnectionId,
    Forwarded,
    MessageRouter,
    RouterOutput,
    TurnedAway,
)

if TYPE_CHECKING:  # Only sessions with robots need these.
    from sim.team import TeamSnapshot
    from thbridge.mavlink.role.vehicles import RequestSink, Vehicles

_LINE = 256
"""Bytes that a line costs beside its own."""
_FEW_LINES, _MOST_OF_ONE, _MOST_OF_ALL = 2 * 1024, 32 * 1024, 128 * 1024
"""Bytes between two ticks that are always heard of a connection, at most, and at most of all together."""

_MOST_GRANTED = 200
"""Requests by keys before a tick that are logged one by one: in a pause there may be many about its pace."""


@dataclass(frozen=True, slots=True)
class TickRecord:
    """Record of one tick of a session.

    Attributes:
        tick: its number.
        inputs: from outside, in order.
        snapshot: of the robots; None where they are another program's.
        forwarded: the lines that were passed on, in order.
        events: of the game.
        utterances: of its dialogues.
        wizard: robots that a person speaks for, and the turns that wait for that person.
        game: after this tick; None before the first.
        traffic: frames that vehicles received since the last tick, and sent since then and in this one, in order.
        vehicles: status of each vehicle; empty where the robots are none.
        refusals: of what programs have asked the keeper for, in order.
    """

    tick: int
    inputs: tuple[Input, ...]
    snapshot: "TeamSnapshot | None"
    forwarded: tuple[Forwarded, ...]
    events: tuple[Event, ...]
    utterances: tuple[DialogueUtterance, ...]
    wizard: WizardState
    game: GameState | None
    traffic: tuple[Traffic, ...] = ()
    vehicles: tuple[VehicleStatus, ...] = ()
    refusals: tuple[ProgramRefusal, ...] = ()


class TickRecorder(Protocol):
    """Recorder of a session."""

    def record(self, record: TickRecord) -> None:
        """Record one tick. May raise; the session then ends."""


class EventLog(Protocol):
    """Log of the game's events and of what is said, written before any of their effects."""

    def append(self, entries: Sequence[JournalEntry]) -> None:
        """Write the entries; return when they are safe."""


class Session:
    """Runs the roles of one process in step: messages sent in one tick arrive in the next.

    Args:
        keeper: of the game.
        roles: the other roles of this process.
        recorders: take every tick.
        participant: the participant's role in this process, if any; its messages are inputs.
        vehicles: makes the robots MAVLink vehicles, given a sink of their requests to robots and game; these requests
            follow from frames, and so are no inputs. None: the robots are no vehicles.
        log: of the game's events, and of the keys by which programs take part; None: they are not logged.

    Attributes:
        run: name of a game, by its number, unlike all others; it is logged with the keys.
        tick: the number of the next tick.
        perform: carries out the router's outputs. A server of outside connections replaces it, and must pass every
            `Forwarded` to `note_forwarded`; to that server this session is the router.
        transmit: sends frames on their links; it may not know all of them. A server of links replaces it.

    Raises:
        ValueError: two roles have the same name.
    """

    def __init__(
        self,
        keeper: Keeper,
        roles: Sequence[Role],
        recorders: Sequence[TickRecorder] = (),
        participant: Role | None = None,
        vehicles: "Callable[[RequestSink], Vehicles] | None" = None,
        log: EventLog | None = None,
    ) -> None:
        self.tick = 0
        self.perform: Callable[[Sequence[RouterOutput]], None] = self.note_all_forwarded
        self.transmit: Callable[[Sequence[OutgoingFrame]], None] = _drop_frames
        self.run: Callable[[int], str] = str
        self._router = MessageRouter()
        self._keeper = keeper
        self._roles = tuple(roles)
        self._log = log
        self._recorders = tuple(recorders)
        self._participant = participant
        self._robots = next((role for role in roles if isinstance(role, RobotsRole)), None)
        self._inputs: list[Input] = []
        self._joined: list[ClientJoined] = []
        self._granted: list[tuple[str, str]] = []
        self._said: dict[ConnectionId, int] = {}
        self._said_by_all = 0
        self._forwarded: list[Forwarded] = []
        self._vehicles = None if vehicles is None else vehicles(self._pass_on)
        for role in (keeper, *self._roles, *(() if participant is None else (participant,))):
            taken = self._router.attach(role.name)
            if taken is not None:
                raise ValueError(f"two programs are called {taken.name}")
            role.connected()

    @property
    def has_vehicles(self) -> bool:
        """True when the robots are MAVLink vehicles."""
        return self._vehicles is not None

    @property
    def game(self) -> GameState | None:
        """State of the game; None before the first."""
        return self._keeper.state

    @property
    def game_name(self) -> tuple[str, bool]:
        """Name, as `run` has it, of the present game, the last or else the coming one; True where it is over."""
        game = self.game
        if game is None:
            return self.run(self._keeper.last_game + 1), False
        return self.run(game.started.game), game.ended is not None

    def record_with(self, recorders: Sequence[TickRecorder], log: EventLog | None) -> None:
        """Have every tick recorded, and the game's events logged; to be called before the first tick."""
        self._recorders, self._log = tuple(recorders), log

    def note_forwarded(self, forwarded: Forwarded) -> None:
        """Take a line that the router forwarded, for the keeper and the record."""
        self._forwarded.append(forwarded)

    def note_all_forwarded(self, outputs: Sequence[RouterOutput]) -> None:
        """Carry out the router's outputs where nobody is connected: take what it forwarded."""
        for output in outputs:
            if isinstance(output, Forwarded):
                self.note_forwarded(output)

    # Inputs from outside

    def ask(self, sender: str, request: Request) -> None:
        """Pass on a request to robots or game, in the name of its sender.

        Raises:
            ValueError: the robots are another program's.
        """
        self._pass_on(request, sender)
        self._inputs.append(inputs.ClientRequest(sender, request))

    def granted(self, key: str, request: str) -> None:
        """Note that whoever has a key has asked for something, and got it, for the log."""
        if len(self._granted) <= _MOST_GRANTED:
            more = len(self._granted) == _MOST_GRANTED
            self._granted.append((key, f"more than {_MOST_GRANTED} times before the next tick" if more else request))

    def make_room(self, now: float) -> list[RouterOutput]:
        """See the router; a connection that follows is recorded, and makes room again in a replay."""
        return self._router.make_room(now)

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """See the router, for this and the next ones; only calls with an effect are recorded as inputs."""
        connection = self._router.connect(now, credentials)
        if not isinstance(connection, TurnedAway):
            self._inputs.append(inputs.ConnectionOpened(connection, now, credentials))
        return connection

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        """Take bytes of a connection; each line is an input of its own."""
        outputs: list[RouterOutput] = []
        for line in data.splitlines(keepends=True):
            sender = self._router.display_name(connection)
            if sender is None:
                break
            self._said[connection] = self._said.get(connection, 0) + len(line) + _LINE
            self._said_by_all += len(line) + _LINE
            self._inputs.append(inputs.BytesReceived(connection, sender, line, now))
            outputs += self._router.receive_data(connection, line, now)
        self._joined += [each for each in outputs if isinstance(each, ClientJoined) and each.credentials.key]
        return outputs

    def admits(self, connection: ConnectionId) -> bool:
        """Return True when a connection may say another line before the next tick.

        What is said is kept until then, in a pause for long, and recorded. The few lines of a program that means well
        are heard whatever others say.
        """
        said = self._said.get(connection, 0)
        return said < _FEW_LINES or (said < _MOST_OF_ONE and self._said_by_all < _MOST_OF_ALL)

    def eof(self, connection: ConnectionId) -> list[RouterOutput]:
        """Note the end of a connection."""
        sender = self._router.display_name(connection)
        if sender is not None:
            self._inputs.append(inputs.ConnectionClosed(connection, sender))
        return self._router.eof(connection)

    def report_backlog(self, connection: ConnectionId, size: int) -> list[RouterOutput]:
        """Note that a connection's client does not read."""
        sender = self._router.display_name(connection)
        outputs = self._router.report_backlog(connection, size)
        if sender is not None and outputs:
            self._inputs.append(inputs.ConnectionBacklogged(connection, sender, size))
        return outputs

    def advance(self, now: float) -> list[RouterOutput]:
        """Advance the router's clock."""
        outputs = self._router.advance(now)
        if outputs:
            self._inputs.append(inputs.ClockAdvanced(now))
        return outputs

    def stop(self) -> list[RouterOutput]:
        """Stop the router; no input comes in any more."""
        return self._router.stop()

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        """Open a link to the robots' vehicles.

        Args:
            name: of the link.
            robot: the only robot on the link, from 0; None: all robots.

        Raises:
            ValueError: the robots are no vehicles.
        """
        if self._vehicles is None:
            raise ValueError("the robots are no vehicles")
        link = self._vehicles.open(name, robot)
        self._inputs.append(inputs.LinkOpened(link, name, robot))
        return link

    def close_link(self, link: LinkId) -> None:
        """Close a link, unless it is closed already."""
        there = self.link(link)
        if self._vehicles is not None and there is not None:
            self._vehicles.hub.close(link)
            self._inputs.append(inputs.LinkClosed(link, there.name))

    def link(self, link: LinkId) -> HubLink | None:
        """Return the state of an open link; None: there is no such link."""
        return None if self._vehicles is None else self._vehicles.hub.link(link)

    def receive_frame(self, link: LinkId, frame: Frame, robot: int | None = None) -> FrameOutcome:
        """Take a frame that came in.

        It acts at once on vehicles, whose state is that after the last tick; requests of vehicles to robots and game
        act in the next tick.

        Args:
            link: its number; a frame of an unknown link is dropped.
            frame: checked, and without its signature.
            robot: the only robot that gets it, from 0; None: its addressees.

        Returns:
            Why it was dropped, or the frames sent in reply, for `transmit`.
        """
        there = self.link(link)
        if self._vehicles is None or there is None:
            return FrameOutcome()
        outcome = self._vehicles.hub.receive(link, frame, robot)
        # A dropped frame has no effect, and may hold a secret: it is not recorded.
        if outcome.dropped is None:
            self._inputs.append(inputs.FrameReceived(link, there.name, frame, robot))
        return outcome

    def keep_alive(self) -> None:
        """Send heartbeats in real time while the session is paused or slow."""
        if self._vehicles is not None:
            self._inputs.append(inputs.HeartbeatsSent())
            self.transmit(self._vehicles.hub.keep_alive())

    # The tick

    def step(self) -> TickRecord:
        """Run one tick.

        Raises:
            Exception: of the log or a recorder that cannot write; the session must end then.
        """
        # Inputs from here on, such as the backlog of a reader of what is sent now, are the next tick's.
        given, self._inputs = self._inputs, []
        self._said, self._said_by_all = {}, 0
        self.perform(self._router.exchange())
        forwarded, self._forwarded = tuple(self._forwarded), []
        self._keeper.tap(forwarded)
        # The journal has the keeper's events before any message that follows from them is sent: a crash loses none.
        self._step_role(self._keeper)
        decisions = self._keeper.decisions
        by_keys = self._keys_used(decisions.entries)
        if self._log is not None:
            self._log.append([*decisions.entries, *by_keys])
        for role in self._roles:
            self._step_role(role)
        if self._participant is not None:
            given += [inputs.ParticipantSent(message) for message in self._step_role(self._participant)]
        snapshot = None if self._robots is None else self._robots.snapshot
        sent = [] if self._vehicles is None or snapshot is None else self._vehicles.step(snapshot, self._keeper.state)
        record = TickRecord(
            self.tick,
            tuple(given),
            snapshot,
            forwarded,
            decisions.events,
            decisions.utterances,
            decisions.wizard,
            self._keeper.state,
            () if self._vehicles is None else self._vehicles.hub.take_traffic(),
            () if self._vehicles is None else self._vehicles.statuses,
            decisions.refusals,
        )
        for recorder in self._recorders:
            recorder.record(record)
        self.transmit(sent)
        self.tick += 1
        return record

    def _keys_used(self, entries: Sequence[JournalEntry]) -> list[KeyUsed]:
        """Return what was done by keys since the last tick; in the first of a game, who takes part by one."""
        joined, self._joined = self._joined, []
        granted, self._granted = self._granted, []
        if self.game is None:
            return []
        if any(isinstance(entry, GameStarted) for entry in entries):
            joined = self._router.keyed_programs()
        run = self.run(self.game.started.game)
        return [
            *(KeyUsed(each.credentials.key, f"joined as {each.name}", run) for each in joined),
            *(KeyUsed(key, f"asked: {request}", run) for key, request in granted),
        ]

    def _pass_on(self, request: Request, researcher: str | None = None) -> None:
        """Pass a request on to its role; see `ask`."""
        if isinstance(request, GameRequest):
            self._keeper.ask(request)
        elif self._robots is None:
            raise ValueError("the robots are not in this process")
        else:
            self._robots.ask(request, researcher)

    def _step_role(self, role: Role) -> Sequence[TextMessage]:
        messages = role.step(self.tick, self._router.take(role.name))
        for message in messages:
            self._router.submit(role.name, message)
        return messages


def _drop_frames(sent: Sequence[OutgoingFrame]) -> None:
    """Drop the frames, because no server of links has replaced this function."""
