"""Requests that are sent twice: two games, one of which gets every request once and the other twice, stay the same."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from tests.support.hunts.hunt_without_simulator import HuntWithoutSimulator
from tests.support.hunts.scripted_hunt import LANGUAGE, RULEBOOK
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.shared.notices import ParticipantReady
from thbridge.roles.shared.participant_lines import encode_request_line
from thbridge.roles.shared.robot_requests import (
    GameRequest,
    ReleaseCommand,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    TakeCommand,
    WizardAdvice,
    WizardMode,
    WizardMove,
)
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    IdentifyTreasure,
    LeaveTreasure,
    MeasureProperty,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    TellProperty,
    View,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import Notice, encode_notice, parse_notice

robots, rooms = st.integers(0, 1), st.integers(1, 8)
names = st.sampled_from(["Pink_can", "Blue_Bottle", "Yellow_can"])
at_once_or_later = st.sampled_from([0, 0, 1, 2, 150])
"""Ticks from a request to its repetition: a double click, or a retry after a stall of 3 s."""
in_a_game = st.one_of(
    st.builds(SelectRoom, robots, rooms),
    st.builds(SelectRoom, robots, rooms),
    st.builds(RequestSuggestion, robots),
    st.builds(RequestSuggestion, robots),
    st.builds(StopRobot, robots),
    st.builds(RequestHandback, robots),
    st.builds(LeaveTreasure, rooms),
    st.builds(TakeUpTreasure, rooms),
    st.builds(MeasureProperty, rooms, st.sampled_from(["weight", "colour"])),
    st.builds(TellProperty, rooms, st.just("shape"), st.sampled_from(["round", "square"])),
)
of_others = st.one_of(
    st.builds(TakeCommand, robots, st.just("ground station 255")),
    st.builds(ReleaseCommand, robots),
    st.builds(StationSend, robots, rooms),
    st.builds(StationStop, robots),
    st.builds(StationIdentify, robots, names),
    st.builds(StationLeave, robots),
    st.builds(WizardMode, robots, st.booleans()),
    st.builds(WizardAdvice, robots, rooms),
)


class Lines:
    """The participant's program: says the lines that it is given, and keeps the view."""

    name = legacy.TABUI

    def __init__(self) -> None:
        self.view: View | None = None
        self.waiting: list[TextMessage] = []

    def connected(self) -> None:
        self.waiting.append(encode_notice(self.name, "Game", ParticipantReady("a run")))

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        for message in messages:
            notice = parse_notice(message)
            if isinstance(notice, Notice) and (view := View.of_notice(notice)) is not None:
                self.view = view
        waiting, self.waiting = self.waiting, []
        return waiting


@dataclass
class Play:
    """One of the two games."""

    condition: DialogueCondition
    patience: int | None
    repeats: bool
    """The robots' program says everything twice, too."""
    lines: Lines = field(default_factory=Lines)

    def __post_init__(self) -> None:
        talk = None
        if self.condition.argues:
            manner = Manner(self.condition, misheard=0.3)
            talk = ArguingEngine(RULEBOOK, {None: manner}, WordedPhrasing(LANGUAGE, self.condition, 7), 7)
        self.hunt = HuntWithoutSimulator(
            participant=self.lines,
            talk=talk,
            adviser=Adviser(error_rate=0.5, says_confidence=True),
            patience=self.patience,
            set_name="four-properties",
        )
        if self.repeats:
            say = self.hunt.puppets.step
            self.hunt.puppets.step = lambda *heard: [line for line in say(*heard) for _ in range(2)]  # type: ignore[method-assign]
        self.hunt.run(10)

    @property
    def outcome(self) -> tuple[object, ...]:
        """All that a game consists of: its journal, its state, what the participant sees, what waits for a wizard."""
        return self.hunt.log.entries, self.hunt.keeper.state, self.lines.view, self.hunt.tick_records[-1].wizard


