"""Locutions: their conditions and their effects (Sklar and Azhar 2015, figure 4).

A locution is data: names of conditions and effects. The tables of this module define the meanings of these names.
Conditions on the speaker's own beliefs apply only to programs, because the beliefs of a person are unknown.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal as OneOf

from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.beliefs import Origin, Source
from thbridge.dialogue.argumentation.cases import Stance
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import Content, ContentKind, DialogueMove, Unknown

Able = Callable[[Proposition], bool]
"""True for propositions about which an agent is assumed to know the answer, such as a shape that a person sees."""


@dataclass(frozen=True, slots=True)
class Locution:
    """Definition of a locution with one kind of content.

    Attributes:
        name: name of the locution, as written in files.
        content: kind of the content.
        before: names of the conditions for a program.
        before_person: names of the conditions for a person.
        after: names of the effects.
        of: slot to which this form applies. If None, this form applies to all slots without a form of their own.
    """

    name: str
    content: ContentKind
    before: tuple[str, ...] = ()
    before_person: tuple[str, ...] = ()
    after: tuple[str, ...] = ()
    of: OneOf["support"] | None = None

    @property
    def makes_claim(self) -> bool:
        """True if the speaker has to defend the content after the move."""
        return "claimed" in self.after


@dataclass(frozen=True, slots=True)
class Utterer:
    """Speaker and listener at a move, for conditions.

    Attributes:
        speaker: the side that speaks.
        listener: the other side.
        able: returns True if the listener is assumed to be able to answer questions about a proposition.
        committing: names of locutions that show that their speaker holds the content.
        in_question: a literal on which the speaker may ask despite an opinion, because the listener has just refused
            its opposite.
    """

    speaker: Agent
    listener: Agent
    able: Able
    committing: frozenset[str]
    in_question: Belief | None = None


@dataclass(frozen=True, slots=True)
class Precondition:
    """Condition on a content, with its meaning for authors of files, and the kinds of contents that can meet it."""

    meaning: str
    holds: Callable[[Utterer, Content], bool]
    kinds: frozenset[ContentKind] = frozenset(ContentKind)


@dataclass(frozen=True, slots=True)
class Postcondition:
    """Effect of a locution, with its meaning for authors of files, and the kinds of contents that have this effect.

    `apply` has arguments for speaker, listener, move and time (s), and returns the two sides after the move.
    """

    meaning: str
    apply: Callable[[Agent, Agent, DialogueMove, float], tuple[Agent, Agent]]
    kinds: frozenset[ContentKind] = frozenset(ContentKind)


def may_say(locution: Locution, at: Utterer, content: Content) -> bool:
    """Return True if the speaker meets all conditions of a locution."""
    names = locution.before_person if at.speaker.is_person else locution.before
    return all(CONDITIONS[name].holds(at, content) for name in names)


def after_saying(
    locution: Locution, speaker: Agent, listener: Agent, move: DialogueMove, at: float
) -> tuple[Agent, Agent]:
    """Return speaker and listener after a move.

    Args:
        locution: locution of the move.
        speaker: the side that speaks.
        listener: the other side.
        move: the move.
        at: simulated time, s.
    """
    speaker = replace(speaker, store=(*speaker.store, move))
    for name in locution.after:
        speaker, listener = EFFECTS[name].apply(speaker, listener, move, at)
    return speaker, listener


def _undecided(at: Utterer, content: Content) -> bool:
    undecided = isinstance(content, Literal | Unknown) and at.speaker.beliefs.is_undecided(content.proposition)
    return undecided or content == at.in_question


def _held(at: Utterer, content: Content) -> bool:
    if isinstance(content, Argument):
        return content.conclusion in at.speaker.beliefs and content.support <= _all_of(at.speaker)
    return isinstance(content, Literal | Rule) and content in at.speaker.beliefs


def _all_of(agent: Agent) -> frozenset[Literal | Rule]:
    return frozenset([*agent.beliefs.origins, *agent.beliefs.rules])


def _argued(at: Utterer, content: Content) -> bool:
    if isinstance(content, Argument):
        return content in at.speaker.beliefs.arguments(content.conclusion)
    return isinstance(content, Literal | Rule) and bool(at.speaker.beliefs.arguments(content))


def _said(at: Utterer, content: Content) -> bool:
    return any(move.content == content and move.locution in at.committing for move in at.listener.store)


def _news(at: Utterer, content: Content) -> bool:
    if isinstance(content, Argument) and content.conclusion in at.speaker.picture:
        return False
    return content not in at.speaker.picture


def _thought_to_argue(at: Utterer, content: Content) -> bool:
    language = (rule for rule in at.speaker.beliefs.rules if not rule.is_said)
    return isinstance(content, Literal | Rule) and at.speaker.picture.has_argument(content, language)


def _answerable(at: Utterer, content: Content) -> bool:
    picture = at.speaker.picture
    if not isinstance(content, Literal) or (proposition := content.proposition) in picture.unknown:
        return False
    tells = picture.stance(proposition) is not Stance.UNKNOWN or at.able(proposition)
    return tells or content == at.in_question


def _shown(at: Utterer, content: Content) -> bool:
    proposition = content.proposition if isinstance(content, Literal | Unknown) else None
    has_opinion = proposition is not None and at.listener.picture.stance(proposition) is not Stance.UNKNOWN
    return has_opinion and content != at.in_question


def _premises_held(at: Utterer, content: Content) -> bool:
    if not isinstance(content, Rule):
        return _held(at, content)
    return all(premise in at.speaker.beliefs for premise in content.premises)


def _consequence_open(at: Utterer, content: Content) -> bool:
    if not isinstance(content, Rule):
        return True
    return content.conclusion not in at.speaker.beliefs and content.conclusion not in at.speaker.picture


_CLAIMS = frozenset({ContentKind.LITERAL, ContentKind.RULE})
_BELIEFS = frozenset(ContentKind) - {ContentKind.UNKNOWN}

CONDITIONS: Mapping[str, Precondition] = {
    "held": Precondition("the speaker believes the content", _held, _BELIEFS),
    "not held": Precondition("the speaker does not believe the content", lambda at, content: not _held(at, content)),
    "argued": Precondition("the speaker has an argument for the content", _argued, _BELIEFS),
    "not argued": Precondition(
        "the speaker has no argument for the content", lambda at, content: not _argued(at, content)
    ),
    "undecided": Precondition(
        "the speaker believes neither the content nor its opposite, or the listener just refused the opposite",
        _undecided,
    ),
    "news": Precondition(
        "the speaker does not yet think that the listener believes the content (for an argument: its conclusion)",
        _news,
    ),
    "attributed": Precondition(
        "the speaker thinks that the listener believes the content", lambda at, content: content in at.speaker.picture
    ),
    "thought to be argued": Precondition(
        "the listener is assumed to have an argument for the content", _thought_to_argue, _CLAIMS
    ),
    "answerable": Precondition(
        "the listener is assumed to have an opinion on the content or to know the answer, or just refused the opposite",
        _answerable,
        frozenset({ContentKind.LITERAL}),
    ),
    "said": Precondition("the listener has said the content, or accepted it", _said),
    "not shown": Precondition(
        "the speaker has not shown an opinion on the content, or the listener just refused the opposite",
        lambda at, content: not _shown(at, content),
    ),
    "premises held": Precondition(
        "the speaker believes the premises of the rule, or the content",
        _premises_held,
        _BELIEFS,
    ),
    "consequence open": Precondition(
        "neither side is thought to believe the conclusion of the rule", _consequence_open
    ),
}
"""Conditions by name. "Assumed" and "thinks" refer to the speaker's picture of the listener."""

