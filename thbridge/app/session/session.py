"""Session: the roles of this process, which exchange messages through one router, with common ticks.

Inputs from outside arrive between two ticks, through the methods of `Session`, its router and its links. Each input is
recorded as an `Input` of the next tick. For robots at a server of another process, the class is `SimrSession`.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from sim.common.frozen import frozen
from thbridge.app.session import inputs
from thbridge.app.session.inputs import Input, InputQueue
from thbridge.app.session.key_uses import KeyUses
from thbridge.app.session.recorded_links import RecordedLinks
from thbridge.app.session.recorded_router import RecordedRouter
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.hunt.events import Event, GameStarted, JournalEntry, KeyUsed, TeamEntry
from thbridge.hunt.game import GameState
from thbridge.mavlink.wire.outgoing import VehicleStatus
from thbridge.mavlink.wire.traffic import OutgoingFrame, Traffic
from thbridge.roles.keeper.keeper import Keeper, ProgramRefusal
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.roles.shared.robot_requests import GameRequest, Request
from thbridge.roles.shared.robots_role import RobotsRole
from thbridge.roles.shared.role import Role
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.router import (
    Forwarded,
    MessageRouter,
    RouterOutput,
)

if TYPE_CHECKING:  # Only sessions with robots need these.
    from sim.snapshot import TeamSnapshot
    from thbridge.mavlink.role.vehicles import RequestSink, Vehicles


@frozen()
class TickRecord:
    """Record of one tick of a session.

    Attributes:
        tick: number of the tick.
        inputs: inputs from outside, in order.
        snapshot: snapshot of the robots; None if another program runs the robots.
        forwarded: lines that the router has forwarded, in order.
        events: events of the game.
        utterances: utterances in dialogues of the game.
        wizard: robots for which a person speaks, and turns that this person must decide.
        game: state of the game after this tick; None before the first game.
        traffic: frames that vehicles have received and sent from the last tick to the end of this tick, in order.
        vehicles: status of each vehicle; empty if the robots are not vehicles.
        refusals: requests of programs that the keeper has refused, in order.
        team: texts and votes of the participants, in a game with several seats, in order.
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
    team: tuple[TeamEntry, ...] = ()


class TickRecorder(Protocol):
    """Recorder of a session."""

    def record(self, record: TickRecord) -> None:
        """Record one tick. If this raises an exception, the session ends."""


class EventLog(Protocol):
    """Log of the game's events and utterances. They are written before they have any effect."""

    def append(self, entries: Sequence[JournalEntry]) -> None:
        """Write the entries, and return as soon as they are on the disk."""


class DeferredRecording:
    """Placeholder for recorders and log before they are open, for example before the participant has agreed.

    Before `begin`, ticks and entries are dropped, so no tick should be run before `begin`.
    """

    def __init__(self) -> None:
        self._recorders: tuple[TickRecorder, ...] = ()
        self._log: EventLog | None = None

    def begin(self, recorders: Sequence[TickRecorder], log: EventLog | None = None) -> None:
        """Start recording and logging."""
        self._recorders, self._log = tuple(recorders), log

    def record(self, record: TickRecord) -> None:
        """Record one tick; see `TickRecorder`."""
        for recorder in self._recorders:
            recorder.record(record)

    def append(self, entries: Sequence[JournalEntry]) -> None:
        """Write the entries; see `EventLog`."""
        if self._log is not None:
            self._log.append(entries)


def _drop(outputs: Sequence[object]) -> None:
    """Drop the outputs, because there are no connections."""


@dataclass(frozen=True, slots=True)
class SessionOutlets:
    """Servers of a session's connections and links. By default, there are no servers.

    Attributes:
        perform: function that carries out the router's outputs on connections.
        transmit: function that sends frames on links; it must ignore unknown links.
    """

    perform: Callable[[Sequence[RouterOutput]], None] = _drop
    transmit: Callable[[Sequence[OutgoingFrame]], None] = _drop


NO_OUTLETS = SessionOutlets()


