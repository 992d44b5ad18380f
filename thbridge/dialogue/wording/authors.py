"""Other authors of sentences: programs that word moves, each sentence judged against the one of the language's files.

A sentence is taken if it says the same values in the same order, denies what is denied, and says no other value. So
robots and people never hear what nobody believes; what cannot be judged is refused, and the files' sentence is said.
"""

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Protocol

from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.contents import Content, DialogueMove, Unknown
from thbridge.dialogue.other_programs import RAISED, told_error
from thbridge.dialogue.wording.language import Grammar
from thbridge.dialogue.wording.predicates import ValueKind, predicate_of
from thbridge.dialogue.wording.wording import Wording, reasons

_WORD = r"\w+(?:['’]\w+)*"
_TOKEN = re.compile(rf"\d+(?:[.,]\d+)*\w*|-(?=\s*\d)|[+−*/%=<>≤≥×÷±?‰°$€£]|[,;:.!…–—]|{_WORD}")
_LISTED = re.compile(rf"\*?{_WORD}")
LONGEST_OFFERED = 2000
"""Characters that are kept of a sentence that is not taken."""
_DENIED = "not"
_BREAK = ","
_BREAKS = frozenset(",;:.!…–—")
"""Signs that part clauses: what is denied before one is not what is denied after it."""


@dataclass(frozen=True, slots=True)
class WordedLiteral:
    """Literal that a move speaks of, as an author reads it.

    Attributes:
        predicate: its name.
        holds: False where it is denied.
        values: as they are said, by name.
        phrase: of the files.
    """

    predicate: str
    holds: bool
    values: Mapping[str, str]
    phrase: str


@dataclass(frozen=True, slots=True)
class WordingRequest:
    """Request for a sentence.

    Attributes:
        move: what is said.
        speaker: who says it.
        condition: of the study.
        language: name of the language.
        grammar: of the language.
        literals: that the move speaks of.
        sentence: of the files, which is said where nothing better is offered.
        known: names of rooms, treasures and the like, which a sentence may name only where that of the files does.
    """

    move: DialogueMove
    speaker: Side
    condition: DialogueCondition | None
    language: str
    grammar: Grammar = field(repr=False)
    literals: tuple[WordedLiteral, ...]
    sentence: str
    known: frozenset[str] = frozenset()


class WordingAuthor(Protocol):
    """Author of sentences: a function."""

    def __call__(self, request: WordingRequest, /) -> str | None:
        """Return a sentence for a request, or None where there is no better one than that of the files."""
        ...


class RefusalReason(StrEnum):
    """Reason for which a sentence is not taken."""

    AUTHOR_FAILED = "author-failed"
    NO_TEXT = "no-text"
    NOT_PRINTABLE = "not-printable"
    TOO_LONG = "too-long"
    OTHER_VALUES = "other-values"


@dataclass(frozen=True, slots=True)
class SentenceRefusal:
    """Refusal of a sentence: a reason for programs, a sentence for people."""

    reason: RefusalReason
    why: str


@dataclass(frozen=True, slots=True)
class AuthoredSentence:
    """Outcome of a request: all that is needed to record it.

    Attributes:
        request: what was asked.
        offered: the author's sentence; None where it offered none.
        refusal: why that was not taken; None where it was, or where none was offered.
    """

    request: WordingRequest
    offered: str | None = None
    refusal: SentenceRefusal | None = None

    @property
    def text(self) -> str:
        """The sentence to be said."""
        return self.request.sentence if self.offered is None or self.refusal is not None else self.offered


def request_of(
    wording: Wording,
    move: DialogueMove,
    speaker: Side = Side.ROBOT,
    *,
    condition: DialogueCondition | None = None,
    chance: float = 0.0,
    known: Collection[str] = (),
) -> WordingRequest:
    """Return the request for the sentence of a move.

    Args:
        wording: words of the files.
        move: what is said.
        speaker: who says it.
        condition: of the study.
        chance: chooses the wording of the files.
        known: names that may not be said where the files' sentence does not; those of rooms are known in any case.
    """
    literals = tuple(_literals_in(move.content))
    names = {*known, *wording.names.named.values(), *(name for each in literals for name in _names_in(wording, each))}
    return WordingRequest(
        move,
        speaker,
        condition,
        wording.language.name,
        wording.language.grammar,
        tuple(_worded(wording, each, speaker, chance) for each in literals),
        wording.sentence(move, speaker, condition=condition, chance=chance),
        frozenset(names),
    )


def ask_author(author: WordingAuthor, request: WordingRequest) -> AuthoredSentence:
    """Ask an author for a sentence, and judge what it offers; an author that raises an error is refused."""
    try:
        # A copy, so that it is judged by what was asked whatever becomes of that.
        offered: object = author(replace(request))
        # A text may come with methods of its own.
        said = str.__str__(offered) if isinstance(offered, str) else offered
    except RAISED as error:
        # Whatever a program of others does, the sentence of the files is said.
        why = f"the author failed: {told_error(error)}"
        return AuthoredSentence(request, refusal=SentenceRefusal(RefusalReason.AUTHOR_FAILED, why))
    if said is None:
        return AuthoredSentence(request)
    refusal = judge_sentence(said, request)
    text = said if isinstance(said, str) else f"a {type(said).__name__}"
    return AuthoredSentence(request, text if refusal is None else text[:LONGEST_OFFERED], refusal)


