"""The open game: its state, the journal entries of this step, the dialogues, the last refusal."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from msgspec import structs

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.evidence import WhatFacts, WhereFacts
from thbridge.dialogue.moves import Conclude, DialogueUtterance, Scenario, Speaker, move_text
from thbridge.hunt import game, rules
from thbridge.hunt.events import (
    CommanderChanged,
    DialogueOpened,
    DialogueSaid,
    GameStarted,
    HandbackRequested,
    JournalEntry,
    KeyUsed,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    TreasurePictured,
)
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.tour import NoTour
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.adviser import Advice, Adviser
from thbridge.roles.keeper.advice.neglect import decide_about_treasure, decide_to_go, neglected
from thbridge.roles.keeper.advice.robot_facts import what_facts, where_facts
from thbridge.roles.keeper.dialogues import MATTERS, GameDialogues
from thbridge.roles.shared.failure_reasons import CALLED_BACK
from thbridge.roles.shared.notices import MoveOrder
from thbridge.roles.shared.view import RefusalView, RequestSuggestion
from thbridge.text_protocol.wire.notice import kind_of

_ASK_AGAIN = 10 * TICKS_PER_SECOND
"""Ticks after which the participant may ask for the same robot again."""


_READING = 30 * TICKS_PER_SECOND
"""Ticks that a robot gives the participant at least to read what it has said, and to answer."""


class OpenGame:
    """The game in progress, as the keeper knows it; every change is an entry of the journal and passes through here.

    Args:
        engine: makes the dialogue engine of a game, given the game's number.
        last_game: number of the last game so far.
        room_names: names of the map's rooms.
        adviser: suggests rooms in the place of robots.
        kinds: treasures that there are, as everybody knows them.
        patience: ticks after which a robot that nobody attends to decides by itself; None: it waits for ever.

    Attributes:
        adviser: as above.
    """

    def __init__(
        self,
        engine: Callable[[int], DialogueEngine],
        last_game: int,
        room_names: RoomNames,
        adviser: Adviser,
        kinds: tuple[TreasureKind, ...] = (),
        patience: int | None = None,
    ) -> None:
        self._engine = engine
        self.adviser = adviser
        self._room_names = room_names
        self._kinds = kinds
        self._patience = patience
        # By robot, the tick at which something last happened to it, or was asked of it.
        self._attended: dict[int, int] = {}
        # Robots that did not get where they were sent, and have not said so yet.
        self._to_report: set[int] = set()
        # By robot, the rooms that it could not reach since it last reached one.
        self._unreached: dict[int, frozenset[Room]] = {}
        self.last_game = last_game
        self.state: GameState | None = None
        self.dialogues = GameDialogues(engine(last_game), room_names=room_names)
        # By robot, the tick of the participant's request to get it back.
        self._asked_back: dict[int, int] = {}
        # Ticks go on where they were when the game was cut off, so that what was told before is not the fresher.
        self._tick = self._restored_until = 0
        self.refusal: RefusalView | None = None
        self._refusals = 0
        # The number of each robot's latest move in this game; then those of them that are ordered to SimR.
        self._moves: list[int] = []
        self._ordered: list[int] = []
        self._departures = 0
        self._recalled: set[int] = set()
        self._entries: list[JournalEntry] = []
        self._utterances: list[DialogueUtterance] = []

    @property
    def asked_back(self) -> frozenset[int]:
        """Robots that the participant asked for in the last ten seconds, and cannot ask for again."""
        return frozenset(self._asked_back)

    def advance(self, tick: int) -> bool:
        """Set the current tick; return True when a robot may be asked for again."""
        now = self._tick = self._restored_until + tick
        before = len(self._asked_back)
        self._asked_back = {robot: asked for robot, asked in self._asked_back.items() if now - asked < _ASK_AGAIN}
        return len(self._asked_back) < before

    def attend(self, robot: int) -> None:
        """Note that the participant attends to a robot."""
        self._attended[robot] = self._tick

    def decide_alone(self) -> bool:
        """Let robots decide that nobody has attended to for too long; return True if any did."""
        state = self.state
        if state is None or self._patience is None:
            return False
        waiting = [
            robot
            for robot in neglected(state, self._attended, self._tick, self._patience)
            # Reading a robot's reasons is attending to it.
            if not self.dialogues.is_talking(robot) or self._tick - self._attended.get(robot, 0) >= _READING
        ]
        for robot in waiting:
            self.attend(robot)
            if self.state is not None:
                self._decide_alone(self.state, robot)
        return bool(waiting)

    def _decide_alone(self, state: GameState, robot: int) -> None:
        here = state.robots[robot].at
        names = what_facts(state, robot, here, self._kinds, self._tick).names if state.has_room(here) else ()
        decision = decide_about_treasure(state, robot, names)
        if decision is None:
            advice = self.advice(state, robot)
            room = None if isinstance(advice, RequestRefused) else advice.room
            if room is not None and self.dialogues.argues and not isinstance(advice, RequestRefused):
                room = self.dialogues.decision(self._where_facts(state, robot, advice.room))
            decision = None if room is None else decide_to_go(state, robot, room)
        if decision is not None:
            self.record(decision.events)
            if decision.departs and self.state is not None:
                waited = (self._patience or 0) / TICKS_PER_SECOND
                self.dialogues.decided_alone(self.state, robot, decision.room, waited)

    def report_failures(self) -> None:
        """Let robots that argue say where they would go instead, when they did not get where they were sent."""
        for robot in sorted(self._to_report):
            state = self.state
            if state is None or not self.dialogues.argues or robot in self.dialogues.puppets:
                continue
            advice = self.advice(state, robot)
            if not isinstance(advice, RequestRefused) and not rules.unable(state, robot):
                facts = self._where_facts(state, robot, advice.room)
                if self.dialogues.decision(facts) is not None:
                    self.suggest(state, robot, advice, unasked=True)
        self._to_report.clear()

    def restore(self, history: Iterable[JournalEntry]) -> None:
        """Restore state and dialogues from the journal of an unfinished game; nothing of it is recorded again."""
        for entry in history:
            if isinstance(entry, DialogueOpened):
                self._tick = self._restored_until = round(entry.at * TICKS_PER_SECOND)
            self._apply(entry, restored=True)
            if self.state is not None:
                self.dialogues.drop_stale(self.state)
        self._to_report.clear()
        if self.state is not None:
            self.dialogues.go_on(self.state)

    def record(self, entries: Sequence[JournalEntry]) -> None:
        """Apply entries, and queue them for the journal."""
        for entry in entries:
            self._gather_utterances()
            # What is said in a dialogue comes after its opening.
            self._entries.append(entry)
            self._apply(entry)
        if entries and self.state is not None:
            self.dialogues.drop_stale(self.state)

    def _gather_utterances(self) -> None:
        """Queue what was said since the last call for the journal."""
        fresh = self.dialogues.take_utterances()
        self._utterances += fresh
        self._entries += [
            DialogueSaid(said.dialogue, said.index, said.speaker, said.author, move_text(said.move), said.text)
            for said in fresh
            # It follows from the turns, and is none.
            if not isinstance(said.move, Conclude)
        ]

    def apply_ruling(self, request: str, ruling: rules.Ruling) -> bool:
        """Record the events of a ruling, or keep its refusal for the view; return True if it was allowed."""
        if isinstance(ruling, RequestRefused):
            self.refuse(request, ruling)
            return False
        self.record(ruling)
        return True

    def refuse(self, request: str, refused: RequestRefused) -> None:
        """Keep a refusal for the view."""
        self._refusals += 1
        self.refusal = RefusalView(self._refusals, request, refused.reason, refused.sentence)

    def advice(self, state: GameState, robot: int) -> Advice | RequestRefused:
        """Return what a robot suggests now; see `Adviser.advise`."""
        stands = self.dialogues.suggestion_stands(robot)
        number = state.robots[robot].advice + (0 if stands else 1)
        return self.adviser.advise(state, self.dialogues.discussed, robot, number)

    def suggest(self, state: GameState, robot: int, advice: Advice, *, unasked: bool = False) -> None:
        """Record an advice, and let the robot open the dialogue about it."""
        room = advice.room
        if self.dialogues.argues:
            chosen = self.dialogues.decision(self._where_facts(state, robot, room))
            if chosen is None:
                sentence = "I know of no room that I should go to, after all that you have told me."
                self.refuse(kind_of(RequestSuggestion), RequestRefused(NoTour.NOTHING_LEFT, sentence))
                return
            room = chosen
        opener = Speaker.ROBOT if unasked else Speaker.PERSON
        opened = self._opening(Scenario.DONT_KNOW, robot, room, opener, advice.room)
        self.record((advice.event(robot), structs.replace(opened, reason=advice.reason, confidence=advice.confidence)))

    def discuss(self, state: GameState, scenario: Scenario, robot: int, room: Room, name: str | None = None) -> None:
        """Open the dialogue about what the participant wants, unless it is open or has led to an agreement.

        Args:
            state: of the game.
            scenario: the decision.
            robot: index in the team.
            room: the room that it is about.
            name: that the treasure is to be given; empty: she asks what it is; None: she does not say.
        """
        if name == "" and self.dialogues.argues:
            scenario = Scenario.UNSURE_NAME
        said = (name or "") if self.dialogues.argues else ""
        if self.dialogues.is_discussed(scenario, robot, room, said):
            return
        advised = None
        if self.dialogues.argues and MATTERS[scenario] == "select-room":
            advice = self.advice(state, robot)
            advised = None if isinstance(advice, RequestRefused) else advice.room
        opened = self._opening(scenario, robot, room, Speaker.PERSON, advised)
        self.record((structs.replace(opened, name=said),))

    def _opening(
        self, scenario: Scenario, robot: int, room: Room, opener: Speaker, advised: Room | None
    ) -> DialogueOpened:
        at = self._tick / TICKS_PER_SECOND
        return DialogueOpened(self.dialogues.next_number, scenario, robot, room, at, opener, advised)

    def _open(self, state: GameState, opened: DialogueOpened, *, restored: bool) -> None:
        scenario, robot, room = Scenario(opened.scenario), opened.robot, opened.room
        facts: WhereFacts | WhatFacts | None = None
        if self.dialogues.argues and MATTERS[scenario] == "select-room":
            rival = room if scenario is Scenario.SPECIFIC_ROOM else None
            facts = self._where_facts(state, robot, opened.advised, rival)
        elif self.dialogues.argues:
            facts = what_facts(state, robot, room, self._kinds, self._tick, opened.name)
            facts = replace(facts, unsure=scenario is Scenario.UNSURE_NAME)
        self.dialogues.open(
            state,
            scenario,
            robot,
            room,
            opened.reason,
            opened.confidence,
            facts=facts,
            opener=Speaker(opened.opener),
            name=opened.name,
            restored=opened.dialogue if restored else None,
        )

    def _where_facts(self, state: GameState, robot: int, advised: Room | None, rival: Room | None = None) -> WhereFacts:
        """Return what a robot that argues knows about where to go, and which room its planner has chosen.

        Args:
            state: of the game.
            robot: index in the team.
            advised: the room that its planner has chosen; None where it has none.
            rival: room that the participant wants it to go to.
        """
        unreached = self._unreached.get(robot, frozenset())
        facts = where_facts(state, self.dialogues.discussed, robot, unreached, self._tick, rival)
        facts = replace(facts, compares=self.adviser.error_rate <= 0.0)
        return facts if advised is None else replace(facts, advised=advised)

    def recall(self, robot: int) -> None:
        """Call a moving robot back; its move ends when SimR reports how far it came, or now if it was never ordered."""
        if self.state is not None and self._ordered[robot] != self._moves[robot]:
            self.apply_ruling("Failed", rules.fail(self.state, robot, CALLED_BACK, 0.0))
        else:
            self._recalled.add(robot)

    def is_recalled(self, robot: int) -> bool:
        """Return True while a robot that was called back has not stopped yet."""
        return robot in self._recalled

    def is_executing(self, robot: int, move: int) -> bool:
        """Return True while a robot executes the move of this number."""
        return (
            self.state is not None
            and self.state.has_robot(robot)
            and self.state.robots[robot].bound_for is not None
            and self._moves[robot] == move
        )

    def orders(self, state: GameState) -> tuple[MoveOrder | None, ...]:
        """Return the order of each robot, and note these as sent."""
        self._ordered = list(self._moves)
        return tuple(
            None
            if robot.bound_for is None or number in self._recalled
            else MoveOrder(self._moves[number], robot.bound_for.people)
            for number, robot in enumerate(state.robots)
        )

    def take_entries(self) -> tuple[JournalEntry, ...]:
        """Return the entries for the journal since the last call, in order."""
        self._gather_utterances()
        entries, self._entries = self._entries, []
        return tuple(entries)

    def take_utterances(self) -> tuple[DialogueUtterance, ...]:
        """Return what was said since the last call, in order."""
        self._gather_utterances()
        utterances, self._utterances = self._utterances, []
        return tuple(utterances)

    def _apply(self, event: JournalEntry, *, restored: bool = False) -> None:
        if isinstance(event, KeyUsed):
            return
        if isinstance(event, DialogueOpened | DialogueSaid):
            if self.state is not None:
                self._talk(self.state, event, restored=restored)
            return
        self._note_end_of_move(event)
        if isinstance(event, GameStarted):
            self.state = game.begin(event)
            self.last_game = event.game
            self.dialogues = GameDialogues(self._engine(event.game), self.dialogues.puppets, self._room_names)
            self._asked_back.clear()
            self.refusal = None
            self._moves, self._ordered = [0] * event.robots, [0] * event.robots
            self._departures = 0
            self._recalled.clear()
            self._unreached.clear()
            self._to_report.clear()
            self._attended = dict.fromkeys(range(event.robots), self._tick)
        elif self.state is not None:
            self.state = game.apply(self.state, event)
        if isinstance(event, RobotDeparted):
            self._departures += 1
            self._moves[event.robot] = self._departures
            self.dialogues.withdraw_consent(event.robot, "select-room")
        if isinstance(event, TreasurePictured):
            self.dialogues.withdraw_consent(event.robot, "take-picture")
        if isinstance(event, HandbackRequested):
            self._asked_back[event.robot] = self._tick
        if isinstance(event, CommanderChanged):
            self._asked_back.pop(event.robot, None)
        if isinstance(event, RobotArrived | MoveFailed):
            self._recalled.discard(event.robot)
        robot = getattr(event, "robot", None)
        if isinstance(robot, int):
            self.attend(robot)

    def _talk(self, state: GameState, entry: DialogueOpened | DialogueSaid, *, restored: bool) -> None:
        if isinstance(entry, DialogueSaid):
            self.dialogues.retake(state, entry)
        else:
            self._open(state, entry, restored=restored)
            self.attend(entry.robot)

    def _note_end_of_move(self, event: JournalEntry) -> None:
        """Note a room that a robot could not reach; after reaching one it thinks about all of them anew."""
        if isinstance(event, RobotArrived):
            self._unreached.pop(event.robot, None)
        elif isinstance(event, MoveFailed) and self.state is not None and not self.is_recalled(event.robot):
            room = self.state.robots[event.robot].bound_for
            if room is not None:
                self._unreached[event.robot] = self._unreached.get(event.robot, frozenset()) | {room}
                self._to_report.add(event.robot)
