"""Portrait of a conversation: a robot's beliefs, its picture of the person, and its conclusions, as plain text.

Recordings contain portraits, and researchers see them.
"""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from itertools import islice

from thbridge.dialogue.argumentation.arguments import Argument, framework_of
from thbridge.dialogue.argumentation.beliefs import Beliefs, Source
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule, opposed
from thbridge.dialogue.argumentation.semantics import grounded
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.locutions import origin_of_hearsay
from thbridge.json_text import json_of

MOST_ARGUMENTS = 40
"""Maximum number of arguments in a portrait."""
MOST_KEPT = 400
"""Maximum number of beliefs, moves of a store, or games in a portrait; if there are more, only the latest are kept."""


@dataclass(frozen=True, slots=True)
class PortrayedBelief:
    """Belief of a robot.

    Attributes:
        literal: the believed literal.
        source: kind of source of the belief.
        at: simulated time of the observation or computation, s.
        confidence: confidence of the agent that sensed or computed it, 0 to 1.
    """

    literal: str
    source: str
    at: float
    confidence: float


@dataclass(frozen=True, slots=True)
class PortrayedGame:
    """Dialogue game of a conversation.

    Attributes:
        number: number of the game, from 1, unique among the games of one robot.
        parent: number of the game that waits for this game; 0 if there is none.
        game: name of the game.
        topic: topic of the game.
        opener: the side that opened the game.
        end: end of the game; empty while the game continues.
    """

    number: int
    parent: int
    game: str
    topic: str
    opener: str
    end: str


@dataclass(frozen=True, slots=True)
class PortrayedArgument:
    """Argument about the subject of the conversation.

    Attributes:
        support: beliefs on which the argument rests.
        conclusion: the conclusion.
        sides: the sides that hold the complete support, "robot" or "human", as far as the robot knows; for an objection
            and a decision in spite of it, the name of the seat.
    """

    support: tuple[str, ...]
    conclusion: str
    sides: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ObjectionsToClaim:
    """Objections of seats that only read along, as arguments against the claim of a dialogue.

    An objection rebuts each argument for the claim, and these arguments rebut the objection. The decision of the seat
    that talks with the robot is an argument for the claim. It is preferred to objections, so their attacks on it fail,
    and it defends the other arguments for the claim against them (preferences between arguments: Amgoud and Cayrol
    2002, A reasoning model based on the production of acceptable arguments, Annals of Mathematics and AI 34).

    Attributes:
        claim: the claim of the dialogue.
        raised: seat and premise of each objection, oldest first.
        decided: seat and premise of the decision for the claim; None if there is no such decision.
    """

    claim: Literal
    raised: tuple[tuple[str, Literal], ...]
    decided: tuple[str, Literal] | None = None


@dataclass(frozen=True, slots=True)
class DialoguePortrait:
    """Portrait of a conversation, as the robot sees it.

    Attributes:
        games: dialogue games of the present situation, in order of opening.
        sigma: beliefs of the robot (Sigma).
        rules: rules that the robot holds, without rules of the language.
        held: literals that the person holds, as the robot assumes (Gamma(H)).
        unknown: propositions about which the person knows nothing, as the robot assumes.
        argued: conclusions for which the person has an argument, as the robot assumes.
        robot_store: moves in the robot's commitment store, oldest first.
        human_store: moves in the person's commitment store.
        arguments: arguments about the topics of the games and about its decisions, from its beliefs and the person's
            statements.
        attacks: pairs of indices of attacker and attacked argument; only attacks that succeed against the robot's
            preferences.
        grounded: indices of the arguments in the grounded extension.
    """

    games: tuple[PortrayedGame, ...] = ()
    sigma: tuple[PortrayedBelief, ...] = ()
    rules: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    argued: tuple[str, ...] = ()
    robot_store: tuple[str, ...] = ()
    human_store: tuple[str, ...] = ()
    arguments: tuple[PortrayedArgument, ...] = ()
    attacks: tuple[tuple[int, int], ...] = ()
    grounded: tuple[int, ...] = ()

    def json(self) -> str:
        """Return the text of the portrait in recordings."""
        return json.dumps(
            {
                "games": [asdict(game) for game in self.games],
                "sigma": [[each.literal, each.source, each.at, each.confidence] for each in self.sigma],
                "rules": self.rules,
                "gamma": {"held": self.held, "unknown": self.unknown, "argued": self.argued},
                "stores": {"robot": self.robot_store, "human": self.human_store},
                "arguments": [asdict(argument) for argument in self.arguments],
                "attacks": self.attacks,
                "grounded": self.grounded,
            },
            ensure_ascii=False,
        )


