"""The worked example of Sklar and Azhar (2015): locutions, commitment stores and beliefs after every move."""

import pytest

from thbridge.dialogue.argumentation.cases import DialogueKind, Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.dialogue.examples import (
    BLUE_BOTTLE,
    BLUE_BOTTLE_SEEN,
    BOTTLE_IN_2,
    BOTTLE_IN_5,
    Exchange,
    cost,
    jhri2015,
    less,
    level,
    order,
)
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import Unknown
from thbridge.dialogue.games.control import Conversation, IllegalMoveError
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.dialogue.propositions import ColourFound, Selected, VisitOrder
from thbridge.files.game_files import read_rulebook
from thbridge.hunt.rooms import Room

ROBOT, HUMAN = Side.ROBOT, Side.HUMAN
ROOM_1, ROOM_3 = Literal(Selected(Room(1))), Literal(Selected(Room(3)))


class Table:
    """A conversation at a table: each side's moves are given as text, and must be among the legal ones."""

    def __init__(self, exchange: Exchange) -> None:
        self.now: Conversation = exchange.start

    @property
    def robot(self) -> Agent:
        return self.now.agents[ROBOT]

    @property
    def human(self) -> Agent:
        return self.now.agents[HUMAN]

    def legal(self, number: int = 1) -> set[str]:
        return {str(move) for move in self.now.legal(number)}

    def open(self, side: Side, about: Proposition, parent: int | None = None) -> str:
        (opening,) = self.now.openings(side, about, parent)
        before = len(self.now.plays)
        self.now = self.now.open(side, opening, parent=parent)
        assert len(self.now.plays) == before + 1
        assert self.now.agents[side].store[-1] == opening.move
        return str(opening.move)

    def say(self, side: Side, text: str, number: int = 1) -> None:
        """Make a move, and look at what every move must do: the speaker's store grows by it and nobody else's does."""
        play = self.now.play(number)
        assert play.speaker is side
        move = next(move for move in self.now.legal(number) if str(move) == text)
        before = self.now.agents
        self.now = self.now.say(number, move)
        booked = [said.move for said in self.now.record if said.dialogue == number and said.is_booked]
        assert self.now.agents[side].store == (*before[side].store, move, *booked)
        other = HUMAN if side is ROBOT else ROBOT
        assert self.now.agents[other].store == before[other].store

    def end(self, number: int = 1) -> DialogueEnd | None:
        return self.now.play(number).end


@pytest.fixture(name="exchanges", scope="module")
def fixture_exchanges() -> tuple[Exchange, ...]:
    return jhri2015(read_rulebook())


def test_exchange_1_room_1_is_agreed_upon_and_room_3_is_a_persuasion_with_three_answers(
    exchanges: tuple[Exchange, ...],
) -> None:
    table = Table(exchanges[0])
    assert table.now.case(Selected(Room(1))).number == 1
    assert table.now.case(Selected(Room(1))).kind is DialogueKind.AGREEMENT
    assert table.now.openings(ROBOT, Selected(Room(1))) == table.now.openings(HUMAN, Selected(Room(1))) == ()
    assert table.now.case(Selected(Room(3))).number == 4
    assert table.open(ROBOT, Selected(Room(3))) == "assert(selected(Room3))"
    assert table.legal() == {"accept(selected(Room3))", "challenge(selected(Room3))", "assert(not selected(Room3))"}


def test_exchange_2_a_challenge_gets_its_support_and_the_last_acceptance_is_agreement(
    exchanges: tuple[Exchange, ...],
) -> None:
    table = Table(exchanges[1])
    table.open(ROBOT, Selected(Room(3)))
    assert ~ROOM_3 in table.robot.picture
    beliefs = table.robot.beliefs
    table.say(HUMAN, "challenge(selected(Room3))")
    supports = ("current_energy_level(1000)", "energy_cost(Room4, Room3, 250)", "less_than(250, 1000)")
    table.say(ROBOT, f"assert({{{', '.join(supports)}}}, selected(Room3))")
    for at, support in enumerate(supports):
        table.say(ROBOT, f"assert({support})")
        assert table.legal() == {f"accept({support})", "reject(selected(Room3))"}
        assert ROOM_3 not in table.robot.picture
        table.say(HUMAN, f"accept({support})")
        assert {str(each) for each in table.robot.picture.held} >= set(supports[: at + 1])
    assert table.end() is DialogueEnd.AGREEMENT
    assert ROOM_3 in table.robot.picture and ~ROOM_3 not in table.robot.picture
    assert str(table.human.store[-1]) == "accept(selected(Room3))"
    assert table.robot.beliefs == beliefs
    # What she was persuaded of she does not deny any more.
    assert table.now.case(Selected(Room(3))).number == 1


