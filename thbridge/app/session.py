"""The session: programs of this process around one router, and the tick they share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from sim.team import TeamSnapshot
from thbridge.dialogue.moves import Utterance
from thbridge.hunt.events import Event
from thbridge.hunt.game import GameState
from thbridge.roles.keeper import Keeper
from thbridge.roles.role import Role
from thbridge.roles.simr import SimR
from thbridge.wire.router import Forwarded, Output, Router


@dataclass(frozen=True, slots=True)
class Moment:
    """All that happened in one tick.

    Attributes:
        tick: which one.
        snapshot: of the robots; None where they are another program's.
        forwarded: the lines that were passed on, in order.
        events: of the game.
        utterances: of its dialogues.
        game: as it stands now; None before the first.
    """

    tick: int
    snapshot: TeamSnapshot | None
    forwarded: tuple[Forwarded, ...]
    events: tuple[Event, ...]
    utterances: tuple[Utterance, ...]
    game: GameState | None


class Witness(Protocol):
    """Whoever keeps a record of a session."""

    def saw(self, moment: Moment) -> None:
        """Take down one tick. May raise; the session then ends."""


class EventLog(Protocol):
    """Where the game's events go before anything follows from them."""

    def append(self, events: Sequence[Event]) -> None:
        """Returns when they are safe."""


class Session:
    """Runs the programs of one process in step: what one says in a tick, the others hear in the next.

    Args:
        router: where they meet, and where programs of other processes join.
        keeper: of the game.
        roles: the other programs of this process.
        log: of the game's events.
        witnesses: who record.

    Attributes:
        tick: the number of the next tick.
        perform: carries out what the router decides. A server of outside connections takes this over, and must give
            every `Forwarded` to `hear`.

    Raises:
        ValueError: two roles have the same name, or one is held already.
    """

    def __init__(
        self,
        router: Router,
        keeper: Keeper,
        roles: Sequence[Role],
        log: EventLog,
        witnesses: Sequence[Witness] = (),
    ) -> None:
        self.tick = 0
        self.perform: Callable[[Sequence[Output]], None] = self._hear_all
        self._router = router
        self._keeper = keeper
        self._roles = tuple(roles)
        self._log = log
        self._witnesses = tuple(witnesses)
        self._heard: list[Forwarded] = []
        for role in (keeper, *self._roles):
            taken = router.attach(role.name)
            if taken is not None:
                raise ValueError(f"two programs are called {taken.name}")
            role.connected()

    @property
    def game(self) -> GameState | None:
        """The game as it stands."""
        return self._keeper.state

    def hear(self, forwarded: Forwarded) -> None:
        """The router passed a line on: the tap of this session."""
        self._heard.append(forwarded)

    def step(self) -> Moment:
        """One tick.

        Raises:
            Exception: whatever the log or a witness raises when it cannot write; the session must end then.
        """
        self.perform(self._router.exchange())
        heard, self._heard = tuple(self._heard), []
        self._keeper.tap(heard)
        self._step_role(self._keeper)
        decided = self._keeper.decided
        self._log.append(decided.events)
        for role in self._roles:
            self._step_role(role)
        snapshot = next((role.snapshot for role in self._roles if isinstance(role, SimR)), None)
        moment = Moment(self.tick, snapshot, heard, decided.events, decided.utterances, self._keeper.state)
        for witness in self._witnesses:
            witness.saw(moment)
        self.tick += 1
        return moment

    def _step_role(self, role: Role) -> None:
        for message in role.step(self.tick, self._router.take(role.name)):
            self._router.submit(role.name, message)

    def _hear_all(self, outputs: Sequence[Output]) -> None:
        for output in outputs:
            if isinstance(output, Forwarded):
                self.hear(output)