def read_portrait(text: str) -> DialoguePortrait:
    """Return the portrait that `json` has written as this text. Raises ValueError for any other text."""
    try:
        values = json_of(text)
        gamma, stores, arguments = values["gamma"], values["stores"], values["arguments"]
        portrait = DialoguePortrait(
            games=tuple(
                PortrayedGame(
                    int(game["number"]),
                    int(game["parent"]),
                    *(str(game[key]) for key in ("game", "topic", "opener", "end")),
                )
                for game in values["games"]
            ),
            sigma=tuple(
                PortrayedBelief(str(literal), str(source), float(at), float(confidence))
                for literal, source, at, confidence in values["sigma"]
            ),
            rules=_texts(values["rules"]),
            held=_texts(gamma["held"]),
            unknown=_texts(gamma["unknown"]),
            argued=_texts(gamma["argued"]),
            robot_store=_texts(stores["robot"]),
            human_store=_texts(stores["human"]),
            arguments=tuple(
                PortrayedArgument(_texts(each["support"]), str(each["conclusion"]), _texts(each["sides"]))
                for each in arguments
            ),
            attacks=tuple((int(one), int(other)) for one, other in values["attacks"]),
            grounded=tuple(map(int, values["grounded"])),
        )
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise ValueError(f"no portrait of a conversation: {error}") from None
    places = range(len(portrait.arguments))
    if any(place not in places for pair in (*portrait.attacks, portrait.grounded) for place in pair):
        raise ValueError("no portrait of a conversation: it refers to a missing argument")
    return portrait


def portray(conversation: Conversation, objections: ObjectionsToClaim | None = None) -> DialoguePortrait:
    """Return the portrait of a conversation, with the objections of other seats, if there are any."""
    robot, person = conversation.agents[Side.ROBOT], conversation.agents[Side.HUMAN]
    beliefs, picture = _put_forward(robot, person), robot.picture
    others = {} if objections is None else _of_others(objections)
    arguments = (*islice(_arguments(conversation, beliefs), MOST_ARGUMENTS - len(others)), *others)
    claim = None if objections is None else objections.claim

    def prefers(one: Argument, other: Argument) -> bool:
        against = [each for each in (one, other) if each in others and each.conclusion != claim]
        return one in others and one not in against if against else beliefs.prefers(one, other)

    framework = framework_of(arguments, prefers)
    standing = grounded(framework)
    return DialoguePortrait(
        games=tuple(
            PortrayedGame(
                play.number, play.parent or 0, play.game.name, str(play.topic), play.initiator, play.end or ""
            )
            for play in conversation.plays[conversation.since :][-MOST_KEPT:]
        ),
        sigma=tuple(
            PortrayedBelief(str(literal), origin.source, origin.at, origin.confidence)
            for literal, origin in [*robot.beliefs.origins.items()][-MOST_KEPT:]
        ),
        rules=tuple(str(rule) for rule in robot.beliefs.rules if rule.is_said)[-MOST_KEPT:],
        held=_sorted((*picture.held, *picture.rules)),
        unknown=_sorted(picture.unknown),
        argued=_sorted(picture.argued),
        robot_store=tuple(map(str, robot.store[-MOST_KEPT:])),
        human_store=tuple(map(str, person.store[-MOST_KEPT:])),
        arguments=tuple(
            PortrayedArgument(
                tuple(sorted(map(str, argument.support))),
                str(argument.conclusion),
                (others[argument],) if argument in others else tuple(_sides(argument, robot)),
            )
            for argument in arguments
        ),
        attacks=tuple(sorted((framework.index[one], framework.index[other]) for one, other in framework.attacks)),
        grounded=tuple(sorted(framework.index[name] for name in standing)),
    )


