"""Several participants in one game: rights of their seats, hand-over, votes, texts, and what each of them sees."""

import math
import re

import pytest
from msgspec import structs

from sim.common.observations import TICKS_PER_SECOND
from tests.support.hunts.scripted_hunt import arguing_engine
from tests.support.hunts.seated_hunt import SeatedHunt
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import (
    DecisionKind,
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    EndReason,
    GameEnded,
    PersonRead,
    PersonSaid,
    RobotDeparted,
    SeatLeft,
    SeatTaken,
    TreasureLeft,
    TreasureSensed,
    VoteCast,
)
from thbridge.hunt.seats import DialogueSight, Seat, StopRight
from thbridge.roles.keeper.team.decisions import AgreementRule, VotingRules
from thbridge.roles.keeper.team.game_team import EMPTY_AFTER, TeamRules
from thbridge.roles.keeper.team.people_talk import BURST, TalkRules
from thbridge.roles.shared.notices import FloorPlan
from thbridge.roles.shared.team_notices import LONGEST_TEXT, MarkRead, SayToPeople, Vote
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    HandOver,
    IdentifyTreasure,
    LeaveTreasure,
    RequestHandback,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
)

DRIVER = Seat("driver", "the driver", robots=(0,), names_treasures=False, ends_game=False)
NAMER = Seat("namer", "the namer", robots=(1,), stops=StopRight.ALL)
JUDGE = Seat("judge", "the judge", takes_over=False, talks=False, ends_game=False)
SEATS = (DRIVER, NAMER, JUDGE)
OPEN_TALK = TalkRules(0.0, math.inf)


def voting(rule: AgreementRule, timeout: float = 60.0) -> TeamRules:
    """Return rules by which this number of people must agree to each move."""
    return TeamRules(
        OPEN_TALK, VotingRules({**dict.fromkeys(DecisionKind, AgreementRule.ONE), DecisionKind.SEND: rule}, timeout)
    )


class TestRights:
    @pytest.mark.parametrize(
        "request_", [SenseTreasure(-1), TakePicture(-1), SendRobot(0, -1), IdentifyTreasure(-1, "moon")]
    )
    def test_a_room_that_no_map_has_is_refused(self, request_):
        hunt = SeatedHunt((DRIVER, NAMER))
        before = hunt.game
        hunt.ask("namer", request_)
        assert hunt.game == before

    @pytest.mark.parametrize(
        ("seat", "request_", "sentence"),
        [
            ("driver", SelectRoom(1, 1), "Robot 2 is commanded by the namer just now."),
            ("driver", StopRobot(1), "Robot 2 is commanded by the namer just now."),
            ("driver", HandOver(1, "driver"), "Robot 2 is commanded by the namer just now."),
            ("driver", LeaveTreasure(1), "Only the namer or the judge can decide about treasures."),
            ("driver", EndGame(1), "Only the namer can end the game early."),
            ("judge", SelectRoom(0, 1), "Robot 1 is commanded by the driver just now."),
            ("driver", HandOver(0, "judge"), "The judge cannot take over robots."),
            ("driver", HandOver(0, "cook"), "There is no such seat in this game."),
        ],
    )
    def test_a_refusal_names_the_seat_that_could_do_it(self, seat, request_, sentence):
        hunt = SeatedHunt(SEATS)
        before = hunt.game
        view = hunt.ask(seat, request_)
        assert view.refusal is not None
        assert (view.refusal.sentence, hunt.game) == (sentence, before)
        assert all(hunt.view(other.name).refusal is None for other in SEATS if other.name != seat)

    def test_only_the_commander_of_the_robot_in_a_room_uses_it(self):
        hunt = SeatedHunt(SEATS)
        hunt.send("driver", 0, 4, ticks=30)
        for request in (SenseTreasure(4), TakePicture(4)):
            assert hunt.ask("namer", request).refusal.sentence == "Robot 1 is commanded by the driver just now."
        hunt.ask("driver", SenseTreasure(4))
        assert [event.seat for event in hunt.events(TreasureSensed)] == ["driver"]
        hunt.ask("judge", LeaveTreasure(4))
        assert [event.seat for event in hunt.events(TreasureLeft)] == ["judge"]

    def test_who_may_stop_all_robots_stops_those_of_others(self):
        hunt = SeatedHunt(SEATS)
        hunt.send("driver", 0, 4)
        assert hunt.game.robots[0].bound_for is not None
        hunt.ask("namer", StopRobot(0), ticks=10)
        assert hunt.game.robots[0].bound_for is None
        assert [(each.robot, each.seat) for each in hunt.entries if type(each).__name__ == "MoveFailed"] == [
            (0, "namer")
        ]