@pytest.mark.parametrize("refused", [0, 1, 2])
def test_exchange_2_a_no_to_any_support_ends_it_and_persuades_nobody(
    exchanges: tuple[Exchange, ...], refused: int
) -> None:
    table = Table(exchanges[1])
    table.open(ROBOT, Selected(Room(3)))
    table.say(HUMAN, "challenge(selected(Room3))")
    supports = [str(level()), str(cost(4, 3, 250.0)), str(less((250.0,), 1000.0))]
    table.say(ROBOT, f"assert({{{', '.join(supports)}}}, selected(Room3))")
    for support in supports[:refused]:
        table.say(ROBOT, f"assert({support})")
        table.say(HUMAN, f"accept({support})")
    table.say(ROBOT, f"assert({supports[refused]})")
    table.say(HUMAN, "reject(selected(Room3))")
    assert table.end() is DialogueEnd.DISAGREEMENT
    assert ROOM_3 in table.robot.beliefs
    assert ~ROOM_3 in table.robot.picture


def test_exchange_3_who_believes_cannot_assert_the_opposite_and_may_be_persuaded(
    exchanges: tuple[Exchange, ...],
) -> None:
    table = Table(exchanges[2])
    table.open(ROBOT, Selected(Room(3)))
    table.say(HUMAN, "assert(not selected(Room3))")
    assert table.legal() == {"accept(not selected(Room3))", "challenge(not selected(Room3))"}
    table.say(ROBOT, "accept(not selected(Room3))")
    assert table.end() is DialogueEnd.AGREEMENT
    assert ROOM_3 not in table.robot.beliefs and ~ROOM_3 in table.robot.beliefs
    assert ROOM_1 in table.robot.beliefs


@pytest.mark.parametrize("reason", ["wanted(not selected(Room3))", "too_far(Room3)", "visited(Room3)"])
@pytest.mark.parametrize("accepts", [True, False])
def test_exchange_3_the_person_defends_the_opposite_with_a_reason_of_hers(
    exchanges: tuple[Exchange, ...], reason: str, accepts: bool
) -> None:
    table = Table(exchanges[2])
    table.open(ROBOT, Selected(Room(3)))
    table.say(HUMAN, "assert(not selected(Room3))")
    table.say(ROBOT, "challenge(not selected(Room3))")
    table.say(HUMAN, f"assert({reason})")
    # The robot has an argument of its own for room 3, and none against: the beliefs allow both answers.
    assert table.legal() == {f"accept({reason})", "reject(not selected(Room3))"}
    table.say(ROBOT, f"accept({reason})" if accepts else "reject(not selected(Room3))")
    assert table.end() is (DialogueEnd.AGREEMENT if accepts else DialogueEnd.DISAGREEMENT)
    assert (ROOM_3 in table.robot.beliefs) is not accepts
    assert (~ROOM_3 in table.robot.beliefs) is accepts


