"""Game of several seats without a simulator, in which the test decides what each participant requests, and who leaves.

The keeper, the robots' program of trials and Hider exchange messages as in a session; the participants are the test.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

from sim.common.observations import TICKS_PER_SECOND
from tests.support.hunts.hunt_without_simulator import RULES, scripted_engine, templates
from thbridge.app.compose.game import build_bot, build_hider, known_treasures
from thbridge.app.trials.puppets import Puppets
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.games.strategies import Attitude
from thbridge.hunt.events import Event, JournalEntry, TeamEntry
from thbridge.hunt.game import GameState
from thbridge.hunt.seats import Seat
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.disclosure import plain_costs
from thbridge.roles.keeper.keeper import Keeper, ProgramRefusal
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import ParticipantUpdate
from thbridge.roles.shared.notices import KEEPER, FloorPlan, ParticipantReady, RoomOutline
from thbridge.roles.shared.role import Role
from thbridge.roles.shared.seat_programs import (
    is_researchers,
    program_of,
    researchers_program,
    seat_name_of,
)
from thbridge.roles.shared.team_notices import TalkLine, TeamTalk
from thbridge.roles.shared.view import AnswerDialogue, ParticipantRequest, SelectRoom, SendRobot, View
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import NoticeDecoder, NoticeValue, encode_notice
from thbridge.text_protocol.wire.router import Forwarded

ROOMS = tuple(RoomOutline(room, "Kitchen" if room == 2 else "", (), (0.0, 0.0, 0.0)) for room in range(1, 9))
PLAN = FloorPlan("stage", 0.1, (0.0, 0.0, 0.0), 1, 1, "", ROOMS, ())
_UPDATES = NoticeDecoder[ParticipantUpdate](ParticipantUpdate)


class SeatedHunt:
    """Game of these seats. All participants have joined.

    Attributes:
        entries: entries of the journal.
        shown: all notices that each participant received, oldest first, by seat.
        refusals: all refusals.
        present: seats whose participants are connected.
        dismissed: programs of researchers that had to leave, with the reasons.
    """

    def __init__(
        self,
        seats: Sequence[Seat],
        team: TeamRules | None = None,
        robots: int = 2,
        energy: float = 100.0,
        history: Sequence[JournalEntry] = (),
        talk: DialogueEngine | None = None,
    ) -> None:
        self.templates = templates()
        known = known_treasures(self.templates)
        names = tuple(sorted(kind.name for kind in self.templates.kinds))
        briefing = Briefing(PLAN, names, kinds=known, properties=self.templates.properties, worth=(10,) * len(names))
        rules = replace(RULES, energy=energy, seats=tuple(seats), team=team or TeamRules())
        last_game = 1 if history else 0
        self.keeper = Keeper(rules, lambda game: talk or scripted_engine(self.templates), history, last_game, briefing)
        self.puppets = Puppets(robots, plain_costs(templates().costs))
        self._roles: list[Role] = [self.keeper, self.puppets, build_hider(self.templates, 7)]
        self.entries: list[JournalEntry] = [*history]
        self.shown: dict[str, list[ParticipantUpdate]] = {seat.name: [] for seat in seats}
        self.refusals: list[ProgramRefusal] = []
        self.present: set[str] = set()
        self._researchers: set[str] = set()
        self.dismissed: list[tuple[str, str]] = []
        self._left: list[str] = []
        self._tick = 0
        self._queue: list[TextMessage] = []
        self._bots = {
            seat.name: build_bot(self.templates, BotStrategy.NEAREST, number, Attitude.CREDULOUS)
            for number, seat in enumerate(seats)
        }
        for role in self._roles:
            role.connected()
        for seat in seats:
            self.join(seat.name)
        self.run(10)

    # What participants do

    def join(self, seat: str, run: str = "", *, simulated: bool = False) -> None:
        """Connect the program of a seat, for the first time or again; another program has another run."""
        self.present.add(seat)
        self._queue.append(encode_notice(program_of(seat), KEEPER, ParticipantReady(run, simulated)))

    def leave(self, seat: str) -> None:
        """Disconnect the program of a seat."""
        self.present.discard(seat)
        self._left.append(program_of(seat))

    def take_as_researcher(self, seat: str) -> str:
        """Connect the program of a researcher for a seat. Return the reason why it is refused; empty if it is not."""
        refused = self.keeper.refused_name(researchers_program(seat), True)
        if refused is not None:
            return refused.reason
        self._researchers.add(seat)
        self._queue.append(encode_notice(researchers_program(seat), KEEPER, ParticipantReady("")))
        self.run(3)
        return ""

    def ask_as_researcher(self, seat: str, *requests: NoticeValue) -> None:
        """Send requests of a researcher in the place of a participant."""
        self._queue += [encode_notice(researchers_program(seat), KEEPER, request) for request in requests]
        self.run(3)

    def ask(self, seat: str, *requests: ParticipantRequest, ticks: int = 3) -> View:
        """Send requests of a participant, and return the view after some ticks."""
        self._queue += [encode_notice(program_of(seat), KEEPER, request) for request in requests]
        self.run(ticks)
        return self.view(seat)

    def send(self, seat: str, robot: int, room: int, ticks: int = 3) -> View:
        """Send a robot to a room, after agreeing to all that it asks."""
        view = self.ask(seat, SelectRoom(robot, room))
        while view.dialogues:
            dialogue = view.dialogues[0]
            view = self.ask(seat, AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
        return self.ask(seat, SendRobot(robot, room), ticks=ticks)

    def play(self, seat: str) -> None:
        """Send all that a simulated participant requests in the present view of a seat."""
        self.ask(seat, *self._bots[seat].requests(self.view(seat)))

    def run(self, ticks: int) -> None:
        """Run some ticks."""
        for _ in range(ticks):
            self._step()

    def _step(self) -> None:
        queue, self._queue = self._queue, []
        inboxes: defaultdict[str, list[TextMessage]] = defaultdict(list)
        forwarded = []
        for message in queue:
            seat = seat_name_of(message.receiver)
            here = self._researchers if is_researchers(message.receiver) else self.present
            delivered = not seat or seat in here
            forwarded.append(Forwarded(message, delivered, sender_extended=True))
            if not seat:
                inboxes[message.receiver].append(message)
            elif delivered and (update := _UPDATES.read(message)) is not None:
                self.shown[seat].append(update)
        left, self._left = self._left, []
        self.keeper.tap(forwarded)
        self.keeper.note_left(left)
        for role in self._roles:
            self._queue += role.step(self._tick, inboxes[role.name])
        self._tick += 1
        self.entries += self.keeper.decisions.entries
        self.refusals += self.keeper.decisions.refusals
        self.dismissed += self.keeper.dismissed
        for program, _ in self.keeper.dismissed:
            self._researchers.discard(seat_name_of(program))

    # What happened

    @property
    def game(self) -> GameState:
        """State of the game."""
        assert self.keeper.state is not None
        return self.keeper.state

    @property
    def seconds(self) -> float:
        """Simulated time, s."""
        return self._tick / TICKS_PER_SECOND

    def view(self, seat: str) -> View:
        """Return the latest view of a seat."""
        return next(each for each in reversed(self.shown[seat]) if isinstance(each, View))

    def texts(self, seat: str) -> list[TalkLine]:
        """Return all texts that a participant has received, oldest first, with repetitions."""
        return [line for each in self.shown[seat] if isinstance(each, TeamTalk) for line in each.lines]

    def events(self, *kinds: type) -> list[Event | TeamEntry]:
        """Return the journal's entries of these classes."""
        return [entry for entry in self.entries if isinstance(entry, kinds)]

    @property
    def refused(self) -> str:
        """Sentence of the latest refusal."""
        return self.refusals[-1].refused.sentence
