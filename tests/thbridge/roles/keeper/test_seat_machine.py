"""Any mix of seats, requests, leaving, coming back and hand-overs: what always holds in a game of several people."""

import math
from collections import Counter

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from msgspec import UNSET

from tests.support.hunts.seated_hunt import SeatedHunt
from thbridge.hunt.events import (
    DecisionKind,
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    GameEnded,
    ObjectionRaised,
    ObjectionReason,
    PersonSaid,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
)
from thbridge.hunt.seats import DialogueSight, Seat, StopRight
from thbridge.roles.keeper.team.decisions import AgreementRule, VotingRules
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.keeper.team.people_talk import TalkRules
from thbridge.roles.shared.notices import FloorPlan
from thbridge.roles.shared.team_notices import MarkRead, RaiseObjection, SayToPeople, TeamTalk, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    OpenDialogue,
    RequestHandback,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    View,
    objections_of,
)

NAMES = ("ann", "bob", "cem", "dan")
ROBOTS = 3
ENERGY = 60.0
LAST_PLAYS = 400
"""After this number of turns of simulated participants, a game counts as endless."""

robots = st.integers(-1, ROBOTS)
rooms = st.integers(-1, 9)
people = st.integers(0, len(NAMES) - 1)
REQUESTS = st.one_of(
    st.builds(SelectRoom, robots, rooms),
    st.builds(RequestSuggestion, robots),
    st.builds(AnswerDialogue, st.integers(1, 6), st.integers(0, 4), st.integers(0, 3)),
    st.builds(SendRobot, robots, rooms),
    st.builds(StopRobot, robots),
    st.builds(RequestHandback, robots),
    st.builds(HandOver, robots, st.sampled_from((*NAMES, "", "nobody"))),
    st.builds(SenseTreasure, rooms),
    st.builds(OpenDialogue, robots, st.sampled_from(("take-picture", "take-treasure")), rooms),
    st.builds(TakePicture, rooms),
    st.builds(IdentifyTreasure, rooms, st.sampled_from(("Pink can", "Orange Bottle", "rubbish"))),
    st.builds(LeaveTreasure, rooms),
    st.builds(TakeUpTreasure, rooms),
    st.builds(EndGame, st.just(1)),
    st.builds(Vote, st.integers(0, 9), st.booleans(), st.sampled_from(("", "It is far."))),
    st.builds(SayToPeople, st.text(max_size=8), st.sampled_from((*NAMES, "")), st.floats(-1.0, 1e9)),
    st.builds(MarkRead, st.integers(-1, 9)),
    st.builds(RaiseObjection, st.integers(1, 6), st.sampled_from(ObjectionReason), st.sampled_from(("", "No."))),
)


@st.composite
def drawn_seats(draw: st.DrawFn) -> tuple[Seat, ...]:
    """Draw the seats of a valid study: each robot has a commander, and a seat may name, end the game, and talk."""
    names = NAMES[: draw(st.integers(2, len(NAMES)))]
    commanders = [draw(st.sampled_from(names)) for _ in range(ROBOTS)]
    seats = []
    for name in names:
        own = tuple(robot for robot, commander in enumerate(commanders) if commander == name)
        is_first = name == names[0]
        seats.append(
            Seat(
                name,
                f"the {name}",
                own,
                takes_over=draw(st.booleans()),
                names_treasures=is_first or draw(st.booleans()),
                stops=draw(st.sampled_from(StopRight)),
                talks=is_first or bool(own) or draw(st.booleans()),
                ends_game=is_first or draw(st.booleans()),
                sees_dialogues=draw(st.sampled_from(DialogueSight)),
                sees_energy=draw(st.booleans()),
                sees_map=draw(st.booleans()),
                sees_score=draw(st.booleans()),
                objects=draw(st.sampled_from((True, UNSET))),
            )
        )
    return tuple(seats)