def test_exchange_4_the_order_is_agreed_in_a_second_dialogue_with_one_inside_it(
    exchanges: tuple[Exchange, ...],
) -> None:
    table = Table(exchanges[3])
    mine, first = "order(1, Room1) and order(2, Room3)", Literal(VisitOrder(1, Room(1)))
    theirs = "not order(1, Room1) and not order(2, Room3)"
    assert table.open(ROBOT, order(1, 3)) == f"assert({mine})"
    table.say(HUMAN, f"assert({theirs})")
    table.say(ROBOT, f"challenge({theirs})")
    table.say(HUMAN, "assert(wanted(order(1, Room3) and order(2, Room1)))")
    table.say(ROBOT, f"reject({theirs})")
    assert table.end() is DialogueEnd.DISAGREEMENT
    assert Literal(VisitOrder(1, Room(3))) in table.robot.picture
    # Again, with the same assertion; the answer that was used up is not legal any more.
    assert table.open(ROBOT, order(1, 3)) == f"assert({mine})"
    assert table.legal(2) == {f"accept({mine})", f"challenge({mine})"}
    table.say(HUMAN, f"challenge({mine})", 2)
    said = {
        "s1": "current_energy_level(1000)",
        "s2": "energy_cost(Room4, Room1, 100)",
        "s4": "energy_cost(Room4, Room3, 250)",
        "s6": "less_than(100, 250)",
        "s3": "less_than(100, 1000)",
        "s5": "energy_cost(Room1, Room3, 250)",
        "s7": "less_than(100 + 250, 1000)",
    }
    announced = ", ".join(sorted(said[name] for name in ("s1", "s2", "s4", "s5", "s6", "s7")))
    table.say(ROBOT, f"assert({{{announced}}}, {mine})", 2)
    for name in ("s1", "s2", "s4", "s6", "s3"):
        table.say(ROBOT, f"assert({said[name]})", 2)
        table.say(HUMAN, f"accept({said[name]})", 2)
    assert table.open(ROBOT, VisitOrder(1, Room(1)), parent=2) == "assert(order(1, Room1))"
    assert table.legal(2) == set()
    with pytest.raises(IllegalMoveError):
        table.now.say(2, table.now.play(2).moves[0][1])
    table.say(HUMAN, "accept(order(1, Room1))", 3)
    assert table.end(3) is DialogueEnd.AGREEMENT
    assert first in table.robot.picture and Literal(VisitOrder(1, Room(3))) not in table.robot.picture
    assert all(text in {str(each) for each in table.robot.picture.held} for text in list(said.values())[:5])
    for name in ("s5", "s7"):
        table.say(ROBOT, f"assert({said[name]})", 2)
        table.say(HUMAN, f"accept({said[name]})", 2)
    assert table.end(2) is DialogueEnd.AGREEMENT
    assert Literal(order(1, 3)) in table.robot.picture
    assert [said.dialogue for said in table.now.record].count(3) == 2


def test_exchange_5_a_question_without_an_answer_another_with_one_and_a_proposal(
    exchanges: tuple[Exchange, ...],
) -> None:
    table = Table(exchanges[4])
    # She has not been asked, and sees shapes: a question, not an inquiry.
    assert table.now.case(BOTTLE_IN_5).number == 9
    assert table.open(ROBOT, BOTTLE_IN_5) == "question(in_image(bottle, image5))"
    beliefs = table.robot.beliefs
    table.say(HUMAN, "assert(U(in_image(bottle, image5)))")
    assert table.end() is DialogueEnd.UNKNOWN
    assert Unknown(BOTTLE_IN_5) in table.robot.picture
    assert table.robot.beliefs == beliefs
    assert table.now.openings(ROBOT, BOTTLE_IN_5) == ()
    assert table.open(ROBOT, BOTTLE_IN_2) == "question(in_image(bottle, image2))"
    table.say(HUMAN, "assert(in_image(bottle, image2))", 2)
    assert Literal(BOTTLE_IN_2) in table.robot.picture and Literal(BOTTLE_IN_2) not in table.robot.beliefs
    table.say(ROBOT, "accept(in_image(bottle, image2))", 2)
    assert table.end(2) is DialogueEnd.AGREEMENT
    assert Literal(BOTTLE_IN_2) in table.robot.beliefs and Literal(BOTTLE_IN_2) in table.human.picture
    assert Literal(ColourFound("image2", "blue")) in table.robot.beliefs
    assert table.open(HUMAN, BLUE_BOTTLE) == f"propose({BLUE_BOTTLE_SEEN})"
    table.say(ROBOT, f"accept({BLUE_BOTTLE_SEEN})", 3)
    assert table.end(3) is DialogueEnd.AGREEMENT
    assert Literal(BLUE_BOTTLE) in table.robot.beliefs
    for agent in (table.robot, table.human):
        assert BLUE_BOTTLE_SEEN in agent.picture and Literal(BLUE_BOTTLE) in agent.picture
