"""The rules of Sklar and Azhar (2015) a second time, from the paper's prose and tables and not from the engine's files.

A judge listens to a conversation, keeps books of its own on beliefs, pictures and stores, and tells which moves are
legal. Of the engine it shares the values that are talked about, and nothing that reasons on them.
"""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import product

from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.beliefs import Beliefs
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule
from thbridge.dialogue.games.agents import Picture
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown

IN_BRIEF = "-in-brief"
OPENING_WORDS = {"persuasion": "assert", "information-seeking": "question", "inquiry": "propose"}
Supports = frozenset[frozenset[Belief]]


@dataclass(frozen=True, slots=True)
class Fact(Proposition):
    """A proposition; those whose names begin with the same letter exclude each other."""

    name: str

    def excludes(self, other: Proposition) -> bool:
        return isinstance(other, Fact) and other.name[0] == self.name[0] and other != self

    def __str__(self) -> str:
        return self.name


def parts_of(literal: Literal) -> tuple[Literal, ...]:
    """A conjunction is the list of what it joins; the opposite of one denies each part."""
    return tuple(Literal(part.proposition, part.holds == literal.holds) for part in literal.proposition.parts)


def clash(one: Literal, other: Literal) -> bool:
    def two_clash(x: Literal, y: Literal) -> bool:
        if x.proposition == y.proposition:
            return x.holds != y.holds
        exclude = x.proposition.excludes(y.proposition) or y.proposition.excludes(x.proposition)
        return x.holds and y.holds and exclude

    return any(two_clash(x, y) for x in parts_of(one) for y in parts_of(other))


@cache
def supports(
    conclusion: Belief, literals: frozenset[Literal], decided: frozenset[Literal], rules: frozenset[Rule]
) -> Supports:
    """Supports of all arguments for a conclusion, by deriving everything that follows with what it rests on.

    S derives a -> b if S and a together derive b; what is granted in this way is no part of S.
    """
    granted = frozenset[Literal]()
    if isinstance(conclusion, Rule):
        granted = frozenset(part for premise in conclusion.premises for part in (premise, *parts_of(premise)))
        conclusion = conclusion.conclusion
    rests_on: dict[Literal, set[frozenset[Belief]]] = {each: {frozenset([each])} for each in literals}
    rests_on |= {each: {frozenset()} for each in granted}
    grows = True
    while grows:
        grows = False
        for rule in rules:
            known = rests_on.setdefault(rule.conclusion, set())
            for parts in product(*(tuple(rests_on.get(premise, ())) for premise in rule.premises)):
                new = frozenset[Belief]([rule]).union(*parts)
                if not any(old <= new for old in known):
                    known.add(new)
                    grows = True
    sound = {
        frozenset(each for each in whole if not isinstance(each, Rule) or each.is_said)
        for whole in rests_on.get(conclusion, ())
        # A decision needs other premises than itself.
        if not (conclusion in decided and conclusion in whole) and _is_consistent(whole | granted)
    }
    return frozenset(each for each in sound if not any(other < each for other in sound))


def _is_consistent(whole: Iterable[Belief]) -> bool:
    stated = [each.conclusion if isinstance(each, Rule) else each for each in whole]
    return not any(clash(one, other) for one in stated for other in stated)