def _of_others(objections: ObjectionsToClaim) -> dict[Argument, str]:
    """Return the arguments from objections, and from the decision in spite of them, each with its seat."""
    found = {Argument(frozenset([premise]), ~objections.claim): seat for seat, premise in objections.raised}
    if objections.decided is not None:
        seat, premise = objections.decided
        found[Argument(frozenset([premise]), objections.claim)] = seat
    return found


def _put_forward(robot: Agent, person: Agent) -> Beliefs:
    """Return the robot's beliefs, together with the person's shown beliefs and the rules of the person's arguments."""
    picture = robot.picture
    hers = [rule for rule in person.beliefs.rules if all(premise in picture.held for premise in rule.premises)]
    rules = tuple(dict.fromkeys((*robot.beliefs.rules, *hers)))
    # A claim of the person does not support itself.
    claims = {rule.conclusion.proposition for rule in (*rules, *person.beliefs.rules)}
    shown = {
        literal: origin_of_hearsay(literal, 0.0)
        for literal in sorted(picture.held, key=str)
        if literal.proposition not in claims and len(literal.parts) == 1
    }
    return Beliefs({**shown, **robot.beliefs.origins}, rules)


def _arguments(conversation: Conversation, beliefs: Beliefs) -> Iterable[Argument]:
    """Return arguments for and against topics and decisions, then arguments against their supports, each once."""
    robot = conversation.agents[Side.ROBOT]
    topics = [play.topic for play in conversation.plays[conversation.since :]]
    issues = dict.fromkeys(topic.conclusion if isinstance(topic, Rule) else topic for topic in reversed(topics))
    issues |= dict.fromkeys(
        literal
        for literal, origin in robot.beliefs.origins.items()
        if origin.source is Source.DECIDED and literal.holds
    )
    conclusions = dict.fromkeys((*issues, *(~issue for issue in issues), *(rule.conclusion for rule in beliefs.rules)))
    found = dict.fromkeys(sorted(robot.picture.arguments, key=str))
    found |= dict.fromkeys(
        argument for rule in topics if isinstance(rule, Rule) for argument in beliefs.arguments(rule)
    )
    found |= _about(conclusions, issues, beliefs)
    premises = dict.fromkeys(premise for argument in found for premise in sorted(argument.premises, key=str))
    against = [*conclusions, *(~premise for premise in premises)]
    return found | _about(dict.fromkeys(against), premises, beliefs)


def _about(conclusions: Iterable[Literal], issues: Iterable[Literal], beliefs: Beliefs) -> dict[Argument, None]:
    """Return arguments for each conclusion that is an issue or is opposed to an issue."""
    at_issue = [*issues]
    wanted = [each for each in conclusions if each in at_issue or any(opposed(each, issue) for issue in at_issue)]
    return dict.fromkeys(argument for conclusion in wanted for argument in beliefs.arguments(conclusion))


def _sides(argument: Argument, robot: Agent) -> Iterable[str]:
    if argument in robot.beliefs.arguments(argument.conclusion):
        yield Side.ROBOT
    if argument in robot.picture.arguments or all(support in robot.picture for support in argument.support):
        yield Side.HUMAN


def _texts(values: Iterable[object]) -> tuple[str, ...]:
    return tuple(map(str, values))


def _sorted(values: Iterable[object]) -> tuple[str, ...]:
    return tuple(sorted(map(str, values))[-MOST_KEPT:])
