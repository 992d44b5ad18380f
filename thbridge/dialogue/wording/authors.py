"""Other authors of sentences: programs that word moves. Each sentence is compared with the files' own sentence.

A sentence is accepted if it contains the same values in the same order, the same negations, and no other values. So
robots and people never say anything that they do not believe. A sentence that cannot be checked is refused and replaced
by the sentence from the files.
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
"""Maximum number of characters that are kept of a refused sentence."""
_DENIED = "not"
_BREAK = ","
_BREAKS = frozenset(",;:.!…–—")
"""Characters that separate clauses: a negation before one of these characters does not apply after it."""


@dataclass(frozen=True, slots=True)
class WordedLiteral:
    """Literal of a move, for an author.

    Attributes:
        predicate: name of the predicate.
        holds: False if the literal is negated.
        values: values in words, by name.
        phrase: phrase from the files.
    """

    predicate: str
    holds: bool
    values: Mapping[str, str]
    phrase: str


@dataclass(frozen=True, slots=True)
class WordingRequest:
    """Request for a sentence.

    Attributes:
        move: the move.
        speaker: the side that speaks.
        condition: condition of the study.
        language: name of the language.
        grammar: grammar of the language.
        literals: literals of the move.
        sentence: sentence from the files, which is said if no valid sentence is offered.
        known: names, for example of rooms and treasures; an offer may contain them only if `sentence` does.
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
        """Return a sentence for a request, or None to keep the sentence from the files."""
        ...


class RefusalReason(StrEnum):
    """Reason why a sentence is refused."""

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
    """Result of a request, with all data for its recording.

    Attributes:
        request: the request.
        offered: the author's sentence; None if the author offered no sentence.
        refusal: reason why the sentence was refused; None if it was accepted, or there was no sentence.
    """

    request: WordingRequest
    offered: str | None = None
    refusal: SentenceRefusal | None = None

    @property
    def text(self) -> str:
        """The sentence to say."""
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
        wording: words from the files.
        move: the move.
        speaker: the side that speaks.
        condition: condition of the study.
        `chance`: random number that chooses the wording from the files.
        known: names that an offer may contain only if the sentence from the files does; names of rooms are always
            known.
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
    """Ask an author for a sentence, and check its offer; if the author raises an error, its offer is refused."""
    try:
        # A copy, so that the check uses the original request even if the author changes its copy.
        offered: object = author(replace(request))
        # A subclass of `str` can have methods of its own.
        said = str.__str__(offered) if isinstance(offered, str) else offered
    except RAISED as error:
        # After any error of another program, the sentence from the files is said.
        why = f"the author failed: {told_error(error)}"
        return AuthoredSentence(request, refusal=SentenceRefusal(RefusalReason.AUTHOR_FAILED, why))
    if said is None:
        return AuthoredSentence(request)
    refusal = judge_sentence(said, request)
    text = said if isinstance(said, str) else f"a {type(said).__name__}"
    return AuthoredSentence(request, text if refusal is None else text[:LONGEST_OFFERED], refusal)


def judge_sentence(sentence: object, request: WordingRequest) -> SentenceRefusal | None:
    """Return the reason why a sentence is refused for a move, or None if it is accepted.

    Its numbers, names, negations and the words that the language declares as bound must be the same as in the files'
    sentence, in the same order: `100 is less than 1000` does not mean `1000 is less than 100`. Punctuation must
    separate clauses at the same places as in the files' sentence. Other parts of the meaning are not checked.
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
    """Return the largest length, in characters, of a sentence that replaces this sentence."""
    return 2 * len(sentence) + 80


def can_be_found(listed: str) -> bool:
    """Return True if a negation or bound word of a grammar is valid: a word, or `*` followed by the end of words."""
    return _LISTED.fullmatch(listed) is not None


def _bound(text: str, request: WordingRequest) -> tuple[str, ...]:
    """Return the parts of a sentence that must not change, in order, with a break between different clauses."""
    parts: list[str] = []
    for part in _parts(text, request):
        if part == _BREAK and (not parts or parts[-1] == _BREAK):
            continue
        if part == "?" and parts and parts[-1] == _BREAK:
            parts.pop()
        parts.append(part)
    return tuple(parts[:-1] if parts and parts[-1] == _BREAK else parts)


def _parts(text: str, request: WordingRequest) -> Iterator[str]:
    """Yield numbers, names, negations, bound words, and all punctuation between clauses."""
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
    """Words in a list of a grammar; `*n't` means all words with this end."""

    def __init__(self, words: Collection[str]) -> None:
        self._words = words
        self._endings = tuple(word.removeprefix("*") for word in words if word.startswith("*"))

    def __contains__(self, word: str) -> bool:
        return word in self._words or (bool(self._endings) and word.endswith(self._endings))


def _stands_at(name: str, text: str, at: int) -> bool:
    """Return True if a name occurs as whole words at a position of a text."""
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
    """Yield the names in a literal, in the words of the language."""
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