@dataclass
class Party:
    """One side: Sigma, what it thinks of the other (Gamma), and its commitment store."""

    is_person: bool
    sigma: frozenset[Literal]
    decided: frozenset[Literal]
    """Those of Sigma that do not support themselves."""
    rules: frozenset[Rule]
    gamma: frozenset[Literal]
    gamma_rules: frozenset[Rule] = frozenset()
    gamma_unknown: frozenset[Proposition] = frozenset()
    gamma_arguments: frozenset[Argument] = frozenset()
    gamma_argued: frozenset[Belief] = frozenset()
    said: tuple[DialogueMove, ...] = ()

    @classmethod
    def of(cls, beliefs: Beliefs, picture: Picture, *, is_person: bool) -> "Party":
        decided = frozenset(each for each, origin in beliefs.origins.items() if not origin.is_evidence)
        party = cls(is_person, frozenset(beliefs.origins), decided, frozenset(beliefs.rules), picture.held)
        return replace(party, gamma_unknown=picture.unknown)

    @property
    def language(self) -> frozenset[Rule]:
        return frozenset(rule for rule in self.rules if not rule.is_said)

    def holds(self, content: Belief) -> bool:
        if isinstance(content, Rule):
            return content in self.rules
        return all(part in self.sigma for part in parts_of(content))

    def arguments(self, conclusion: Belief) -> set[Argument]:
        found = supports(conclusion, self.sigma, self.decided, self.rules)
        return {Argument(support, conclusion) for support in found}

    def is_unknown(self, proposition: Proposition) -> bool:
        """?b: neither b nor not b is held; exclusions are computed."""
        yes = Literal(proposition)
        return not self.holds(yes) and not any(clash(yes, held) for held in self.sigma)

    def attributes(self, content: Content) -> bool:
        """The content is in Gamma of the other."""
        match content:
            case Unknown(proposition):
                return proposition in self.gamma_unknown
            case Argument():
                return content in self.gamma_arguments
            case Rule():
                return content in self.gamma_rules
        return all(part in self.gamma for part in parts_of(content))

    def attributes_some_argument(self, content: Belief) -> bool:
        known = self.gamma_rules | self.language
        return content in self.gamma_argued or bool(supports(content, self.gamma, frozenset(), known))

    def attributes_opinion(self, proposition: Proposition) -> bool:
        yes = Literal(proposition)
        return self.attributes(yes) or any(clash(yes, held) for held in self.gamma)

    def has_said(self, content: Belief) -> bool:
        committing = {"assert", "propose", "accept"}
        return any(move.content == content and move.locution in committing for move in self.said)

    def believing(self, content: Belief) -> "Party":
        if isinstance(content, Rule):
            return replace(self, rules=self.rules | {content})
        gained = {content, *parts_of(content)}
        sigma = frozenset(each for each in self.sigma if not clash(each, content)) | gained
        return replace(self, sigma=sigma, decided=(self.decided & sigma) - gained)

    def attributing(self, content: Content) -> "Party":
        match content:
            case Unknown(proposition):
                yes = Literal(proposition)
                rest = frozenset(each for each in self.gamma if not clash(each, yes) and not clash(each, ~yes))
                return replace(self, gamma=rest, gamma_unknown=self.gamma_unknown | {proposition})
            case Argument():
                arguments = self.gamma_arguments | {content}
                return replace(self, gamma_arguments=arguments, gamma_argued=self.gamma_argued | {content.conclusion})
            case Rule():
                return replace(self, gamma_rules=self.gamma_rules | {content})
        rest = frozenset(each for each in self.gamma if not clash(each, content))
        unknown = frozenset(
            each
            for each in self.gamma_unknown
            if not clash(Literal(each), content) and not clash(Literal(each, holds=False), content)
        )
        return replace(self, gamma=rest | {content, *parts_of(content)}, gamma_unknown=unknown)

    def attributing_some_argument(self, content: Belief) -> "Party":
        return replace(self, gamma_argued=self.gamma_argued | {content})


@dataclass(frozen=True)
class Talk:
    """A dialogue as the judge follows it: the lines so far, from which everything else is read."""

    number: int
    game: str
    topic: Belief
    opener: Side
    parent: int | None
    lines: tuple[tuple[Side, DialogueMove], ...] = ()
    used: frozenset[DialogueMove] = frozenset()
    is_weighed: bool = False
    """An argument was announced of which nothing was left to say, or which is judged as a whole."""
    booked: int = 0
    end: str | None = None
    is_in_question: bool = False
    """It ended by a no, which has been questioned; nothing was said in it since."""
    asks_about_a_no: bool = False

    @property
    def kind(self) -> str:
        return self.game.removesuffix(IN_BRIEF)

    @property
    def claim(self) -> tuple[Side, Belief]:
        """Who defends what: the opening, unless its answer asserts something else."""
        assertions = [(side, move.content) for side, move in self.lines[:2] if move.locution in {"assert", "propose"}]
        side, content = assertions[-1]
        assert isinstance(content, Literal | Rule)
        return side, content

    @property
    def announced(self) -> Argument | None:
        return next((move.content for _, move in self.lines if isinstance(move.content, Argument)), None)

    @property
    def offered(self) -> tuple[Belief, ...]:
        """Support said so far: what the defender said since the challenge."""
        found = list[Belief]()
        if any(move.locution == "challenge" for _, move in self.lines):
            for side, move in self.lines[2:]:
                if side is self.claim[0] and isinstance(move.content, Literal | Rule):
                    found.append(move.content)
        return tuple(found)

    @property
    def refusals(self) -> int:
        return sum(move.locution == "reject" for _, move in self.lines)

    @property
    def refused(self) -> Literal | None:
        """What a no was said to that has ended the dialogue. Who has said no twice has no third name for it."""
        if self.end != "disagreement" or self.lines[-1][1].locution != "reject" or self.refusals > 1:
            return None
        support = self.offered[-1] if self.offered else None
        return support if isinstance(support, Literal) else None


