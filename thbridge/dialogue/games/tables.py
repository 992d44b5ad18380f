"""Dialogue games as transition tables: who may say what in which state, and how a game ends."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from thbridge.dialogue.games.contents import Content, ContentKind, DialogueMove, TableWord, kind_of_content
from thbridge.dialogue.games.locutions import Locution


class Slot(TableWord):
    """Place in a table for what is said there."""

    TOPIC = "topic", "what the game is about"
    OPPOSITE = "not topic", "the opposite of that"
    CLAIM = "claim", "what was asserted or proposed last, and is being defended"
    SUPPORT = "support", "the next part of an argument for the claim that the listener is not taken to hold"
    ARGUMENT = "argument", "the argument for the claim as a whole"
    UNKNOWN = "unknown", "not to know about the topic"


class GameRole(TableWord):
    """Role in a game, by which a table says whose turn it is."""

    INITIATOR = "initiator", "the one who opened the game"
    RESPONDENT = "respondent", "the other one"
    DEFENDER = "defender", "the one who made the claim"
    CHALLENGER = "challenger", "the one who did not"


class DialogueEnd(TableWord):
    """End of a dialogue game."""

    AGREEMENT = "agreement", "one side has accepted the other's claim"
    DISAGREEMENT = "disagreement", "something was rejected"
    UNKNOWN = "unknown", "the one who was asked does not know"
    STALEMATE = "stalemate", "there is no legal move left; every game may end so"
    WITHDRAWN = "withdrawn", "what it was about is past"


@dataclass(frozen=True, slots=True)
class Reply:
    """Legal move of a state.

    Attributes:
        locution: its name.
        slot: what it is about.
        next: name of the state, or the end, that follows.
        last: the same when no support is left that the listener does not have; None: as `next`.
        questioned: of a refusal of support, which ends the game, name of the state in which it goes on instead when
            the defender questions that; None: nobody may.
    """

    locution: str
    slot: Slot
    next: str
    last: str | None = None
    questioned: str | None = None

    def leads_to(self, *, is_last: bool) -> str:
        """Return the name of the state, or of the end, that follows."""
        return self.last if is_last and self.last is not None else self.next

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of all states and ends that may follow."""
        return tuple(target for target in (self.next, self.last, self.questioned) if target is not None)


@dataclass(frozen=True, slots=True)
class GameStage:
    """State of a game: whose turn it is, and the replies, most agreeable first."""

    turn: GameRole
    replies: tuple[Reply, ...]


@dataclass(frozen=True, slots=True)
class GameTable:
    """Dialogue game.

    Attributes:
        name: of the game.
        about: a literal, that is a proposition that holds or does not, or a rule.
        opening: name of the first state, in which the initiator says one thing about the topic.
        stages: by name.
        most_turns: number of moves after which no further one is legal.
    """

    name: str
    about: Literal["literal", "rule"]
    opening: str
    stages: Mapping[str, GameStage]
    most_turns: int = 60

    def end_of(self, target: str) -> DialogueEnd | None:
        """Return the end of this name, or None for the name of a state."""
        return None if target in self.stages else DialogueEnd(target)


@dataclass(frozen=True)
class Rulebook:
    """Locutions and the games played with them.

    Attributes:
        locutions: each form of each.
        games: by name.
    """

    locutions: tuple[Locution, ...]
    games: Mapping[str, GameTable]

    @cached_property
    def _forms(self) -> Mapping[tuple[str, ContentKind, str | None], Locution]:
        return {(each.name, each.content, each.of): each for each in self.locutions}

    def locution(self, name: str, content: Content, slot: Slot | None = None) -> Locution | None:
        """Return the form of a locution for a content in a slot, or None when it has none."""
        kind = kind_of_content(content)
        return self._forms.get((name, kind, slot)) or self._forms.get((name, kind, None))

    def makes_claim(self, move: DialogueMove) -> bool:
        """Return True for a move whose content its speaker has to defend."""
        locution = self.locution(move.locution, move.content)
        return locution is not None and locution.makes_claim

    @cached_property
    def committing(self) -> frozenset[str]:
        """Names of the locutions by which their speaker shows to hold the content."""
        return frozenset(each.name for each in self.locutions if {"shown", "concluded"} & set(each.after))
