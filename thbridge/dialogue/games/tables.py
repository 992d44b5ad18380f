"""Dialogue games as transition tables: the possible replies of each state, and the ends of a game."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from thbridge.dialogue.games.contents import Content, ContentKind, DialogueMove, TableWord, kind_of_content
from thbridge.dialogue.games.locutions import Locution


class Slot(TableWord):
    """Place in a table for the content of a reply."""

    TOPIC = "topic", "the topic of the game"
    OPPOSITE = "not topic", "the opposite of the topic"
    CLAIM = "claim", "the last assertion or proposal, which is being defended"
    SUPPORT = (
        "support",
        "the next part of an argument for the claim; parts that the listener already believes are omitted",
    )
    ARGUMENT = "argument", "the argument for the claim as a whole"
    UNKNOWN = "unknown", "the statement that the speaker knows nothing about the topic"


class GameRole(TableWord):
    """Role in a game; a table gives the turn to a role."""

    INITIATOR = "initiator", "the side that opened the game"
    RESPONDENT = "respondent", "the other side"
    DEFENDER = "defender", "the side that made the claim"
    CHALLENGER = "challenger", "the side that did not make the claim"


class DialogueEnd(TableWord):
    """End of a dialogue game."""

    AGREEMENT = "agreement", "one side has accepted the other side's claim"
    DISAGREEMENT = "disagreement", "a content was rejected"
    UNKNOWN = "unknown", "the side that was asked does not know"
    STALEMATE = "stalemate", "no legal move is left; every game can end in this way"
    WITHDRAWN = "withdrawn", "the situation of the game is over"


@dataclass(frozen=True, slots=True)
class Reply:
    """Legal move in a state.

    Attributes:
        locution: name of the locution.
        slot: content of the reply.
        next: name of the next state, or of the end.
        last: name of the next state, or of the end, if the listener already has all support. If None, `next` is used.
        questioned: only for a refusal of support, which ends the game. If the defender questions the refusal, the game
            continues in the state of this name. If None, the refusal cannot be questioned.
    """

    locution: str
    slot: Slot
    next: str
    last: str | None = None
    questioned: str | None = None

    def leads_to(self, *, is_last: bool) -> str:
        """Return the name of the next state, or of the end."""
        return self.last if is_last and self.last is not None else self.next

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of all possible next states and ends."""
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
        name: name of the game.
        about: kind of topic: a literal (an affirmed or denied proposition), or a rule.
        opening: name of the first state, in which the initiator makes one statement about the topic.
        stages: states by name.
        most_turns: number of moves after which no other move is legal.
    """

    name: str
    about: Literal["literal", "rule"]
    opening: str
    stages: Mapping[str, GameStage]
    most_turns: int = 60

    def end_of(self, target: str) -> DialogueEnd | None:
        """Return the end with this name, or None for the name of a state."""
        return None if target in self.stages else DialogueEnd(target)


@dataclass(frozen=True)
class Rulebook:
    """Locutions and the games played with them.

    Attributes:
        locutions: all forms of all locutions.
        games: games by name.
    """

    locutions: tuple[Locution, ...]
    games: Mapping[str, GameTable]

    @cached_property
    def _forms(self) -> Mapping[tuple[str, ContentKind, str | None], Locution]:
        return {(each.name, each.content, each.of): each for each in self.locutions}

    def locution(self, name: str, content: Content, slot: Slot | None = None) -> Locution | None:
        """Return the form of a locution for a content in a slot, or None if there is none."""
        kind = kind_of_content(content)
        return self._forms.get((name, kind, slot)) or self._forms.get((name, kind, None))

    def makes_claim(self, move: DialogueMove) -> bool:
        """Return True for a move whose content its speaker has to defend."""
        locution = self.locution(move.locution, move.content)
        return locution is not None and locution.makes_claim

    @cached_property
    def committing(self) -> frozenset[str]:
        """Names of the locutions that show that their speaker holds the content."""
        return frozenset(each.name for each in self.locutions if {"shown", "concluded"} & set(each.after))