def about(topic: Belief) -> Proposition:
    """A dialogue about b and one about not b are about the same; so is one about what would follow, a -> b."""
    return topic.conclusion.proposition if isinstance(topic, Rule) else topic.proposition


def rival(side: Side) -> Side:
    return {Side.ROBOT: Side.HUMAN, Side.HUMAN: Side.ROBOT}[side]


@dataclass(frozen=True)
class Judge:
    """All that the judge knows of a conversation; a value."""

    parties: dict[Side, Party]
    able: dict[Side, frozenset[Proposition]] = field(default_factory=dict)
    talks: tuple[Talk, ...] = ()
    latest: int = 0
    """The dialogue in which something was said last."""

    # --- whose turn it is, and what the protocol lets be said

    def waits(self, talk: Talk) -> bool:
        return any(each.parent == talk.number and each.end is None for each in self.talks)

    def turn(self, talk: Talk) -> Side:
        if not talk.lines:
            return talk.opener
        side, move = talk.lines[-1]
        if len(talk.lines) == 1:
            return rival(side)
        if isinstance(move.content, Argument):
            # Who announces an argument keeps the turn, unless nothing of it is left to say.
            return rival(side) if talk.is_weighed else side
        # Who said no goes on: was it a no?
        return side if talk.is_in_question else rival(side)

    def legal(self, talk: Talk) -> set[DialogueMove]:
        if talk.end is not None or self.waits(talk):
            return set()
        side = self.turn(talk)
        said = {move for who, move in talk.lines if who is side}
        return {
            move
            for move in self._protocol(talk)
            if move not in said
            and not (len(talk.lines) == 1 and move in talk.used)
            and self.may_say(side, move.locution, move.content, is_support=len(talk.lines) > 0)
        }

    def _protocol(self, talk: Talk) -> Iterator[DialogueMove]:
        topic, count = talk.topic, len(talk.lines)
        if count == 0:
            word = OPENING_WORDS[talk.kind]
            if isinstance(topic, Rule) == (talk.kind == "inquiry"):
                yield DialogueMove(word, topic)
        elif count == 1 and talk.kind == "information-seeking":
            assert isinstance(topic, Literal)
            yield DialogueMove("assert", topic)
            yield DialogueMove("assert", ~topic)
            yield DialogueMove("assert", Unknown(topic.proposition))
        elif count == 1:
            yield DialogueMove("accept", topic)
            yield DialogueMove("challenge", topic)
            if isinstance(topic, Literal):
                yield DialogueMove("assert", ~topic)
        else:
            yield from self._later(talk)

    def _later(self, talk: Talk) -> Iterator[DialogueMove]:
        last, (_, claim) = talk.lines[-1][1], talk.claim
        if talk.is_in_question or (talk.refusals and last.locution in {"assert", "propose"}):
            # Another no cannot have the name of the first: the paper's other one is reject(s).
            yield DialogueMove("accept", talk.offered[-1])
            yield DialogueMove("reject", talk.offered[-1])
            return
        support_word = "propose" if talk.kind == "inquiry" else "assert"
        if len(talk.lines) == 2 and last.locution == "assert":
            yield DialogueMove("accept", claim)
            yield DialogueMove("challenge", claim)
        elif last.locution in {"challenge", "accept"} or (isinstance(last.content, Argument) and not talk.is_weighed):
            if last.locution == "challenge" and talk.kind != "inquiry":
                for argument in self._arguments(talk):
                    yield DialogueMove("assert", argument)
            for support in {each for due in self.due(talk) for each in due}:
                yield DialogueMove(support_word, support)
        elif isinstance(last.content, Argument):
            yield DialogueMove("accept", claim)
            yield DialogueMove("reject", claim)
        else:
            yield DialogueMove("accept", last.content)
            yield DialogueMove("reject", claim)

    def _arguments(self, talk: Talk) -> set[Argument]:
        defender, claim = talk.claim
        return self.parties[defender].arguments(claim)

    def due(self, talk: Talk) -> list[set[Belief]]:
        """For each argument that may be meant: what of it is still to be said."""
        defender, claim = talk.claim
        party = self.parties[defender]
        found = []
        for argument in self._arguments(talk):
            if talk.announced not in {None, argument}:
                continue
            whole = set(argument.support)
            if isinstance(claim, Literal) and len(parts_of(claim)) > 1:
                # The support may take in that of the parts; the paper does not say which, we take the first by name.
                for part in parts_of(claim):
                    whole |= min(party.arguments(part), key=str, default=argument).support
            if set(talk.offered) <= whole:
                known = {*talk.offered, claim}
                found.append({each for each in whole if each not in known and not party.attributes(each)})
        return found

    # --- what must hold before: the paper's figure 4

    def may_say(
        self, side: Side, locution: str, content: Content, *, after_a_no: bool = False, is_support: bool = False
    ) -> bool:
        i, j = self.parties[side], self.parties[rival(side)]
        if after_a_no and isinstance(content, Literal):
            # It takes j to have an opinion on what j has refused, unless it has learnt that j knows nothing of it.
            return i.is_person or content.proposition not in i.gamma_unknown
        if i.is_person:
            # Nobody reads what she believes: only what she has shown counts.
            if locution == "question" or isinstance(content, Unknown):
                assert isinstance(content, Literal | Unknown)
                return not j.attributes_opinion(content.proposition)
            return True
        match locution, content:
            case "assert", Unknown(proposition):
                return i.is_unknown(proposition)
            case "assert", Argument(_, b):
                return i.holds(b) and content in i.arguments(b) and not i.attributes(b) and not i.attributes(content)
            case (("assert" | "propose"), Literal()):
                return i.holds(content) and bool(i.arguments(content)) and not i.attributes(content)
            case (("assert" | "propose"), Rule()) if is_support or locution == "assert":
                return i.holds(content) and bool(i.arguments(content)) and not i.attributes(content)
            case "propose", Rule(premises, b):
                # a is in Sigma; the rule need not be, if it can be supported.
                is_open = not i.holds(b) and not i.attributes(b)
                return bool(i.arguments(content)) and all(i.holds(a) for a in premises) and is_open
            case "question", Literal(proposition):
                learnt = proposition in i.gamma_unknown
                tells = i.attributes_opinion(proposition) or proposition in self.able.get(rival(side), ())
                return i.is_unknown(proposition) and tells and not learnt
            case "challenge", (Literal() | Rule()):
                return j.has_said(content) and not i.holds(content) and i.attributes_some_argument(content)
            case "accept", Literal():
                return j.has_said(content) and i.attributes(content) and i.attributes_some_argument(content)
            case "accept", Rule():
                return j.has_said(content) and i.attributes_some_argument(content)
            case "reject", (Literal() | Rule()):
                return j.has_said(content) and not i.holds(content) and not i.arguments(content)
        raise AssertionError((locution, content))

    # --- what holds after

    def after(self, number: int, move: DialogueMove) -> "Judge":
        talk = self.talks[number - 1]
        side = self.turn(talk)
        now = self._spoken(replace(talk, is_in_question=False), side, move)
        talk = now.talks[number - 1]
        match move.locution, move.content:
            case "reject", _:
                now = now._with(replace(talk, end="disagreement"))
            case "assert", Unknown():
                now = now._with(replace(talk, end="unknown"))
            case "assert", Argument():
                now = now._with(replace(talk, is_weighed=talk.game.endswith(IN_BRIEF) or not all(now.due(talk))))
            case "accept", content if content == talk.claim[1]:
                now = now._with(replace(talk, end="agreement"))
            # The last element accepted implies the claim.
            case "accept", _ if not all(now.due(talk)):
                now = now._spoken(talk, side, DialogueMove("accept", talk.claim[1]))
                now = now._with(replace(now.talks[number - 1], end="agreement", booked=1))
        talk = now.talks[number - 1]
        if talk.end == "agreement" and talk.asks_about_a_no and talk.claim[1] == talk.topic and talk.parent is not None:
            # The questioner gave up its own support, so that the claim of the outer dialogue has lost it.
            now = now._with(now._stopped(now.talks[talk.parent - 1], "disagreement"))
        return now.settled()

    def settled(self) -> "Judge":
        """Where no legal move is left, there is a stalemate; what waits for it goes on, or is stuck in turn."""
        for talk in self.talks:
            if talk.end is None and not self.waits(talk) and not self.legal(talk):
                return self._with(self._stopped(talk, "stalemate")).settled()
        return self

    def _stopped(self, talk: Talk, end: str) -> Talk:
        """A no that was questioned, and is followed by nothing, has been a no."""
        return replace(talk, end="disagreement" if talk.is_in_question else end)

    def _spoken(self, talk: Talk, side: Side, move: DialogueMove) -> "Judge":
        i, j = self.parties[side], self.parties[rival(side)]
        i = replace(i, said=(*i.said, move))
        content = move.content
        match move.locution, content:
            case "accept", Rule(premises, conclusion):
                # Both know the rule now, and who holds its premises draws the conclusion.
                i, j = i.believing(content).attributing(content), j.believing(content).attributing(content)
                i = i.attributing(conclusion) if all(map(i.attributes, premises)) else i
                j = j.attributing(conclusion) if all(map(j.attributes, premises)) else j
                i = i.believing(conclusion) if all(map(i.holds, premises)) else i
                j = j.believing(conclusion) if all(map(j.holds, premises)) else j
            case "accept", Literal():
                i = i if i.holds(content) else i.believing(content)
                j = j.attributing(content)
            case "propose", Rule(premises) if not talk.lines:
                # Who opens with it holds its premises, by the locution's first condition.
                for premise in premises:
                    j = j.attributing(premise)
                j = j.attributing_some_argument(content)
            case (("assert" | "propose"), (Literal() | Rule())):
                j = j.attributing(content).attributing_some_argument(content)
            case "assert", _:
                j = j.attributing(content)
        parties = {side: i, rival(side): j}
        now = replace(self, parties=parties, latest=talk.number)
        return now._with(replace(talk, lines=(*talk.lines, (side, move))))

    # --- opening

    def fresh(self, side: Side, game: str, topic: Belief, parent: int | None) -> Talk | None:
        """The dialogue before its opening, or None where it may not be opened."""
        # Protocols name all replies about b: none may be made up for by another dialogue about b, or not b.
        if any(talk.end is None and about(talk.topic) == about(topic) for talk in self.talks):
            return None
        asks = parent is not None and self._may_question(side, game, topic, parent)
        if parent is not None and not asks:
            outer = self.talks[parent - 1]
            if outer.end is not None or self.waits(outer) or self.turn(outer) is not side:
                return None
        failed = [
            talk
            for talk in self.talks
            if (talk.kind, talk.topic, talk.opener) == (game.removesuffix(IN_BRIEF), topic, side)
            and talk.end not in {None, "agreement", "withdrawn"}
            and not game.startswith("information-seeking")
        ]
        used = frozenset(talk.lines[1][1] for talk in failed if len(talk.lines) > 1)
        talk = Talk(len(self.talks) + 1, game, topic, side, parent, used=used, asks_about_a_no=asks)
        (move,) = self._protocol(talk) if list(self._protocol(talk)) else (None,)
        if move is None or not self.may_say(side, move.locution, move.content, after_a_no=asks):
            return None
        # Nothing is said twice in a dialogue, whatever is embedded in it.
        if any(each.parent == parent and each.lines[0] == (side, move) for each in self.talks if parent is not None):
            return None
        spoken = self._with(talk)._spoken(talk, side, move)
        return talk if not (used or asks) or spoken.legal(spoken.talks[-1]) else None

    def _may_question(self, side: Side, game: str, topic: Belief, parent: int) -> bool:
        """The other has just said no to a support of this side, which asks whether its opposite holds."""
        outer = self.talks[parent - 1]
        if outer.refused is None or self.latest != parent or outer.claim[0] is not side:
            return False
        waiting = outer.parent is not None and self.talks[outer.parent - 1].end is not None
        return game.startswith("information-seeking") and topic == ~outer.refused and not waiting

    def opened(self, talk: Talk) -> "Judge":
        (move,) = self._protocol(talk)
        now = self._with(talk)
        if talk.asks_about_a_no and talk.parent is not None:
            now = now._with(replace(self.talks[talk.parent - 1], end=None, is_in_question=True))
        return now.after(talk.number, move)

    def withdrawn(self, number: int) -> "Judge":
        """The judge after a dialogue, and all inside it, was given up."""
        now = self._with(self._stopped(self.talks[number - 1], "withdrawn"))
        for inner in self.talks:
            if inner.parent == number and inner.end is None:
                now = now.withdrawn(inner.number)
        return now

    def _with(self, talk: Talk) -> "Judge":
        return replace(self, talks=(*self.talks[: talk.number - 1], talk, *self.talks[talk.number :]))


def case(robot: Party, proposition: Proposition) -> tuple[str, Collection[Side]]:
    """Kind of dialogue and who may open it, from the paper's table of nine."""

    def opinion(held: frozenset[Literal]) -> bool | None:
        yes = Literal(proposition)
        for_it, against = all(part in held for part in parts_of(yes)), any(clash(yes, each) for each in held)
        return None if for_it == against else for_it

    mine, hers = opinion(robot.sigma), opinion(robot.gamma)
    if mine is None and hers is None:
        return "inquiry", set(Side)
    if mine is None:
        return "information-seeking", {Side.ROBOT}
    if hers is None:
        return "information-seeking", {Side.HUMAN}
    return ("agreement", set()) if mine == hers else ("persuasion", set(Side))
