"""Sentences of `thbridge argue`: why an argument is in an extension or not, and the discussion of an argument."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from thbridge.dialogue.argumentation.discussion import Discussion, DiscussionLocution, is_won
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import (
    IN,
    OUT,
    UNDECIDED,
    Extension,
    Semantics,
    grounded_labels,
    grounded_steps,
)

_KINDS = {
    Semantics.GROUNDED: "grounded",
    Semantics.COMPLETE: "complete",
    Semantics.PREFERRED: "preferred",
    Semantics.STABLE: "stable",
}
_LABELS = {IN: "in", OUT: "out", UNDECIDED: "undecided"}
_MANY = 8
"""Maximum number of arguments in a list within a sentence."""


def name_order(name: str) -> tuple[bool, int, str]:
    """Return a sort key for names: numbers by their value, then all other names by their letters."""
    is_number = name.isdecimal()
    return not is_number, len(name) if is_number else 0, name


def grounded_label(framework: ArgumentationFramework, name: str) -> str:
    """Return the label of an argument in the grounded labeling: in, out or undecided."""
    return _LABELS[grounded_labels(framework)[framework.index[name]]]


def membership_in_words(
    framework: ArgumentationFramework, semantics: Semantics, found: Sequence[Extension], name: str
) -> Iterator[str]:
    """Yield sentences about why an argument is in one of the given extensions, and not in another one."""
    for is_in in (True, False):
        extension = next((each for each in found if (name in each) == is_in), None)
        if extension is not None:
            which = f" {{{', '.join(_few(sorted(extension, key=name_order)))}}}" if len(found) > 1 else ""
            reason = _reason_in_words(framework, extension, name)
            yield f"{name} is {'' if is_in else 'not '}in the {_KINDS[semantics]} extension{which}: {reason}."


def _reason_in_words(framework: ArgumentationFramework, extension: Extension, name: str) -> str:
    steps, attackers = grounded_steps(framework), _attackers(framework, name)

    def answer_to(target: str) -> str | None:
        # An argument that became grounded first does not need the argument that it defends.
        those = [each for each in _attackers(framework, target) if each in extension]
        ranks = [(steps[framework.index[each]] is None, steps[framework.index[each]] or 0) for each in those]
        return those[ranks.index(min(ranks))] if those else None

    answers = {each: answer_to(each) for each in attackers}
    if name in extension:
        match list(answers.items()):
            case []:
                return "nothing attacks it"
            case [(attacker, answer)]:
                return f"{attacker} attacks it, but {answer} attacks {attacker}"
            case several:
                answered = ", ".join(_few([f"{attacker} by {answer}" for attacker, answer in several]))
                return f"each of its attackers is attacked ({answered})"
    against = answer_to(name)
    if against is not None:
        return f"{against} attacks it, and is in the extension"
    if name in attackers:
        return "it attacks itself. Nothing in the extension attacks it, so it is undecided"
    undecided = next(each for each, answer in answers.items() if answer is None)
    return f"{undecided} attacks it. Nothing in the extension attacks {undecided} or {name}, so both are undecided"


def discussion_in_words(framework: ArgumentationFramework, discussion: Discussion) -> Iterator[str]:
    """Yield the lines of a discussion that `discuss` returned, and the winner."""
    name = discussion[0].argument
    brought_in: list[str] = []
    claims: list[str] = []
    conceded: set[str] = set()
    for move in discussion:
        about = move.argument
        match move.locution:
            case DiscussionLocution.HAS_TO_BE:
                against = f"attacks {_target(about, brought_in[-1])}, and " if claims else ""
                yield f"Proponent: {about} {against}must be accepted."
                brought_in.append(about)
                claims.append(about)
            case DiscussionLocution.CAN_BE:
                while claims[-1] in conceded:
                    claims.pop()
                yield f"Opponent:  But {about} attacks {_target(about, claims[-1])}."
                brought_in.append(about)
            case DiscussionLocution.CONCEDE:
                why = "I have taken back every attacker of" if _attackers(framework, about) else "Nothing attacks"
                yield f"Opponent:  {why} {about}. I concede {about}."
                conceded.add(about)
            case DiscussionLocution.RETRACT:
                answer = next(each for each in _attackers(framework, about) if each in conceded)
                yield f"Opponent:  {answer} attacks {about}. I take {about} back."
    if is_won(discussion):
        yield f"The proponent wins: {name} must be accepted."
        return
    last = brought_in.pop()
    if last not in brought_in:
        yield f"Proponent: Nothing attacks {last}. I have no answer."
        yield f"The opponent wins: {name} must be rejected."
        return
    circle = [last, *reversed(brought_in[brought_in.index(last) :])]
    attacks = [f"{attacker} attacks {target}" for attacker, target in pairwise(circle)]
    if len(attacks) == 1:
        yield "An argument that attacks itself cannot be accepted."
    else:
        yield f"These attacks form a cycle, so they decide nothing: {', '.join(_few(attacks))}."
    yield f"The opponent wins: {name} need not be accepted, and need not be rejected."


def _target(attacker: str, target: str) -> str:
    return "itself" if attacker == target else target


def _attackers(framework: ArgumentationFramework, name: str) -> list[str]:
    return [framework.arguments[place] for place in framework.attackers[framework.index[name]]]


def _few(words: Sequence[str]) -> list[str]:
    return list(words) if len(words) <= _MANY else [*words[: _MANY - 1], f"and {len(words) - _MANY + 1} more"]
