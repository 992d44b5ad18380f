"""Play of one dialogue game: its legal moves, and their effects."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown, opposite
from thbridge.dialogue.games.locutions import Able, Locution, Utterer, after_saying, may_say
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameStage, GameTable, Reply, Rulebook, Slot

Agents = Mapping[Side, Agent]


def other_side(side: Side) -> Side:
    """Return the other side."""
    return Side.HUMAN if side is Side.ROBOT else Side.ROBOT


@dataclass(frozen=True, slots=True)
class GamePlay:
    """Position in a dialogue game.

    Attributes:
        number: number of the dialogue, from 1.
        game: table of the game.
        topic: topic of the dialogue.
        initiator: the side that opened the dialogue.
        parent: number of the dialogue that waits for this dialogue; None if there is none.
        questions_refusal: True if a support was refused in the parent dialogue, and this dialogue asks whether the
            opposite of the support holds.
        stage: name of the present state; after the end, of the last state.
        claim: the defended claim; None before there is one.
        defender: the side that defends it.
        offered: stated support of the claim, in order.
        argument: the argument that was stated as a whole; None if there is none.
        moves: all moves so far, with their speakers.
        barred: pairs of an opening and a reply. The reply is not allowed, because an earlier dialogue has used it up.
        resumes: name of the state in which the dialogue resumes if the refusal that ended it is questioned. If None,
            the refusal cannot be questioned.
        put_off: the end that a refusal causes, while this end is postponed. The end is postponed from the question
            about the refusal until another move is made.
        end: end of the dialogue; None while the dialogue continues.
    """

    number: int
    game: GameTable
    topic: Belief
    initiator: Side
    parent: int | None = None
    questions_refusal: bool = False
    stage: str = ""
    claim: Belief | None = None
    defender: Side | None = None
    offered: tuple[Belief, ...] = ()
    argument: Argument | None = None
    moves: tuple[tuple[Side, DialogueMove], ...] = ()
    barred: frozenset[tuple[DialogueMove, DialogueMove]] = frozenset()
    resumes: str | None = None
    put_off: DialogueEnd | None = None
    end: DialogueEnd | None = None

    @property
    def state(self) -> GameStage:
        """The present state's row of the table."""
        return self.game.stages[self.stage or self.game.opening]

    @property
    def speaker(self) -> Side:
        """The side whose turn it is, while the dialogue continues."""
        match self.state.turn:
            case GameRole.INITIATOR:
                return self.initiator
            case GameRole.RESPONDENT:
                return other_side(self.initiator)
            case GameRole.DEFENDER:
                return self.defender or self.initiator
            case GameRole.CHALLENGER:
                return other_side(self.defender or self.initiator)

    @property
    def in_question(self) -> Literal | None:
        """Opposite of the support that was refused at the end, about which the defender may ask, or None."""
        refused = self.offered[-1] if self.resumes is not None and self.offered else None
        return ~refused if isinstance(refused, Literal) else None

    @property
    def has_refuted(self) -> bool:
        """True if both sides agree on the opposite of the support that was refused in the parent dialogue."""
        return self.questions_refusal and self.end is DialogueEnd.AGREEMENT and self.claim == self.topic

    def ended(self, end: DialogueEnd) -> "GamePlay":
        """Return the dialogue after an end without a move. If a refusal was questioned, the refusal is the end."""
        return replace(self, end=self.put_off or end)

    def questioned(self) -> "GamePlay":
        """Return the dialogue with its end postponed, because a question about the refusal waits for an answer."""
        return replace(self, stage=self.resumes or self.stage, resumes=None, put_off=self.end, end=None)


@dataclass(frozen=True, slots=True)
class LegalMove:
    """Legal move, with the row of the table that allows it."""

    move: DialogueMove
    reply: Reply


def legal_replies(play: GamePlay, agents: Agents, rulebook: Rulebook, able: Able) -> tuple[LegalMove, ...]:
    """Return the legal moves of the side whose turn it is, in the order of the table; none after the end.

    Args:
        play: the position.
        agents: both sides.
        rulebook: the locutions.
        able: returns True if the listener is assumed to be able to answer questions about a proposition.
    """
    if play.end is not None or len(play.moves) >= play.game.most_turns:
        return ()
    speaker = agents[play.speaker]
    in_question = play.topic if play.questions_refusal and not play.moves else None
    at = Utterer(speaker, agents[other_side(play.speaker)], able, rulebook.committing, in_question)
    said = {move for side, move in play.moves if side is play.speaker}
    return tuple(
        LegalMove(move, reply)
        for reply in play.state.replies
        for content in _contents(play, reply.slot, agents)
        if (locution := rulebook.locution(reply.locution, content, reply.slot)) is not None
        and may_say(locution, at, content)
        and (move := DialogueMove(reply.locution, content)) not in said
        and not (len(play.moves) == 1 and (play.moves[0][1], move) in play.barred)
    )


def is_last_support(play: GamePlay, agents: Agents, support: Belief | None = None) -> bool:
    """Return True if the claim needs no more support after `support`. If None, no support is added."""
    offered = play.offered if support is None else (*play.offered, support)
    return any(not due for _, due in _cases_made(replace(play, offered=offered), agents))


@dataclass(frozen=True, slots=True)
class GameUtterance:
    """A move that was made.

    Attributes:
        dialogue: number of the dialogue.
        parent: number of the dialogue that waits for this dialogue; None if there is none.
        index: index of the move in the dialogue, from 0.
        side: the side that made the move.
        move: the move.
        before: name of the state before the move.
        after: name of the state after the move, or of the end.
        is_booked: True if the move followed automatically, such as accepting a claim with the last part of its support.
    """

    dialogue: int
    parent: int | None
    index: int
    side: Side
    move: DialogueMove
    before: str
    after: str
    is_booked: bool = False