class Session:
    """Roles of one process, which run together tick by tick. Messages sent in one tick arrive in the next tick.

    Args:
        keeper: keeper of the game.
        roles: the other roles of this process.
        recorders: recorders that record every tick.
        participants: roles of participants in this process, whose messages are inputs.
        vehicles: factory of the robots' MAVLink vehicles. The argument of the factory receives the vehicles' requests
            to robots and game. These requests follow from frames, so they are not inputs. If None, the robots are not
            MAVLink vehicles.
        log: log of the game's events and of uses of keys. If None, these are not logged.
        outlets: servers of connections and links. For the text server, the router of this session decides.
        run: unique name of this run, which is logged with the uses of keys.

    Attributes:
        tick: number of the next tick.
        router: router for a server of connections from outside.
        links: links for a server of ground stations.
        keys: uses of keys, for the log.

    Raises:
        ValueError: two roles have the same name.
    """

    def __init__(
        self,
        keeper: Keeper,
        roles: Sequence[Role],
        recorders: Sequence[TickRecorder] = (),
        participants: Sequence[Role] = (),
        vehicles: "Callable[[RequestSink], Vehicles] | None" = None,
        log: EventLog | None = None,
        outlets: SessionOutlets = NO_OUTLETS,
        run: str = "",
    ) -> None:
        self.tick = 0
        self._outlets = outlets
        self._run = run
        self._message_router = MessageRouter(name_rule=keeper.refused_name)
        self._keeper = keeper
        self._roles = tuple(roles)
        self._log = log
        self._recorders = tuple(recorders)
        self._participants = tuple(participants)
        self._robots = next((role for role in roles if isinstance(role, RobotsRole)), None)
        self._inputs = InputQueue()
        self._vehicles = None if vehicles is None else vehicles(self._pass_on)
        self.router = RecordedRouter(self._message_router, self._inputs)
        self.links = RecordedLinks(self._vehicles, self._inputs)
        self.keys = KeyUses()
        for role in (keeper, *self._roles, *self._participants):
            taken = self._message_router.local.attach(role.name)
            if taken is not None:
                raise ValueError(f"two programs are called {taken.name}")
            role.connected()

    @property
    def has_vehicles(self) -> bool:
        """True if the robots are MAVLink vehicles."""
        return self._vehicles is not None

    @property
    def game(self) -> GameState | None:
        """State of the game; None before the first game."""
        return self._keeper.state

    @property
    def game_name(self) -> tuple[str, bool]:
        """Unique name of the latest game, and True if this game is over.

        Before the first game begins, it is the name of the first game.
        """
        game = self.game
        if game is None:
            return self._named(self._keeper.last_game + 1), False
        return self._named(game.started.game), game.ended is not None

    @property
    def awaits_no_input(self) -> bool:
        """True if the next tick has no inputs so far."""
        return self._inputs.is_empty

    @property
    def snapshot(self) -> "TeamSnapshot | None":
        """State of the robots; None before the first tick, or if another program runs the robots."""
        return None if self._robots is None else self._robots.snapshot

    def perform(self, outputs: Sequence[RouterOutput]) -> None:
        """Carry out the router's outputs on connections."""
        self._outlets.perform(outputs)

    def transmit(self, sent: Sequence[OutgoingFrame]) -> None:
        """Send frames on their links."""
        self._outlets.transmit(sent)

    @contextmanager
    def undelivered(self) -> Iterator[None]:
        """Drop all output to connections and links in this context, while recorded inputs are given to the session."""
        outlets, self._outlets = self._outlets, NO_OUTLETS
        try:
            yield
        finally:
            self._outlets = outlets

    # Inputs from outside

    def ask(self, sender: str, request: Request) -> None:
        """Pass a request to the robots or the game, in the name of the sender.

        Raises:
            ValueError: the request is to robots, which run in another program.
        """
        self._pass_on(request, sender)
        self._inputs.add(inputs.ClientRequest(sender, request))

    # The tick

    def step(self) -> TickRecord:
        """Run one tick.

        Raises:
            Exception: the log or a recorder cannot write; the session must then end.
        """
        # All inputs from now on belong to the next tick, for example if lines of this tick fill a client's backlog.
        given = self._inputs.take()
        self.perform(self.router.exchange())
        forwarded = self.router.take_forwarded()
        self._keeper.note_left(self.router.take_left())
        self._keeper.tap(forwarded)
        # The keeper's events are written to the journal before any message about them is sent. So after a crash, the
        # journal contains all events that other programs know.
        self._step_role(self._keeper)
        for program, reason in self._keeper.dismissed:
            self.perform(self.router.dismiss(program, reason))
        decisions = self._keeper.decisions
        by_keys = self._keys_used(decisions.entries)
        if self._log is not None:
            self._log.append([*decisions.entries, *by_keys])
        for role in self._roles:
            self._step_role(role)
        for participant in self._participants:
            given += [inputs.ParticipantSent(message) for message in self._step_role(participant)]
        snapshot = self.snapshot
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
            decisions.team,
        )
        for recorder in self._recorders:
            recorder.record(record)
        self.transmit(sent)
        self.tick += 1
        return record

    def _named(self, game: int) -> str:
        """Return the unique name of the game with this number."""
        return f"{self._run}/{game}"

    def keep_alive(self) -> None:
        """Send heartbeats in real time while the session is paused or slow."""
        if self.has_vehicles:
            self.transmit(self.links.keep_alive())

    def _keys_used(self, entries: Sequence[JournalEntry]) -> list[KeyUsed]:
        """Return the uses of keys since the last tick. In the first tick of a game, add all programs with keys."""
        joined = self.router.take_joined()
        if any(isinstance(entry, GameStarted) for entry in entries):
            joined = self._message_router.keyed_programs()
        if not joined and self.keys.is_empty:
            return []
        return self.keys.take("" if self.game is None else self._named(self.game.started.game), joined)

    def _pass_on(self, request: Request, researcher: str | None = None) -> None:
        """Pass a request to its role; see `ask`."""
        if isinstance(request, GameRequest):
            self._keeper.ask(request)
        elif self._robots is None:
            raise ValueError("the robots run in another program")
        else:
            self._robots.ask(request, researcher)

    def _step_role(self, role: Role) -> Sequence[TextMessage]:
        messages = role.step(self.tick, self._message_router.local.take(role.name))
        for message in messages:
            self._message_router.local.submit(role.name, message)
        return messages