CONTRADICTIONS = (("held", "not held"), ("argued", "not argued"), ("news", "attributed"))
"""Pairs of conditions that exclude each other."""


def _shows(speaker: Agent, listener: Agent, move: DialogueMove, _at: float) -> tuple[Agent, Agent]:
    return speaker, replace(listener, picture=listener.picture.gaining(move.content))


def _argues(speaker: Agent, listener: Agent, move: DialogueMove, _at: float) -> tuple[Agent, Agent]:
    if isinstance(move.content, Literal | Rule):
        listener = replace(listener, picture=listener.picture.arguing(move.content))
    return speaker, listener


def _shows_premises(speaker: Agent, listener: Agent, move: DialogueMove, _at: float) -> tuple[Agent, Agent]:
    picture = listener.picture
    for premise in move.content.premises if isinstance(move.content, Rule) else ():
        picture = picture.gaining(premise)
    return speaker, replace(listener, picture=picture)


def _is_persuaded(speaker: Agent, listener: Agent, move: DialogueMove, at: float) -> tuple[Agent, Agent]:
    # Accepting a content that is already held is legal; the belief keeps its origin.
    if isinstance(move.content, Literal | Rule) and move.content not in speaker.beliefs:
        speaker = replace(speaker, beliefs=speaker.beliefs.gaining(move.content, origin_of_hearsay(move.content, at)))
    return speaker, listener


def origin_of_hearsay(belief: Belief, at: float) -> Origin:
    """Return the origin of a belief stated by another agent, at a simulated time in s."""
    is_wish = isinstance(belief, Literal) and belief.proposition.is_wish
    return Origin(Source.WISHED if is_wish else Source.TOLD, at)


def _concludes(accepter: Agent, proposer: Agent, move: DialogueMove, at: float) -> tuple[Agent, Agent]:
    rule = move.content
    if not isinstance(rule, Rule):
        return accepter, proposer
    return _with_rule(accepter, rule, at), _with_rule(proposer, rule, at)


def _with_rule(agent: Agent, rule: Rule, at: float) -> Agent:
    """Return an agent that holds a rule and assumes that the other agent holds it. Sides apply the rule if they can."""
    beliefs = agent.beliefs.gaining(rule, Origin(Source.TOLD, at))
    if all(premise in beliefs for premise in rule.premises):
        beliefs = beliefs.gaining(rule.conclusion, Origin(Source.COMPUTED, at))
    picture = agent.picture.gaining(rule)
    if all(premise in picture for premise in rule.premises):
        picture = picture.gaining(rule.conclusion)
    return replace(agent, beliefs=beliefs, picture=picture)


EFFECTS: Mapping[str, Postcondition] = {
    "claimed": Postcondition(
        "the content becomes the claim, which the speaker defends", lambda i, j, _move, _at: (i, j), _CLAIMS
    ),
    "shown": Postcondition("from now on, the listener takes the speaker to hold the content (or not to know)", _shows),
    "shown to be argued": Postcondition(
        "the listener takes the speaker to have an argument for the content", _argues, _CLAIMS
    ),
    "premises shown": Postcondition(
        "from now on, the listener takes the speaker to hold the premises of the rule",
        _shows_premises,
        frozenset({ContentKind.RULE}),
    ),
    "believed": Postcondition(
        "the speaker believes the content, and drops beliefs opposed to it", _is_persuaded, _CLAIMS
    ),
    "concluded": Postcondition(
        "both sides learn the rule, and the conclusions from their beliefs", _concludes, frozenset({ContentKind.RULE})
    ),
}
"""Effects by name. In addition, the content of every locution enters the speaker's commitment store."""
