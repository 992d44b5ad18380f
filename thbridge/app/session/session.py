"""The session: programs of this process around one router, and the tick they share.

Whatever comes from outside comes in between two ticks, by the methods of `Session` (or of `Outpost`, for robots whose
server is another process), and becomes an `Input` of the next one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from sim.team import TeamSnapshot
from thbridge.app.session.inputs import (
    Advanced,
    Asked,
    Backlogged,
    Closed,
    Framed,
    Input,
    KeptAlive,
    LinkClosed,
    LinkOpened,
    Opened,
    Received,
    Said,
)
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.hunt.events import Event
from thbridge.hunt.game import GameState
from thbridge.roles.keeper.keeper import Keeper
from thbridge.roles.keeper.wizard import WizardState
from thbridge.roles.robot_requests import GameRequest, Request
from thbridge.roles.role import Role
from thbridge.roles.simr.simr import SimR
from thbridge.roles.vehicles.vehicles import RequestSink, Vehicles
from thbridge.wire.mavlink.frames.frame import Frame
from thbridge.wire.mavlink.hub import OutgoingFrame, Traffic
from thbridge.wire.mavlink.links import DropReason, LinkReport
from thbridge.wire.mavlink.outgoing import LinkId, VehicleStatus
from thbridge.wire.router import ConnectionId, Forwarded, MessageRouter, RouterOutput, TurnedAway
from thbridge.wire.text import TextMessage


@dataclass(frozen=True, slots=True)
class TickRecord:
    """All that happened in one tick.

    Attributes:
        tick: which one.
        inputs: what had come from outside, in order.
        snapshot: of the robots; None where they are another program's.
        forwarded: the lines that were passed on, in order.
        events: of the game.
        utterances: of its dialogues.
        held: what waits for whoever speaks in robots' place.
        game: as it stands now; None before the first.
        traffic: the frames that vehicles heard since the last tick, and said since then and in this one, in order.
        vehicles: how each stands; empty where the robots are none.
    """

    tick: int
    inputs: tuple[Input, ...]
    snapshot: TeamSnapshot | None
    forwarded: tuple[Forwarded, ...]
    events: tuple[Event, ...]
    utterances: tuple[DialogueUtterance, ...]
    wizard: WizardState
    game: GameState | None
    traffic: tuple[Traffic, ...] = ()
    vehicles: tuple[VehicleStatus, ...] = ()


class TickRecorder(Protocol):
    """Whoever keeps a record of a session."""

    def record(self, moment: TickRecord) -> None:
        """Take down one tick. May raise; the session then ends."""


class EventLog(Protocol):
    """Where the game's events go before anything follows from them."""

    def append(self, events: Sequence[Event]) -> None:
        """Returns when they are safe."""