class Seats(RuleBasedStateMachine):
    """Participants who do anything, whether they may or not."""

    @initialize(
        seats=drawn_seats(),
        rules=st.tuples(*3 * [st.sampled_from(AgreementRule)]),
        timeout=st.sampled_from((1.0, 30.0)),
    )
    def begin(self, seats: tuple[Seat, ...], rules: tuple[AgreementRule, ...], timeout: float) -> None:
        self.seats = seats
        voting = VotingRules(dict(zip(DecisionKind, rules, strict=True)), timeout)
        self.hunt = SeatedHunt(seats, TeamRules(TalkRules(0.0, math.inf), voting), ROBOTS, ENERGY)
        self.most = [ENERGY] * ROBOTS
        self.checked = 0
        self.commanders = [each.seat for each in self.hunt.game.robots]

    def seat(self, number: int) -> str:
        return self.seats[number % len(self.seats)].name

    @rule(number=people, request=REQUESTS)
    def ask(self, number, request):
        if self.seat(number) in self.hunt.present:
            self.hunt.ask(self.seat(number), request, ticks=1)

    @rule(first=people, second=people, request=REQUESTS)
    def ask_at_once(self, first, second, request):
        """Let two participants send the same request in the same tick."""
        asking = {self.seat(first), self.seat(second)} & self.hunt.present
        for seat in sorted(asking):
            self.hunt.ask(seat, request, ticks=0)
        self.hunt.run(1)

    @rule(number=people)
    def play(self, number):
        if self.seat(number) in self.hunt.present:
            self.hunt.play(self.seat(number))

    @rule(number=people)
    def leave(self, number):
        if self.seat(number) in self.hunt.present:
            self.hunt.leave(self.seat(number))
            self.hunt.run(1)

    @precondition(lambda self: len(self.hunt.present) < len(self.seats))
    @rule(number=people)
    def come_back(self, number):
        self.hunt.join(self.seat(number))
        self.hunt.run(1)

    @rule(ticks=st.integers(1, 30))
    def wait(self, ticks):
        self.hunt.run(ticks)

    @invariant()
    def energy_is_never_created(self):
        """A refund never exceeds what was paid for the present move."""
        for robot, state in enumerate(self.hunt.game.robots):
            now = state.energy + state.paid
            assert now <= self.most[robot] + 1e-9
            self.most[robot] = now

    @invariant()
    def a_room_is_visited_and_named_once(self):
        for kind in (RobotArrived, TreasureIdentified):
            assert max(Counter(each.room for each in self.hunt.events(kind)).values(), default=0) <= 1

    @invariant()
    def one_decision_has_one_author_who_had_the_right(self):
        seats = {seat.name: seat for seat in self.seats}
        for entry in self.hunt.entries[self.checked :]:
            match entry:
                case RobotDeparted(robot=robot, seat=seat):
                    assert seat == self.commanders[robot]
                case TreasureIdentified(seat=seat):
                    assert seats[seat].names_treasures
                case GameEnded(reason="given-up", seat=seat):
                    assert seats[seat].ends_game
            if type(entry).__name__ == "CommanderChanged":
                assert entry.seat == self.commanders[entry.robot]
                self.commanders[entry.robot] = entry.name
        self.checked = len(self.hunt.entries)
        accepted = [each for each in self.hunt.events(DecisionSettled) if each.outcome is DecisionOutcome.CARRIED]
        proposed = {each.decision: each for each in self.hunt.events(DecisionProposed)}
        assert len({each.decision for each in accepted}) == len(accepted)
        moves = Counter((each.robot, each.room, each.seat) for each in self.hunt.events(RobotDeparted))
        sends = [proposed[each.decision] for each in accepted if proposed[each.decision].kind is DecisionKind.SEND]
        assert all(moves[each.robot, each.room, each.seat] for each in sends)

    @invariant()
    def a_seat_with_the_right_objects_once_in_a_dialogue(self):
        rights = {seat.name: seat.may_object for seat in self.seats}
        objections = self.hunt.events(ObjectionRaised)
        assert all(rights[each.seat] for each in objections)
        assert max(Counter((each.seat, each.dialogue) for each in objections).values(), default=0) <= 1

    @invariant()
    def no_seat_sees_what_it_may_not_see(self):
        to = {each.line: (each.seat, each.to) for each in self.hunt.events(PersonSaid)}
        for seat in self.seats:
            shown, self.hunt.shown[seat.name] = self.hunt.shown[seat.name], []
            views = [each for each in shown if isinstance(each, View)]
            self.hunt.shown[seat.name] += views[-1:]
            assert seat.sees_map or not any(isinstance(each, FloorPlan) for each in shown)
            for view in views:
                check_view(view, seat)
            for talk in (each for each in shown if isinstance(each, TeamTalk)):
                assert all({"", seat.name} & {*to[line.line]} for line in talk.lines)

    def teardown(self) -> None:
        """Let simulated participants play on: the game ends."""
        if not hasattr(self, "hunt"):
            return
        for seat in self.seats:
            self.hunt.join(seat.name)
        self.hunt.run(2)
        for _ in range(LAST_PLAYS):
            if self.hunt.game.ended is not None:
                break
            for seat in self.seats:
                self.hunt.play(seat.name)
            self.energy_is_never_created()
        assert self.hunt.game.ended is not None
        self.a_room_is_visited_and_named_once()
        self.one_decision_has_one_author_who_had_the_right()
        self.no_seat_sees_what_it_may_not_see()


def check_view(view: View, seat: Seat) -> None:
    """Check that a view has only what a seat may see."""
    assert view.team is not None
    assert view.team.own == seat
    own = {robot.robot for robot in view.robots if not robot.has_other_commander}
    if not seat.sees_energy:
        costs = [cost for row in (*view.costs, *(robot.costs for robot in view.robots)) for cost in row]
        assert {*costs} <= {None, 0.0}
        assert {robot.energy for robot in view.robots} <= {0.0, 1.0}
        assert (view.picture_cost, view.identify_cost) == (0.0, 0.0)
    if not seat.sees_score:
        assert (view.score, view.worth, view.wrong_share) == (0, (), None)
        assert {room.verdict.points for room in view.rooms if room.verdict is not None} <= {0}
        assert view.debrief is None or (view.debrief.rooms, view.debrief.best) == ((), None)
    for talk in (*view.dialogues, *view.last_words):
        is_mine = seat.names_treasures if talk.matter == "take-treasure" else talk.robot in own
        assert is_mine or seat.sees_dialogues is DialogueSight.ALL
        assert is_mine or not getattr(talk, "choices", ())
    assert {each.dialogue for each in objections_of(view)} <= {
        talk.dialogue for talk in (*view.dialogues, *view.last_words)
    }


TestSeats = Seats.TestCase
TestSeats.settings = settings(max_examples=4, stateful_step_count=20)


@pytest.mark.slow
class TestManySeats(Seats.TestCase):
    settings = settings(max_examples=300, stateful_step_count=50)