class TestHandOver:
    def test_a_robot_goes_to_the_seat_that_asked_for_it(self):
        hunt = SeatedHunt(SEATS)
        hunt.ask("namer", RequestHandback(0))
        assert hunt.view("driver").team.asked_for == ((0, "namer"),)
        hunt.ask("driver", HandOver(0, "namer"))
        assert hunt.view("driver").team.asked_for == ()
        assert hunt.view("driver").robots[0].commander_name == "the namer"
        hunt.send("namer", 0, 4)
        assert [(each.robot, each.seat) for each in hunt.events(RobotDeparted)] == [(0, "namer")]

    def test_after_a_restart_of_the_keeper_the_new_commander_still_commands(self):
        hunt = SeatedHunt(SEATS)
        hunt.ask("driver", HandOver(0, "namer"))
        again = SeatedHunt(SEATS, history=hunt.entries)
        assert again.game.robots[0].seat == "namer"
        again.send("namer", 0, 4)
        assert [(each.robot, each.seat) for each in again.events(RobotDeparted)] == [(0, "namer")]


class TestVotes:
    @pytest.mark.parametrize(
        ("rule", "needed"),
        [(AgreementRule.ONE, 1), (AgreementRule.TWO, 2), (AgreementRule.MAJORITY, 2), (AgreementRule.ALL, 3)],
    )
    def test_a_robot_drives_when_enough_people_agree(self, rule, needed):
        hunt = SeatedHunt(SEATS, voting(rule))
        hunt.send("driver", 0, 4)
        for agreed, seat in enumerate(("namer", "judge"), 1):
            assert bool(hunt.events(RobotDeparted)) == (agreed >= needed)
            hunt.ask(seat, Vote(1, agrees=True, reason=f"I am {seat}."))
        assert [(each.robot, each.seat) for each in hunt.events(RobotDeparted)] == [(0, "driver")]
        votes = hunt.events(VoteCast)
        assert [(each.seat, each.reason) for each in votes] == [
            (seat, f"I am {seat}.") for seat in ("namer", "judge")[: needed - 1]
        ]
        assert [each.outcome for each in hunt.events(DecisionSettled)] == [DecisionOutcome.CARRIED] * (needed > 1)

    def test_a_vote_is_rejected_as_soon_as_it_cannot_succeed(self):
        hunt = SeatedHunt(SEATS, voting(AgreementRule.ALL))
        hunt.send("driver", 0, 4)
        hunt.ask("judge", Vote(1, agrees=False, reason="It is too far."))
        assert [each.outcome for each in hunt.events(DecisionSettled)] == [DecisionOutcome.REJECTED]
        assert hunt.view("driver").refusal.sentence == "The team has not agreed to this."
        assert hunt.events(RobotDeparted) == []

    def test_a_vote_that_ends_without_an_answer_expires_and_can_be_proposed_again(self):
        hunt = SeatedHunt(SEATS, voting(AgreementRule.ALL, timeout=1.0))
        hunt.send("driver", 0, 4)
        hunt.run(60)
        (proposed,), (settled,) = hunt.events(DecisionProposed), hunt.events(DecisionSettled)
        assert settled.outcome is DecisionOutcome.EXPIRED
        assert settled.at - proposed.at == pytest.approx(1.0, abs=0.05)
        hunt.send("driver", 0, 4)
        assert [each.decision for each in hunt.events(DecisionProposed)] == [1, 2]

    def test_people_who_leave_do_not_block_a_vote(self):
        hunt = SeatedHunt(SEATS, voting(AgreementRule.ALL))
        hunt.send("driver", 0, 4)
        hunt.ask("namer", Vote(1, agrees=True))
        hunt.leave("judge")
        hunt.run(3)
        assert [each.outcome for each in hunt.events(DecisionSettled)] == [DecisionOutcome.CARRIED]
        assert [each.seat for each in hunt.events(SeatLeft)] == ["judge"]
        hunt.join("judge")
        hunt.run(3)
        assert [each.seat for each in hunt.events(SeatTaken)] == ["driver", "namer", "judge", "judge"]

    def test_another_program_in_a_seat_is_recorded_even_if_the_seat_was_never_empty(self):
        hunt = SeatedHunt(SEATS)
        hunt.run(3)
        for run in ("first", "first", "second"):
            hunt.join("judge", run)
            hunt.run(3)
        changes = [type(each) for each in hunt.events(SeatTaken, SeatLeft) if each.seat == "judge"]
        assert changes == [SeatTaken, SeatLeft, SeatTaken, SeatLeft, SeatTaken]

    def test_the_same_proposal_of_another_person_is_a_vote_for_it(self):
        kinds = {**dict.fromkeys(DecisionKind, AgreementRule.ONE), DecisionKind.END: AgreementRule.ALL}
        seats = (structs.replace(NAMER, robots=(0, 1)), structs.replace(JUDGE, ends_game=True))
        hunt = SeatedHunt(seats, TeamRules(OPEN_TALK, VotingRules(kinds, 60.0)))
        hunt.ask("namer", EndGame(1))
        assert hunt.game.ended is None
        hunt.ask("judge", EndGame(1))
        assert len(hunt.events(DecisionProposed)) == 1
        assert [each.seat for each in hunt.events(GameEnded)] == ["namer"]

    def test_a_decision_that_became_impossible_is_void(self):
        hunt = SeatedHunt(SEATS, voting(AgreementRule.TWO))
        hunt.send("driver", 0, 4)
        hunt.ask("driver", HandOver(0, "namer"))
        assert [each.outcome for each in hunt.events(DecisionSettled)] == [DecisionOutcome.VOID]
        assert hunt.view("judge").team.decisions == ()