class RepeatedRequests(RuleBasedStateMachine):
    """Whatever is asked for in a game, asking twice is asking once."""

    @initialize(
        condition=st.sampled_from(DialogueCondition),
        patience=st.sampled_from([None, 400]),
        numbers=st.sampled_from([True, True, False]),
    )
    def begin(self, condition: DialogueCondition, patience: int | None, numbers: bool) -> None:
        # To ask again is to attend to a robot, which then waits longer: without numbers none decides by itself.
        patience = patience if numbers else None
        self.once, self.twice = Play(condition, patience, repeats=False), Play(condition, patience, repeats=True)
        self.number = 0
        self.numbers = numbers
        self.unrepeated: list[TextMessage] = []

    @property
    def view(self) -> View:
        view = self.once.lines.view
        assert view is not None
        return view

    def run(self, ticks: int) -> None:
        self.once.hunt.run(ticks)
        self.twice.hunt.run(ticks)

    def send(self, message: TextMessage, gap: int) -> None:
        self._ask(lambda play: play.lines.waiting.append(message), gap)

    def _ask(self, ask: Callable[[Play], None], gap: int) -> None:
        ask(self.once)
        ask(self.twice)
        self.run(gap)
        ask(self.twice)
        self.run(3)

    def ask(self, request: ParticipantRequest, gap: int, *, is_late: bool) -> None:
        """Send a request; late: its repetition comes after other requests, and is known by its number alone."""
        if not self.numbers:
            self.ask_without_number(request, gap)
            return
        self.number += 1
        message = encode_request_line(request, self.number)
        if is_late:
            self.once.lines.waiting.append(message)
            self.twice.lines.waiting.append(message)
            self.unrepeated.append(message)
            self.run(3)
        else:
            self.send(message, gap)

    def send_line(self, request: ParticipantRequest, gap: int) -> None:
        """Send a line of 2016; it has no number, so one that was refused is a new request when it comes again."""
        line, refused = encode_request_line(request), self.view.refusal
        self.once.lines.waiting.append(line)
        self.twice.lines.waiting.append(line)
        self.run(3)
        if self.view.refusal == refused:
            self.run(gap)
            self.twice.lines.waiting.append(line)
            self.run(3)

    def ask_without_number(self, request: ParticipantRequest, gap: int) -> None:
        """Send a request as an older window does; what the view shows as granted is repeated."""
        message, refused = encode_request_line(request), self.view.refusal
        self.once.lines.waiting.append(message)
        self.twice.lines.waiting.append(message)
        self.run(3)
        opens = isinstance(request, SelectRoom | RequestSuggestion | OpenDialogue)
        talks = {about.robot for about in (*self.view.dialogues, *self.view.consents)}
        # A game that is over refuses to be ended; that has no other effect.
        ends = isinstance(request, EndGame)
        if (
            self.view.refusal == refused
            and not ends
            and not (opens and request.robot not in talks | set(self.view.thinking))
        ):
            self.run(gap)
            self.twice.lines.waiting.append(message)
            self.run(3)

    @rule(request=in_a_game, gap=at_once_or_later, is_late=st.booleans())
    def asks(self, request: ParticipantRequest, gap: int, is_late: bool) -> None:
        self.ask(request, gap, is_late=is_late)

    @precondition(lambda self: self.view.dialogues)
    @rule(data=st.data(), gap=at_once_or_later, is_late=st.booleans())
    def answers(self, data: st.DataObject, gap: int, is_late: bool) -> None:
        talk = data.draw(st.sampled_from(self.view.dialogues))
        choice = data.draw(st.integers(0, max(len(talk.choices) - 1, 0)))
        self.ask(AnswerDialogue(talk.dialogue, talk.turn, choice), gap, is_late=is_late)

    @precondition(lambda self: any(room.undecided for room in self.view.rooms))
    @rule(
        data=st.data(), matter=st.sampled_from(["take-picture", "take-treasure"]), name=names | st.none() | st.just("")
    )
    def opens(self, data: st.DataObject, matter: str, name: str | None) -> None:
        room = data.draw(st.sampled_from([room for room in self.view.rooms if room.undecided]))
        request = OpenDialogue(room.robot or 0, matter, room.room, name)  # type: ignore[arg-type]
        self.ask(request, data.draw(at_once_or_later), is_late=data.draw(st.booleans()))

    @rule(
        robot=robots,
        room=rooms | st.none(),
        choices=st.lists(st.integers(0, 3), min_size=2, max_size=5),
        gap=at_once_or_later,
        is_late=st.booleans(),
    )
    def talks_and_goes(self, robot: int, room: int | None, choices: list[int], gap: int, is_late: bool) -> None:
        """Talk with a robot about where to go, mostly until it goes."""
        about = RequestSuggestion(robot) if room is None else SelectRoom(robot, room)
        self.ask(about, gap, is_late=is_late)
        for choice in choices:
            talk = next((each for each in self.view.dialogues if each.robot == robot and each.choices), None)
            if talk is not None:
                answer = AnswerDialogue(talk.dialogue, talk.turn, choice % len(talk.choices) if choice > 1 else 0)
                self.ask(answer, gap, is_late=is_late)
        self.does_what_was_agreed(gap)
        self.run(15)
        self.does_what_was_agreed(gap)

    @rule(gap=at_once_or_later)
    def does_what_was_agreed(self, gap: int) -> None:
        for consent in self.view.consents:
            match consent.matter:
                case _ if consent not in self.view.consents:
                    continue
                case "select-room":
                    self.send_line(SendRobot(consent.robot, consent.room), gap)
                case "take-picture":
                    self.send_line(TakePicture(consent.room), gap)
                case "take-treasure":
                    name = consent.name or "Pink_can"
                    self.send_line(IdentifyTreasure(consent.room, name), gap)
        for room in self.view.rooms:
            if room.undecided and not room.found and room.robot is not None:
                self.send_line(SenseTreasure(room.room), gap)

    @rule(request=of_others, gap=at_once_or_later)
    def others_ask(self, request: GameRequest, gap: int) -> None:
        self._ask(lambda play: play.hunt.session.ask("somebody", request), gap)

    @precondition(lambda self: self.once.hunt.tick_records[-1].wizard.turns)
    @rule(move=st.integers(0, 2), gap=at_once_or_later)
    def a_wizard_speaks(self, move: int, gap: int) -> None:
        held = self.once.hunt.tick_records[-1].wizard.turns[0]
        request = WizardMove(held.dialogue, held.turn, move % len(held.sentences))
        self._ask(lambda play: play.hunt.session.ask("somebody", request), gap)

    @rule(again=st.booleans(), gap=at_once_or_later)
    def ends_the_game_or_begins_another(self, again: bool, gap: int) -> None:
        if (self.view.over is not None) == again and (again or len(self.once.hunt.log.entries) > 40):
            request = PlayAgain(self.view.game) if again else EndGame(self.view.game)
            self.ask(request, gap, is_late=not again)

    @rule(ticks=st.sampled_from([1, 5, 12, 50]))
    def time_passes(self, ticks: int) -> None:
        self.run(ticks)

    @precondition(lambda self: self.unrepeated)
    @rule()
    def retries_arrive(self) -> None:
        self.twice.lines.waiting += self.unrepeated
        self.unrepeated.clear()
        self.run(3)

    @invariant()
    def the_games_are_the_same(self) -> None:
        once, twice = self.once.outcome, self.twice.outcome
        assert once == twice


TestRepeatedRequests = RepeatedRequests.TestCase
TestRepeatedRequests.settings = settings(max_examples=settings().max_examples // 3, stateful_step_count=25)
