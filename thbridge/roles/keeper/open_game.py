"""The open game: its state, dialogues, last refusal, and the journal entries of the present step."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from msgspec import structs

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.moves import Author, Conclude, DialogueUtterance, Scenario, Speaker, move_text
from thbridge.dialogue.robot_arguments import WhereFacts
from thbridge.hunt import game, rules
from thbridge.hunt.events import (
    DecisionOutcome,
    DecisionSettled,
    DialogueOpened,
    DialogueSaid,
    GameStarted,
    JournalEntry,
    KeyUsed,
    MoveFailed,
    RobotDeparted,
    TeamEntry,
    TreasurePictured,
)
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.roles.keeper.advice.adviser import Advice
from thbridge.roles.keeper.advice.robot_knowledge import RobotKnowledge
from thbridge.roles.keeper.dialogues import GameDialogues
from thbridge.roles.keeper.handbacks import RecentHandbacks
from thbridge.roles.keeper.moves import TeamMoves
from thbridge.roles.keeper.team.game_team import GameTeam, TeamRules
from thbridge.roles.shared.failure_reasons import CALLED_BACK
from thbridge.roles.shared.view import RefusalView


class OpenGame:
    """The keeper's open game.

    Every change of the game is made by this class, and is an entry of the journal.

    Args:
        engine: function that returns the dialogue engine for the game with a number.
        last_game: number of the last game.
        room_names: names of the map's rooms.
        knowledge: knowledge of robots.
        team_rules: rules for the participants of a game with several seats.

    Attributes:
        state: state of the game; None before the first game.
        last_game: number of the current or last game.
        tick: present tick. After an interruption, ticks continue, so that earlier utterances have smaller ticks.
        attended: tick of the last event or request about each robot, by robot.
        dialogues: dialogues of the game.
        moves: moves of the robots.
        handbacks: robots that the participant has recently asked commanders to give back.
        knowledge: knowledge of robots.
        team: the participants, with their texts and votes.
        refusals: the last refusal of each seat in this game, for its view, by the seat's name.
        last_refusal: the latest of these refusals.
    """

    def __init__(
        self,
        engine: Callable[[int], DialogueEngine],
        last_game: int,
        room_names: RoomNames,
        knowledge: RobotKnowledge,
        team_rules: TeamRules | None = None,
    ) -> None:
        self._engine = engine
        self._room_names = room_names
        self.knowledge = knowledge
        self.last_game = last_game
        self.state: GameState | None = None
        self.dialogues = GameDialogues(engine(last_game), room_names=room_names)
        self.moves = TeamMoves(0)
        self.handbacks = RecentHandbacks()
        self._team_rules = team_rules or TeamRules()
        self.team = GameTeam(self._team_rules)
        self.attended: dict[int, int] = {}
        self.tick = self._restored_until = 0
        self.refusals: dict[str, RefusalView] = {}
        self.last_refusal: RefusalView | None = None
        self._refusal_count = 0
        self._seat, self._is_researcher = "", False
        self._stopped_by: dict[int, str] = {}
        self._entries: list[JournalEntry] = []
        self._utterances: list[DialogueUtterance] = []

    def advance(self, tick: int) -> bool:
        """Set the current tick.

        Return True if participants may now ask for a robot again, or if the time for texts begins or ends.
        """
        was_open = self.team.talk.is_open(self.seconds)
        self.tick = self._restored_until + tick
        return self.handbacks.advance(self.tick) or self.team.talk.is_open(self.seconds) != was_open

    @property
    def seconds(self) -> float:
        """Simulated time of the current tick, s."""
        return self.tick / TICKS_PER_SECOND

    @contextmanager
    def acting(self, seat: str, *, is_researcher: bool = False) -> Iterator[None]:
        """Note in this context that the participant of a seat, or a researcher in their place, causes all events."""
        self._gather_utterances()
        self._seat, self._is_researcher = seat, is_researcher
        yield
        self._gather_utterances()
        self._seat, self._is_researcher = "", False

    def attend(self, robot: int) -> None:
        """Record the participant's attention to a robot."""
        self.attended[robot] = self.tick

    def restore(self, history: Iterable[JournalEntry]) -> None:
        """Restore state and dialogues from the journal of an unfinished game, without recording entries again."""
        for entry in history:
            if isinstance(entry, DialogueOpened | TeamEntry):
                self.tick = self._restored_until = round(entry.at * TICKS_PER_SECOND)
            self._apply(entry, restored=True)
            if self.state is not None:
                self.dialogues.drop_stale(self.state)
        self.knowledge.unreached.reported()
        if self.state is not None:
            self.dialogues.go_on(self.state)

    def record(self, entries: Sequence[JournalEntry]) -> None:
        """Apply entries, and add them to the queue for the journal."""
        for entry in map(self._signed, entries):
            self._gather_utterances()
            # Queue utterances first, so that the journal has the utterances of a dialogue directly after its opening.
            self._entries.append(entry)
            self._apply(entry)
        if entries and self.state is not None:
            self.dialogues.drop_stale(self.state)

    def _signed(self, entry: JournalEntry) -> JournalEntry:
        """Return an entry with the seat that causes it."""
        seat = self._stopped_by.pop(entry.robot, "") if isinstance(entry, MoveFailed) else self._seat
        return structs.replace(entry, seat=seat) if seat and "seat" in entry.__struct_fields__ else entry

    def _gather_utterances(self) -> None:
        """Add the utterances since the last call to the queue for the journal."""
        taken = self.dialogues.take_utterances()
        if not taken:
            return
        fresh = [
            replace(said, seat=self._seat, author=Author.WIZARD if self._is_researcher else said.author)
            if said.speaker is Speaker.PERSON
            else said
            for said in taken
        ]
        self._utterances += fresh
        self._entries += [
            DialogueSaid(
                said.dialogue,
                said.index,
                said.speaker,
                said.author,
                move_text(said.move),
                said.text,
                said.seat,
            )
            for said in fresh
            # A conclusion is not a turn. The turns determine the conclusion.
            if not isinstance(said.move, Conclude)
        ]

    def apply_ruling(self, request: str, ruling: rules.Ruling) -> bool:
        """Record the events of a ruling, or store its refusal for the view. Return True if events were recorded."""
        if isinstance(ruling, RequestRefused):
            self.refuse(request, ruling)
            return False
        self.record(ruling)
        return True

    def refuse(self, request: str, refused: RequestRefused, robot: int | None = None) -> None:
        """Store a refusal for the view of the acting seat, or of the seat that commands this robot."""
        self._refusal_count += 1
        self.last_refusal = RefusalView(self._refusal_count, request, refused.reason, refused.sentence)
        seat = self._seat if robot is None or self.state is None else self.state.robots[robot].seat
        self.refusals[seat] = self.last_refusal

    def advice(self, state: GameState, robot: int) -> Advice | RequestRefused:
        """Return the present advice of a robot."""
        return self.knowledge.advice(state, self.dialogues, robot)

    def where_facts(self, state: GameState, robot: int, advised: Room) -> WhereFacts:
        """Return the facts of a robot that argues about its next room. `advised` is the room that its planner chose."""
        return self.knowledge.where(state, self.dialogues, robot, self.tick, advised)

    def stop(self, robot: int) -> None:
        """Stop a moving robot. The move ends when SimR reports the driven share.

        If SimR does not have the order for this move yet, the move ends now.
        """
        self._stopped_by[robot] = self._seat
        if self.state is not None and not self.moves.is_ordered(robot):
            self.apply_ruling("Failed", rules.fail(self.state, robot, CALLED_BACK, 0.0))
        else:
            self.moves.stop(robot)

    def take_entries(self) -> tuple[JournalEntry, ...]:
        """Return the entries for the journal since the last call, in order."""
        self._gather_utterances()
        entries, self._entries = self._entries, []
        return tuple(entries)

    def take_utterances(self) -> tuple[DialogueUtterance, ...]:
        """Return the utterances since the last call, in order."""
        self._gather_utterances()
        utterances, self._utterances = self._utterances, []
        return tuple(utterances)

    def _apply(self, event: JournalEntry, *, restored: bool = False) -> None:
        if isinstance(event, KeyUsed):
            return
        if isinstance(event, TeamEntry):
            self._note_team(event)
            return
        if isinstance(event, DialogueOpened | DialogueSaid):
            if self.state is not None:
                self._talk(self.state, event, restored=restored)
            return
        self.knowledge.unreached.note(event, self.state, self.moves)
        if isinstance(event, GameStarted):
            self._begin(event)
        elif self.state is not None:
            self.state = game.apply(self.state, event)
        self.moves.note(event)
        self.handbacks.note(event, self.tick)
        if isinstance(event, RobotDeparted):
            self.dialogues.agreements.withdraw(event.robot, "select-room")
        if isinstance(event, TreasurePictured):
            self.dialogues.agreements.withdraw(event.robot, "take-picture")
        robot = getattr(event, "robot", None)
        if isinstance(robot, int):
            self.attend(robot)

    def _note_team(self, entry: TeamEntry) -> None:
        """Process an entry about participants. A vote without success also ends the agreement with the robot.

        Otherwise the programs of participants would propose the same again at once.
        """
        if isinstance(entry, DecisionSettled) and entry.outcome is not DecisionOutcome.CARRIED:
            proposed = self.team.decisions.proposed(entry.decision)
            if proposed is not None and proposed.robot is not None:
                self.dialogues.agreements.withdraw(proposed.robot, "select-room")
            elif proposed is not None and proposed.room is not None:
                self.dialogues.agreements.withdraw_name(proposed.room, proposed.name)
        self.team.note(entry)

    def _begin(self, started: GameStarted) -> None:
        self.state = game.begin(started)
        self.last_game = started.game
        self.dialogues = GameDialogues(self._engine(started.game), self.dialogues.puppets, self._room_names)
        self.moves = TeamMoves(started.robots)
        self.handbacks = RecentHandbacks()
        self.team = GameTeam(self._team_rules)
        self.knowledge.begin()
        self.refusals, self.last_refusal = {}, None
        self._stopped_by = {}
        self.attended = dict.fromkeys(range(started.robots), self.tick)

    def _talk(self, state: GameState, entry: DialogueOpened | DialogueSaid, *, restored: bool) -> None:
        if isinstance(entry, DialogueSaid):
            self.dialogues.retake(state, entry)
            return
        self.dialogues.open(
            state,
            Scenario(entry.scenario),
            entry.robot,
            entry.room,
            entry.reason,
            entry.confidence,
            facts=self.knowledge.about(state, self.dialogues, entry, self.tick),
            opener=Speaker(entry.opener),
            name=entry.name,
            restored=entry.dialogue if restored else None,
        )
        self.attend(entry.robot)