class TestEmptySeats:
    SEATS = (DRIVER, structs.replace(NAMER, ends_game=False))

    @pytest.mark.parametrize(("left", "other"), [("driver", "namer"), ("namer", "driver")])
    def test_the_end_does_not_wait_for_an_empty_seat(self, left, other):
        hunt = SeatedHunt(self.SEATS, voting(AgreementRule.ALL), energy=25.0)
        hunt.leave(left)
        while hunt.game.ended is None and hunt.seconds < 1000.0:
            hunt.play(other)
        assert {each.seat for each in hunt.events(RobotDeparted)} == {other}
        assert hunt.game.ended.reason is EndReason.NO_MOVE_LEFT
        assert hunt.seconds > EMPTY_AFTER

    def test_a_game_waits_while_all_people_are_away(self):
        hunt = SeatedHunt(self.SEATS, energy=25.0)
        for seat in ("driver", "namer"):
            hunt.leave(seat)
        hunt.run(round((EMPTY_AFTER + 10.0) * TICKS_PER_SECOND))
        assert hunt.game.ended is None


class TestTexts:
    def test_a_text_reaches_only_its_addressees(self):
        hunt = SeatedHunt(SEATS, TeamRules(OPEN_TALK))
        hunt.ask("driver", SayToPeople("Hello, all!", typing=0.1))
        hunt.ask("driver", SayToPeople("Only you.", "judge"))
        assert [line.text for line in hunt.texts("namer")] == ["Hello, all!"]
        for seat in ("driver", "judge"):
            assert [line.text for line in hunt.texts(seat)] == ["Hello, all!", "Only you."]
        first, second = hunt.events(PersonSaid)
        assert (first.seat, first.to, first.typing, second.to) == ("driver", "", 0.1, "judge")

    def test_a_program_that_joins_again_gets_all_texts_again(self):
        hunt = SeatedHunt(SEATS, TeamRules(OPEN_TALK))
        hunt.ask("driver", SayToPeople("One."))
        hunt.leave("namer")
        hunt.ask("driver", SayToPeople("Two."))
        hunt.shown["namer"].clear()
        hunt.join("namer")
        hunt.run(3)
        assert [line.text for line in hunt.texts("namer")] == ["One.", "Two."]

    def test_what_was_read_is_recorded_once(self):
        hunt = SeatedHunt(SEATS, TeamRules(OPEN_TALK))
        hunt.ask("driver", SayToPeople("Hello!"))
        hunt.ask("judge", MarkRead(1))
        hunt.ask("judge", MarkRead(1), MarkRead(5), MarkRead(-1))
        assert [(each.line, each.seat) for each in hunt.events(PersonRead)] == [(1, "judge")]

    @pytest.mark.parametrize(
        ("request_", "reason"),
        [
            (SayToPeople(" \n"), "too-long"),
            (SayToPeople("x" * (LONGEST_TEXT + 1)), "too-long"),
            (SayToPeople("Hello!", "cook"), "not-ready"),
            (SayToPeople("Hello!", "driver"), "not-ready"),
        ],
    )
    def test_texts_have_bounds_and_addressees(self, request_, reason):
        hunt = SeatedHunt(SEATS, TeamRules(OPEN_TALK))
        assert hunt.ask("driver", request_).refusal.reason == reason
        assert hunt.events(PersonSaid) == []

    def test_a_person_cannot_flood_the_others(self):
        hunt = SeatedHunt(SEATS, TeamRules(OPEN_TALK))
        view = hunt.ask("driver", *(SayToPeople(f"Text {number}") for number in range(BURST + 3)))
        assert view.refusal.reason == "too-many"
        assert len(hunt.events(PersonSaid)) == BURST
        hunt.ask("judge", SayToPeople("I may."))
        assert len(hunt.events(PersonSaid)) == BURST + 1

    def test_a_study_opens_and_closes_the_talk(self):
        hunt = SeatedHunt(SEATS, TeamRules(TalkRules(1.0, 2.0)))
        for text in ("early", "in time", "late"):
            hunt.ask("driver", SayToPeople(text), ticks=50)
        assert [each.text for each in hunt.events(PersonSaid)] == ["in time"]
        assert hunt.view("driver").refusal.reason == "talk-is-off"


