"""Three exchanges with rules as topics: a robot and a person examine what pictures show about treasures.

An argument for a rule derives the rule's conclusion when the rule's premises are granted. A side that grants the
premises has not accepted the rule.
"""

from thbridge.dialogue.argumentation.beliefs import Beliefs
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.examples import BLUE_BOTTLE, BLUE_BOTTLE_SEEN, BOTTLE_IN_2, Exchange, course, people_see_shapes
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.tables import Rulebook
from thbridge.dialogue.propositions import ColourFound, InImage, TreasureIn
from thbridge.hunt.rooms import Room

_BROWN, _BOTTLE_IN_3 = Literal(ColourFound("image3", "brown")), Literal(InImage("bottle", "image3"))
BROWN_BOTTLE = TreasureIn("brown bottle", Room(2))
_BLUE, _BOTTLE = Literal(ColourFound("image2", "blue")), Literal(BOTTLE_IN_2)
BOTTLE_IS_BLUE = Rule((_BOTTLE,), Literal(BLUE_BOTTLE))


def rules_as_topics(rulebook: Rulebook) -> tuple[Exchange, ...]:
    """Return the three exchanges."""
    chain = [Rule((_BROWN,), _BOTTLE_IN_3), Rule((_BOTTLE_IN_3,), Literal(BROWN_BOTTLE))]
    return (
        Exchange(
            "A rule that follows from two others",
            (BROWN_BOTTLE,),
            _conversation(rulebook, Beliefs.of([_BROWN], chain), Beliefs()),
            course(
                """
                robot: propose(color_found(image3, brown) -> treasure_in(brown bottle, Room2))
                human: challenge(color_found(image3, brown) -> treasure_in(brown bottle, Room2))
                robot: propose(color_found(image3, brown) -> in_image(bottle, image3))
                human: accept(color_found(image3, brown) -> in_image(bottle, image3))
                robot: propose(in_image(bottle, image3) -> treasure_in(brown bottle, Room2))
                human: accept(in_image(bottle, image3) -> treasure_in(brown bottle, Room2))
                """
            ),
        ),
        Exchange(
            "A rule that rests on what the other denies",
            (BLUE_BOTTLE,),
            _conversation(
                rulebook,
                Beliefs.of([~_BLUE]),
                Beliefs.of([_BOTTLE, _BLUE], [BOTTLE_IS_BLUE, BLUE_BOTTLE_SEEN]),
            ),
            course(
                """
                human: propose(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
                robot: challenge(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
                human: propose(color_found(image2, blue))
                robot: reject(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
                human: question(not color_found(image2, blue))
                robot: assert(not color_found(image2, blue))
                human: accept(not color_found(image2, blue))
                """
            ),
        ),
        Exchange(
            "A premise that is granted, and a rule that is not",
            (BOTTLE_IN_2, BLUE_BOTTLE),
            _conversation(rulebook, Beliefs.of([_BLUE], [BOTTLE_IS_BLUE]), Beliefs.of([_BOTTLE], [BLUE_BOTTLE_SEEN])),
            course(
                """
                robot: question(in_image(bottle, image2))
                human: assert(in_image(bottle, image2))
                robot: accept(in_image(bottle, image2))
                robot: propose(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
                human: challenge(in_image(bottle, image2) -> treasure_in(blue bottle, Room1))
                human: propose(in_image(bottle, image2) and color_found(image2, blue) \
-> treasure_in(blue bottle, Room1))
                robot: accept(in_image(bottle, image2) and color_found(image2, blue) \
-> treasure_in(blue bottle, Room1))
                """
            ),
        ),
    )


def _conversation(rulebook: Rulebook, robot: Beliefs, person: Beliefs) -> Conversation:
    agents = {Side.ROBOT: Agent(Side.ROBOT, robot), Side.HUMAN: Agent(Side.HUMAN, person, is_person=True)}
    return Conversation(rulebook, agents, able=people_see_shapes)