class Session:
    """Runs the programs of one process in step: what one says in a tick, the others hear in the next.

    Args:
        router: where they meet, and where programs of other processes join; from now on only through this session.
        keeper: of the game.
        roles: the other programs of this process.
        log: of the game's events.
        witnesses: who record.
        participant: whoever plays in this process, if anybody; what they say comes from outside.
        vehicles: makes the robots MAVLink vehicles, given who takes what these ask of robots and game; what they ask
            follows from frames, and so is no input. None: they are none.

    Attributes:
        tick: the number of the next tick.
        perform: carries out what the router decides. A server of outside connections takes this over, and must give
            every `Forwarded` to `hear`. This session is the switchboard of such a server.
        transmit: sends frames on their links, of which it may not know all. Whoever serves links takes this over.

    Raises:
        ValueError: two roles have the same name, or one is held already.
    """

    def __init__(
        self,
        router: MessageRouter,
        keeper: Keeper,
        roles: Sequence[Role],
        log: EventLog,
        recorders: Sequence[TickRecorder] = (),
        participant: Role | None = None,
        vehicles: Callable[[RequestSink], Vehicles] | None = None,
    ) -> None:
        self.tick = 0
        self.perform: Callable[[Sequence[RouterOutput]], None] = self._hear_all
        self.transmit: Callable[[Sequence[OutgoingFrame]], None] = _untransmitted
        self._router = router
        self._keeper = keeper
        self._roles = tuple(roles)
        self._log = log
        self._witnesses = tuple(recorders)
        self._participant = participant
        self._simr = next((role for role in roles if isinstance(role, SimR)), None)
        self._inputs: list[Input] = []
        self._heard: list[Forwarded] = []
        self._vehicles = None if vehicles is None else vehicles(self._pass_on)
        for role in (keeper, *self._roles, *(() if participant is None else (participant,))):
            taken = router.attach(role.name)
            if taken is not None:
                raise ValueError(f"two programs are called {taken.name}")
            role.connected()

    @property
    def has_vehicles(self) -> bool:
        """Whether the robots are MAVLink vehicles."""
        return self._vehicles is not None

    @property
    def game(self) -> GameState | None:
        """The game as it stands."""
        return self._keeper.state

    def note_forwarded(self, forwarded: Forwarded) -> None:
        """The router passed a line on: the tap of this session."""
        self._heard.append(forwarded)

    # What comes from outside

    def ask(self, sender: str, request: Request) -> None:
        """Ask something of the robots, or in a robot's place of the game, in the name of whoever wants it.

        Raises:
            ValueError: the robots are another program's.
        """
        self._pass_on(request, sender)
        self._inputs.append(Asked(sender, request))

    def connect(self, now: float) -> ConnectionId | TurnedAway:
        """See `Router`, for this and the next ones; only what makes a difference counts as an input."""
        connection = self._router.connect(now)
        if not isinstance(connection, TurnedAway):
            self._inputs.append(Opened(connection, now))
        return connection

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> list[RouterOutput]:
        """Each line is an input of its own."""
        outputs: list[RouterOutput] = []
        for line in data.splitlines(keepends=True):
            sender = self._router.called(connection)
            if sender is None:
                break
            self._inputs.append(Received(connection, sender, line, now))
            outputs += self._router.receive_data(connection, line, now)
        return outputs

    def eof(self, connection: ConnectionId) -> list[RouterOutput]:
        """A connection that is open ends."""
        sender = self._router.called(connection)
        if sender is not None:
            self._inputs.append(Closed(connection, sender))
        return self._router.eof(connection)

    def report_backlog(self, connection: ConnectionId, size: int) -> list[RouterOutput]:
        """Somebody does not read."""
        sender = self._router.called(connection)
        outputs = self._router.report_backlog(connection, size)
        if sender is not None and outputs:
            self._inputs.append(Backlogged(connection, sender, size))
        return outputs

    def advance(self, now: float) -> list[RouterOutput]:
        """Time has passed."""
        outputs = self._router.advance(now)
        if outputs:
            self._inputs.append(Advanced(now))
        return outputs

    def stop(self) -> list[RouterOutput]:
        """The end: nothing comes in any more."""
        return self._router.stop()

    def open_link(self, name: str, robot: int | None = None) -> LinkId:
        """Somebody may speak to the robots' vehicles, on a link of this name.

        Args:
            name: of the link.
            robot: the only one that is to be found there, from 0; None: all are.

        Raises:
            ValueError: the robots are no vehicles.
        """
        if self._vehicles is None:
            raise ValueError("the robots are no vehicles")
        link = self._vehicles.open(name, robot)
        self._inputs.append(LinkOpened(link, name, robot))
        return link

    def close_link(self, link: LinkId) -> None:
        """A link ends, if it has not ended before."""
        name = None if self._vehicles is None else self._vehicles.name_of(link)
        if self._vehicles is not None and name is not None:
            self._vehicles.close(link)
            self._inputs.append(LinkClosed(link, name))

    def report(self, link: LinkId) -> LinkReport | None:
        """How a link stands; None: there is no such link."""
        return None if self._vehicles is None else self._vehicles.report(link)

    def why_not(self, link: LinkId, frame: Frame) -> DropReason | None:
        """Why a frame that comes in on a link would be dropped; None: it would be taken."""
        return None if self._vehicles is None else self._vehicles.why_not(link, frame)

    def receive_frame(self, link: LinkId, frame: Frame, robot: int | None = None) -> list[OutgoingFrame]:
        """A frame came in.

        It acts at once on vehicles, as these stood after the last tick; what they ask of robots and game for it, is
        done with the next.

        Args:
            link: where; a frame of a link that there is not is forgotten.
            frame: checked, and without its signature.
            robot: the only one that is to hear it; None: whoever it is meant for.

        Returns:
            What goes out for it, for `transmit`.
        """
        name = None if self._vehicles is None else self._vehicles.name_of(link)
        if self._vehicles is None or name is None:
            return []
        # What is dropped changes nothing, and may be a secret: it is not recorded.
        if self._vehicles.why_not(link, frame) is None:
            self._inputs.append(Framed(link, name, frame, robot))
        return self._vehicles.receive(link, frame, robot)

    def keep_alive(self) -> None:
        """Time has passed for ground stations and none for the session: robots say that they are alive."""
        if self._vehicles is not None:
            self._inputs.append(KeptAlive())
            self.transmit(self._vehicles.keep_alive())

    # The tick

    def step(self) -> TickRecord:
        """One tick.

        Raises:
            Exception: whatever the log or a witness raises when it cannot write; the session must end then.
        """
        # What comes in from here on, a reader that lags behind what is sent now for example, is the next tick's.
        inputs, self._inputs = self._inputs, []
        self.perform(self._router.exchange())
        heard, self._heard = tuple(self._heard), []
        self._keeper.tap(heard)
        self._step_role(self._keeper)
        decided = self._keeper.decisions
        self._log.append(decided.events)
        for role in self._roles:
            self._step_role(role)
        if self._participant is not None:
            inputs += [Said(message) for message in self._step_role(self._participant)]
        snapshot = None if self._simr is None else self._simr.snapshot
        sent = [] if self._vehicles is None or snapshot is None else self._vehicles.step(snapshot, self._keeper.state)
        moment = TickRecord(
            self.tick,
            tuple(inputs),
            snapshot,
            heard,
            decided.events,
            decided.utterances,
            decided.wizard,
            self._keeper.state,
            () if self._vehicles is None else self._vehicles.take_traffic(),
            () if self._vehicles is None else self._vehicles.statuses,
        )
        for witness in self._witnesses:
            witness.record(moment)
        self.transmit(sent)
        self.tick += 1
        return moment

    def _pass_on(self, request: Request, researcher: str | None = None) -> None:
        """To the role that does what is asked; see `ask`."""
        if isinstance(request, GameRequest):
            self._keeper.ask(request)
        elif self._simr is None:
            raise ValueError("the robots are not in this process")
        else:
            self._simr.ask(request, researcher)

    def _step_role(self, role: Role) -> Sequence[TextMessage]:
        said = role.step(self.tick, self._router.take(role.name))
        for message in said:
            self._router.submit(role.name, message)
        return said

    def _hear_all(self, outputs: Sequence[RouterOutput]) -> None:
        for output in outputs:
            if isinstance(output, Forwarded):
                self.note_forwarded(output)


def _untransmitted(sent: Sequence[OutgoingFrame]) -> None:
    """Nobody serves links."""