class TestSight:
    def test_a_seat_sees_only_what_it_may_see(self):
        blind = Seat("blind", "the blind", sees_energy=False, sees_map=False, sees_score=False)
        own = Seat("own", "the other", robots=(1,), sees_dialogues=DialogueSight.OWN)
        hunt = SeatedHunt((DRIVER, blind, own))
        hunt.ask("driver", SelectRoom(0, 4))
        assert [len(hunt.view(seat).dialogues) for seat in ("driver", "blind", "own")] == [1, 1, 0]
        assert hunt.view("blind").dialogues[0].choices == ()
        hunt.send("driver", 0, 4, ticks=30)
        view = hunt.view("blind")
        assert {robot.energy for robot in view.robots} == {1.0}
        assert {cost for row in view.costs for cost in row} == {None, 0.0}
        assert (view.picture_cost, view.identify_cost, view.worth) == (0.0, 0.0, ())
        assert not any(isinstance(each, FloorPlan) for each in hunt.shown["blind"])
        assert any(isinstance(each, FloorPlan) for each in hunt.shown["own"])
        assert hunt.view("own").robots[0].energy < 100.0

    def test_sentences_of_robots_name_no_energy_to_a_seat_that_does_not_see_it(self):
        blind = Seat("blind", "the blind", robots=(1,), sees_energy=False)
        hunt = SeatedHunt((DRIVER, blind), talk=arguing_engine(DialogueCondition.COLLABORATOR))
        shown: dict[str, set[str]] = {"driver": set(), "blind": set()}
        for room in (8, 4, 2):
            hunt.ask("blind", SelectRoom(1, room))
            while own := hunt.view("blind").dialogues:
                for seat, sentences in shown.items():
                    for each in hunt.view(seat).dialogues:
                        sentences |= {*each.said, *each.choices}
                why = next((at for at, text in enumerate(own[0].choices) if text.startswith("Why")), 0)
                hunt.ask("blind", AnswerDialogue(own[0].dialogue, own[0].turn, why))
            for seat, sentences in shown.items():
                sentences |= {text for each in hunt.view(seat).last_words for text in each.said}
        assert any(re.search(r"\d energy", each) for each in shown["driver"])
        assert any("we reach" in each for each in shown["blind"])
        assert not [each for each in shown["blind"] if re.search(r"\d energy|\d\.\d|…", each)]
