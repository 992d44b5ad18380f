"""Contents of moves in dialogue games: literals, rules, arguments, and "I do not know"."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Self, TypeAlias

from thbridge.dialogue.argumentation.arguments import Argument, Belief
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule


@dataclass(frozen=True, slots=True)
class Unknown:
    """The speaker does not know whether a proposition holds; U in Sklar and Azhar (2015)."""

    proposition: Proposition

    def __str__(self) -> str:
        return f"U({self.proposition})"


Content: TypeAlias = Literal | Rule | Argument | Unknown


class TableWord(StrEnum):
    """Word in files of dialogue games, with its meaning for the authors of these files."""

    meaning: str

    def __new__(cls, word: str, meaning: str = "") -> Self:
        """Make a word with its meaning."""
        made = str.__new__(cls, word)
        made._value_ = word
        made.meaning = meaning
        return made


class ContentKind(TableWord):
    """Kind of a content; files use it to distinguish the forms of a locution."""

    LITERAL = "literal", "a proposition, or its negation"
    RULE = "rule", "a conclusion that follows from premises"
    ARGUMENT = "argument", "a conclusion with its support"
    UNKNOWN = "unknown", "the statement that the speaker knows nothing about a proposition"


def kind_of_content(content: Content) -> ContentKind:
    """Return the kind of a content."""
    match content:
        case Literal():
            return ContentKind.LITERAL
        case Rule():
            return ContentKind.RULE
        case Argument():
            return ContentKind.ARGUMENT
        case Unknown():
            return ContentKind.UNKNOWN


@dataclass(frozen=True, slots=True)
class DialogueMove:
    """A locution with its content, written as in the paper: `assert(selected(Room3))`.

    Attributes:
        locution: name in the file of locutions.
        content: its content.
    """

    locution: str
    content: Content

    def __str__(self) -> str:
        text = str(self.content)
        # The texts of arguments and of `Unknown` already have brackets.
        return f"{self.locution}{text}" if isinstance(self.content, Argument) else f"{self.locution}({text})"


def propositions_in(content: Content) -> frozenset[Proposition]:
    """Return the propositions in a content; for conjunctions, the propositions of their parts."""
    match content:
        case Unknown(proposition):
            return frozenset(part.proposition for part in proposition.parts)
        case Literal():
            return frozenset(part.proposition for part in content.parts)
        case Rule(premises, conclusion):
            return frozenset().union(*map(propositions_in, (*premises, conclusion)))
        case Argument(support, conclusion):
            return frozenset().union(*map(propositions_in, (*support, conclusion)))


def matter_of(topic: Belief) -> Proposition:
    """Return the proposition that a topic affirms or denies; for a rule, the proposition of its conclusion."""
    return (topic.conclusion if isinstance(topic, Rule) else topic).proposition


def opposite(content: Belief) -> Belief:
    """Return the opposite of a literal. Raises ValueError for a rule, because rules have no opposite."""
    if isinstance(content, Rule):
        raise ValueError(f"a rule has no opposite: {content}")
    return ~content
