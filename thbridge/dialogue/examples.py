"""The worked example of Sklar and Azhar (2015): five exchanges between a robot and a person about a treasure hunt.

The robot stands in room 4 with an energy of 1000. Each exchange begins with empty commitment stores. The second and the
third exchange use the costs of the later exchanges.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from thbridge.dialogue.argumentation.beliefs import Beliefs, Origin, Source
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule
from thbridge.dialogue.games.agents import Agent, Picture
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.propositions import (
    ColourFound,
    EnergyCost,
    EnergyLevel,
    InImage,
    LessThan,
    RoomSequence,
    Selected,
    TooFar,
    TreasureIn,
    Visited,
    VisitOrder,
    Wanted,
)
from thbridge.hunt.rooms import Room

ENERGY = 1000.0
HERE = Room(4)
COLOURS: Mapping[str, tuple[str, ...]] = {
    "image1": ("brown",),
    "image2": ("grey", "blue"),
    "image3": ("brown",),
    "image4": ("yellow",),
    "image5": ("blue",),
}


@dataclass(frozen=True, slots=True)
class Exchange:
    """One exchange of the example.

    Attributes:
        title: title for people.
        topics: propositions of the exchange, in the order of the dialogues about them.
        start: the conversation before the first move.
        course: moves in order, each with its side; several alternatives if the example allows any of them.
    """

    title: str
    topics: tuple[Proposition, ...]
    start: Conversation
    course: tuple[tuple[Side, tuple[str, ...]], ...] = ()


def jhri2015(rulebook: Rulebook) -> tuple[Exchange, ...]:
    """Return the five exchanges."""
    exchanges = (
        Exchange("Which rooms: they agree on one of two", _rooms_of(1, 3), _where(rulebook, 100.0)),
        Exchange("Which rooms: the person asks for reasons", _rooms_of(3), _where(rulebook, 250.0)),
        Exchange("Which rooms: the person says the opposite", _rooms_of(3), _where(rulebook, 250.0)),
        Exchange("In which order", (order(1, 3),), _how(rulebook)),
        Exchange("What was found", (BOTTLE_IN_5, BOTTLE_IN_2, BLUE_BOTTLE), _what(rulebook)),
    )
    return tuple(replace(each, course=course(text)) for each, text in zip(exchanges, _COURSES, strict=True))


def course(text: str) -> tuple[tuple[Side, tuple[str, ...]], ...]:
    """Return the course in a text. Each line has a side and its move, with ` | ` between alternative moves."""
    lines = [line.strip().split(": ", 1) for line in text.strip().splitlines()]
    return tuple((Side(side), tuple(moves.split(" | "))) for side, moves in lines)


_COURSES = (
    # The person has three answers in the example; two of them are the next exchanges.
    """
    robot: assert(selected(Room3))
    """,
    """
    robot: assert(selected(Room3))
    human: challenge(selected(Room3))
    robot: assert({current_energy_level(1000), energy_cost(Room4, Room3, 250), less_than(250, 1000)}, selected(Room3))
    robot: assert(current_energy_level(1000))
    human: accept(current_energy_level(1000))
    robot: assert(energy_cost(Room4, Room3, 250))
    human: accept(energy_cost(Room4, Room3, 250))
    robot: assert(less_than(250, 1000))
    human: accept(less_than(250, 1000))
    """,
    """
    robot: assert(selected(Room3))
    human: assert(not selected(Room3))
    robot: accept(not selected(Room3)) | challenge(not selected(Room3))
    human: assert(wanted(not selected(Room3))) | assert(too_far(Room3)) | assert(visited(Room3))
    robot: accept(wanted(not selected(Room3))) | accept(too_far(Room3)) | accept(visited(Room3)) \
| reject(not selected(Room3))
    """,
    """
    robot: assert(order(1, Room1) and order(2, Room3))
    human: assert(not order(1, Room1) and not order(2, Room3))
    robot: challenge(not order(1, Room1) and not order(2, Room3))
    human: assert(wanted(order(1, Room3) and order(2, Room1)))
    robot: reject(not order(1, Room1) and not order(2, Room3))
    robot: assert(order(1, Room1) and order(2, Room3))
    human: challenge(order(1, Room1) and order(2, Room3))
    robot: assert({current_energy_level(1000), energy_cost(Room1, Room3, 250), energy_cost(Room4, Room1, 100), \
energy_cost(Room4, Room3, 250), less_than(100 + 250, 1000), less_than(100, 250)}, \
order(1, Room1) and order(2, Room3))
    robot: assert(current_energy_level(1000))
    human: accept(current_energy_level(1000))
    robot: assert(energy_cost(Room4, Room1, 100))
    human: accept(energy_cost(Room4, Room1, 100))
    robot: assert(energy_cost(Room4, Room3, 250))
    human: accept(energy_cost(Room4, Room3, 250))
    robot: assert(less_than(100, 250))
    human: accept(less_than(100, 250))
    robot: assert(less_than(100, 1000))
    human: accept(less_than(100, 1000))
    robot: assert(order(1, Room1))
    human: accept(order(1, Room1))
    robot: assert(energy_cost(Room1, Room3, 250))
    human: accept(energy_cost(Room1, Room3, 250))
    robot: assert(less_than(100 + 250, 1000))
    human: accept(less_than(100 + 250, 1000))
    """,
    """
    robot: question(in_image(bottle, image5))
    human: assert(U(in_image(bottle, image5)))
    robot: question(in_image(bottle, image2))
    human: assert(in_image(bottle, image2))
    robot: accept(in_image(bottle, image2))
    human: propose(in_image(bottle, image2) and color_found(image2, blue) -> treasure_in(blue bottle, Room1))
    robot: accept(in_image(bottle, image2) and color_found(image2, blue) -> treasure_in(blue bottle, Room1))
    """,
)
"""The courses of the exchanges, one move per line; a bar separates alternative moves."""


def order(*rooms: int) -> RoomSequence:
    """Return the proposition that these rooms are visited in this order."""
    return RoomSequence(tuple(map(Room, rooms)))


BOTTLE_IN_5, BOTTLE_IN_2 = InImage("bottle", "image5"), InImage("bottle", "image2")
BLUE_BOTTLE = TreasureIn("blue bottle", Room(1))
BLUE_BOTTLE_SEEN = Rule((Literal(BOTTLE_IN_2), Literal(ColourFound("image2", "blue"))), Literal(BLUE_BOTTLE))


def level() -> Literal:
    """Return the robot's energy level, s1."""
    return Literal(EnergyLevel(ENERGY))