def judge_sentence(sentence: object, request: WordingRequest) -> SentenceRefusal | None:
    """Return why a sentence is not taken for a move, or None when it is.

    Its numbers, names, negations and the words that the language declares as bound have to be those of the files'
    sentence, in the same order: `100 is less than 1000` is not `1000 is less than 100`. Clauses have to be parted by
    signs where theirs are. Beyond these, meaning is not judged.
    """
    if not isinstance(sentence, str):
        return SentenceRefusal(RefusalReason.NO_TEXT, f"it is no text: a {type(sentence).__name__}")
    if not sentence.strip():
        return SentenceRefusal(RefusalReason.NO_TEXT, "it is an empty text")
    if not sentence.isprintable():
        return SentenceRefusal(RefusalReason.NOT_PRINTABLE, "it has line breaks, or other signs that cannot be printed")
    longest = longest_sentence(request.sentence)
    if len(sentence) > longest:
        return SentenceRefusal(RefusalReason.TOO_LONG, f"it has {len(sentence)} characters, and may have {longest}")
    wanted, offered = (_bound(text, request) for text in (request.sentence, sentence))
    if wanted != offered:
        why = f"it has to say, in this order: {' '.join(wanted)}; it says: {' '.join(offered) or 'nothing of it'}"
        return SentenceRefusal(RefusalReason.OTHER_VALUES, why)
    return None


def longest_sentence(sentence: str) -> int:
    """Return the greatest length that a sentence in place of another may have, in characters."""
    return 2 * len(sentence) + 80


def can_be_found(listed: str) -> bool:
    """Return True for what a grammar's negations and bound words may be: one word, or `*` and the end of words."""
    return _LISTED.fullmatch(listed) is not None


def _bound(text: str, request: WordingRequest) -> tuple[str, ...]:
    """The parts of a sentence that may not change, in order, with a break between those of different clauses."""
    parts: list[str] = []
    for part in _parts(text, request):
        if part == _BREAK and (not parts or parts[-1] == _BREAK):
            continue
        if part == "?" and parts and parts[-1] == _BREAK:
            parts.pop()
        parts.append(part)
    return tuple(parts[:-1] if parts and parts[-1] == _BREAK else parts)


def _parts(text: str, request: WordingRequest) -> Iterator[str]:
    """Numbers, names, negations, words that are bound, and all signs between clauses."""
    grammar, folded = request.grammar, text.casefold()
    names = sorted({name.casefold() for name in request.known}, key=lambda name: (-len(name), name))
    negations, bound = _Listed(grammar.negations), _Listed(grammar.bound)
    at = 0
    while at < len(folded):
        name = next((each for each in names if _stands_at(each, folded, at)), None)
        found = _TOKEN.match(folded, at)
        if name is not None:
            yield name
            at += len(name)
        elif found is not None:
            word = found.group().replace("’", "'")
            if word in _BREAKS:
                yield _BREAK
            elif word in negations:
                yield _DENIED
            elif word in bound or not word[0].isalpha() or any(map(str.isnumeric, word)):
                yield word
            at = found.end()
        else:
            at += 1


class _Listed:
    """Words that a grammar lists: `*n't` stands for all that end so."""

    def __init__(self, words: Collection[str]) -> None:
        self._words = words
        self._endings = tuple(word.removeprefix("*") for word in words if word.startswith("*"))

    def __contains__(self, word: str) -> bool:
        return word in self._words or (bool(self._endings) and word.endswith(self._endings))


def _stands_at(name: str, text: str, at: int) -> bool:
    """True when a name stands as whole words at a place of a text."""
    end = at + len(name)
    starts = at == 0 or not (text[at - 1].isalnum() and name[0].isalnum())
    ends = end >= len(text) or not (text[end].isalnum() and name[-1].isalnum())
    return bool(name) and text.startswith(name, at) and starts and ends


def _worded(wording: Wording, literal: Literal, speaker: Side, chance: float) -> WordedLiteral:
    predicate = predicate_of(literal.proposition)
    return WordedLiteral(
        "" if predicate is None else predicate.name,
        literal.holds,
        wording.values(literal.proposition, speaker),
        wording.phrase(literal, speaker, chance=chance),
    )


def _names_in(wording: Wording, literal: Literal) -> Iterator[str]:
    """The names that a literal speaks of, as the language says them."""
    predicate = predicate_of(literal.proposition)
    for field_name, kind in () if predicate is None else predicate.values.items():
        value = getattr(literal.proposition, field_name)
        match kind:
            case ValueKind.NAME | ValueKind.PICTURE:
                yield wording.language.grammar.name(value)
            case ValueKind.NAMES:
                yield from map(wording.language.grammar.name, value)
            case ValueKind.CLAUSE:
                for part in value.parts:
                    yield from _names_in(wording, part)
            case _:
                pass


def _literals_in(content: Content) -> Iterator[Literal]:
    match content:
        case Literal():
            yield from content.parts
        case Unknown(proposition):
            yield from proposition.parts
        case Rule(premises, conclusion):
            yield from (*premises, conclusion)
        case Argument(support, conclusion):
            yield from _literals_in(conclusion)
            for part in reasons(support, conclusion):
                yield from _literals_in(part)