def say(
    play: GamePlay, agents: Agents, rulebook: Rulebook, legal: LegalMove, at: float
) -> tuple[GamePlay, Agents, tuple[GameUtterance, ...]]:
    """Return the dialogue and the sides after a legal move of the side whose turn it is, and the utterances, in order.

    Args:
        play: the position.
        agents: both sides.
        rulebook: the locutions.
        legal: the move.
        at: simulated time, s.
    """
    side, move, reply = play.speaker, legal.move, legal.reply
    before = play.stage or play.game.opening
    offers = reply.slot is Slot.SUPPORT and side is play.defender
    if offers and isinstance(move.content, Literal | Rule):
        play = replace(play, offered=(*play.offered, move.content))
    if reply.slot is Slot.ARGUMENT and isinstance(move.content, Argument):
        play = replace(play, argument=move.content)
    agents = _after(agents, rulebook.locution(move.locution, move.content, reply.slot), side, move, at)
    after = reply.leads_to(is_last=reply.last is not None and is_last_support(play, agents))
    if (
        rulebook.makes_claim(move)
        and reply.slot in {Slot.TOPIC, Slot.OPPOSITE}
        and isinstance(move.content, Literal | Rule)
    ):
        play = replace(play, claim=move.content, defender=side, offered=(), argument=None)
    end = play.game.end_of(after)
    utterances = [GameUtterance(play.number, play.parent, len(play.moves), side, move, before, after)]
    play = replace(play, moves=(*play.moves, (side, move)), stage=before if end else after, end=end)
    play = replace(play, resumes=reply.questioned if end else None, put_off=None)
    booked = _follows(play, reply)
    if booked is not None:
        agents = _after(agents, rulebook.locution(booked.locution, booked.content), side, booked, at)
        utterances.append(GameUtterance(play.number, play.parent, len(play.moves), side, booked, after, after, True))
        play = replace(play, moves=(*play.moves, (side, booked)))
    return play, agents, tuple(utterances)


def _follows(play: GamePlay, reply: Reply) -> DialogueMove | None:
    """Return the acceptance of the claim, which follows when the last part of the claim's support is accepted."""
    if play.end is DialogueEnd.AGREEMENT and reply.slot is Slot.SUPPORT and play.claim is not None:
        return DialogueMove(reply.locution, play.claim)
    return None


def _after(agents: Agents, locution: Locution | None, side: Side, move: DialogueMove, at: float) -> Agents:
    if locution is None:
        return agents
    speaker, listener = after_saying(locution, agents[side], agents[other_side(side)], move, at)
    return {side: speaker, other_side(side): listener}


def _contents(play: GamePlay, slot: Slot, agents: Agents) -> Iterable[Content]:
    """Return the contents for a slot of the present state, most important first."""
    match slot:
        case Slot.TOPIC:
            return (play.topic,)
        case Slot.OPPOSITE:
            return () if isinstance(play.topic, Rule) else (opposite(play.topic),)
        case Slot.UNKNOWN:
            return () if isinstance(play.topic, Rule) else (Unknown(play.topic.proposition),)
        case Slot.CLAIM:
            return () if play.claim is None else (play.claim,)
        case Slot.ARGUMENT:
            return () if play.offered else tuple(dict.fromkeys(argument for argument, _ in _cases_made(play, agents)))
        case Slot.SUPPORT if play.speaker is play.defender:
            return tuple(dict.fromkeys(support for _, due in _cases_made(play, agents) for support in due))
        case Slot.SUPPORT:
            return play.offered[-1:]


def _cases_made(play: GamePlay, agents: Agents) -> list[tuple[Argument, tuple[Belief, ...]]]:
    """Return the arguments for the claim that contain the offered support, each with its missing beliefs.

    Beliefs are missing if the listener is assumed not to hold them. They can belong to the argument, or to arguments
    for the parts of its conclusion. The claim itself, on which an observation rests, has already been stated.
    """
    if play.claim is None or play.defender is None:
        return []
    defender = agents[play.defender]
    made = []
    for argument in _arguments(defender, play.claim):
        if play.argument not in {None, argument}:
            continue
        whole = _with_parts(defender, argument)
        if all(support in whole for support in play.offered):
            said = {*play.offered, play.claim}
            due = tuple(each for each in whole if each not in said and each not in defender.picture)
            made.append((argument, due))
    return made


def _arguments(defender: Agent, claim: Belief) -> tuple[Argument, ...]:
    found = defender.beliefs.arguments(claim)
    # The argument on the best evidence comes first; a program puts forward its support.
    prefers = defender.beliefs.prefers
    return tuple(sorted(found, key=lambda one: (sum(prefers(other, one) for other in found), str(one))))  # of integers


def _with_parts(defender: Agent, argument: Argument) -> tuple[Belief, ...]:
    """Return the support of an argument, and the support of one argument for each part of its conclusion.

    The order is that of the defender's beliefs.
    """
    supports = set(argument.support)
    if isinstance(argument.conclusion, Literal) and len(parts := argument.conclusion.parts) > 1:
        for part in parts:
            supports |= next((each.support for each in defender.beliefs.arguments(part)), frozenset())
    ordered: tuple[Belief, ...] = (*defender.beliefs.origins, *defender.beliefs.rules)
    return tuple(each for each in ordered if each in supports)