def cost(start: int, goal: int, energy: float) -> Literal:
    """Return the literal on the cost of a path."""
    return Literal(EnergyCost(Room(start), Room(goal), energy))


def less(terms: tuple[float, ...], limit: float) -> Literal:
    """Return the literal that a sum of energies is below another energy."""
    return Literal(LessThan(terms, limit))


def _rooms_of(*rooms: int) -> tuple[Proposition, ...]:
    return tuple(Selected(Room(room)) for room in rooms)


def _affordable(room: int, energy: float) -> Rule:
    premises = (level(), cost(HERE.people, room, energy), less((energy,), ENERGY))
    return Rule(premises, Literal(Selected(Room(room))), is_said=False)


def _where(rulebook: Rulebook, to_room_3: float) -> Conversation:
    costs = {1: 100.0, 3: to_room_3}
    rules = [_affordable(room, energy) for room, energy in costs.items()]
    evidence = [level()]
    for room, energy in costs.items():
        evidence += [cost(HERE.people, room, energy), less((energy,), ENERGY)]
    decided = [Literal(Selected(Room(room))) for room in costs]
    against = Literal(Selected(Room(3)), holds=False)
    reasons: tuple[Proposition, ...] = (Wanted(against), TooFar(Room(3)), Visited(Room(3)))
    hers = frozenset([Literal(Selected(Room(1))), against])
    return _conversation(rulebook, _robot(evidence, decided, rules, hers), _person(reasons, against, rules))


def _how(rulebook: Rulebook) -> Conversation:
    to_1, to_3, from_1_to_3 = cost(4, 1, 100.0), cost(4, 3, 250.0), cost(1, 3, 250.0)
    below, nearer, sum_below = less((100.0,), ENERGY), less((100.0,), 250.0), less((100.0, 250.0), ENERGY)
    first, mine, theirs = Literal(VisitOrder(1, Room(1))), Literal(order(1, 3)), Literal(order(3, 1))
    rules = [
        Rule((level(), to_1, to_3, nearer, below), first, is_said=False),
        Rule((level(), to_1, to_3, from_1_to_3, nearer, sum_below), mine, is_said=False),
    ]
    # In the order in which the robot says them: s1, s2, s4, s6, s3, then s5 and s7.
    evidence = [level(), to_1, to_3, nearer, below, from_1_to_3, sum_below]
    robot = _robot(evidence, [mine, *mine.parts], rules, frozenset([theirs, *theirs.parts]))
    against = ~mine
    return _conversation(rulebook, robot, _person((Wanted(theirs),), against, rules))


def _what(rulebook: Rulebook) -> Conversation:
    evidence = [Literal(ColourFound(image, colour)) for image, colours in COLOURS.items() for colour in colours]
    robot = _robot(evidence, [], [], frozenset())
    person = Agent(
        Side.HUMAN,
        Beliefs.of([Literal(BOTTLE_IN_2)], [BLUE_BOTTLE_SEEN]),
        is_person=True,
        picture=Picture(frozenset(evidence)),
    )
    return _conversation(rulebook, robot, person)


def _robot(evidence: list[Literal], decided: list[Literal], rules: list[Rule], hers: frozenset[Literal]) -> Agent:
    origins = dict.fromkeys(evidence, Origin(Source.SENSED)) | dict.fromkeys(decided, Origin(Source.DECIDED))
    return Agent(Side.ROBOT, Beliefs(origins, tuple(rules)), picture=Picture(hers))


def _person(reasons: tuple[Proposition, ...], against: Literal, rules: list[Rule]) -> Agent:
    """Return a person who may give several reasons against the robot's wish."""
    own = [Rule((Literal(reason),), against, is_said=False) for reason in reasons]
    return Agent(Side.HUMAN, Beliefs.of(map(Literal, reasons), [*rules, *own], Source.TOLD), is_person=True)


def _conversation(rulebook: Rulebook, robot: Agent, person: Agent) -> Conversation:
    return Conversation(rulebook, {Side.ROBOT: robot, Side.HUMAN: person}, able=people_see_shapes)


def people_see_shapes(side: Side, proposition: Proposition) -> bool:
    """Return True for propositions that a side is assumed to know: the person knows which things pictures show."""
    return side is Side.HUMAN and isinstance(proposition, InImage)
