"""Messages about the participants of a game with several seats: their texts to each other, votes and objections."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

import msgspec

from thbridge.hunt.events import ObjectionReason
from thbridge.text_protocol.wire.notice_format import NoticeValue

LONGEST_TEXT = 500
"""Greatest length of a text, characters."""
LONGEST_REASON = 200
"""Greatest length of the reason of a vote, and of a participant's own words in an objection, characters."""
REASONS: Mapping[str, tuple[ObjectionReason, ...]] = {
    "select-room": (ObjectionReason.TOO_FAR, ObjectionReason.OTHER_ROOM, ObjectionReason.OTHER_ROBOT),
    "take-picture": (ObjectionReason.NOT_NEEDED, ObjectionReason.SAVE_ENERGY),
    "take-treasure": (ObjectionReason.WRONG_NAME, ObjectionReason.NOT_SURE),
}
"""Possible reasons for objections, by the matter of the dialogue."""


@dataclass(frozen=True, slots=True)
class TalkLine:
    """Text of a participant.

    Attributes:
        line: number of the text in the game, from 1.
        seat: seat of the author.
        to: seat of the addressee; empty if the text is for all.
        text: the text.
        at: simulated time at which it was sent, s.
        number: number that the author's program gave the text; see `SayToPeople`.
    """

    line: int
    seat: str
    to: str
    text: str
    at: float
    number: int = 0


class TeamTalk(NoticeValue, frozen=True, tag="Talk"):
    """Keeper to a participant: texts of the game with this number that the program does not have yet.

    A program that has joined again gets all texts again; their numbers show which of them it has.
    """

    game: int
    lines: tuple[TalkLine, ...]


class ReportPresence(NoticeValue, frozen=True, tag="Present"):
    """Participant to keeper: the participant is at their front end now, or is not. A program joins with one."""

    present: bool


class SayToPeople(NoticeValue, frozen=True, tag="Say"):
    """Participant to keeper: send a text to another participant, or to all.

    Attributes:
        text: the text.
        to: seat of the addressee; empty for all.
        typing: time from the first key to sending, s.
        number: number of the text among those of its author, from 1. A text with the same number, addressee and words
            as an earlier one is a repetition, also from another run of the program. If 0, it never is.
    """

    text: Annotated[str, msgspec.Meta(max_length=4 * LONGEST_TEXT)]
    to: str = ""
    typing: float = 0.0
    number: int = 0


class MarkRead(NoticeValue, frozen=True, tag="Read"):
    """Participant to keeper: the program has shown all texts up to the one with this number."""

    line: int


class Vote(NoticeValue, frozen=True, tag="Vote"):
    """Participant to keeper: vote on a decision.

    Attributes:
        decision: number of the decision.
        agrees: True to agree.
        reason: reason, for the other participants; may be empty.
    """

    decision: int
    agrees: bool
    reason: str = ""


class RaiseObjection(NoticeValue, frozen=True, tag="Object"):
    """Participant to keeper: object in a dialogue of another seat, once.

    Attributes:
        dialogue: number of the dialogue.
        reason: reason; one of `REASONS` for the matter of the dialogue.
        text: the participant's own words about it; may be empty.
    """

    dialogue: int
    reason: ObjectionReason
    text: str = ""


@dataclass(frozen=True, slots=True)
class ObjectionView:
    """Objection in a dialogue that the participant sees.

    Attributes:
        dialogue: number of the dialogue.
        seat: seat of the participant who objects.
        reason: reason of the objection.
        text: that participant's own words about it; may be empty.
        after: number of sentences in the dialogue before the objection.
    """

    dialogue: int
    seat: str
    reason: ObjectionReason
    text: str
    after: int


@dataclass(frozen=True, slots=True)
class VoteView:
    """Vote of a participant: their seat, whether they agree, and their reason."""

    seat: str
    agrees: bool
    reason: str


@dataclass(frozen=True, slots=True)
class DecisionView:
    """Open vote on a decision.

    Attributes:
        decision: number of the decision.
        seat: seat of the participant who proposed it, and so agrees.
        kind: kind of the decision.
        robot: index of the robot that is sent, or None.
        room: destination, or room of the treasure; None for the end of the game.
        name: proposed name of the treasure; empty for other kinds.
        needs: number of participants who must agree.
        ends_at: simulated time at which the vote ends without a decision, s.
        votes: votes of the other participants, in order.
    """

    decision: int
    seat: str
    kind: Literal["send", "name", "end"]
    robot: int | None
    room: int | None
    name: str
    needs: int
    ends_at: float
    votes: tuple[VoteView, ...]


@dataclass(frozen=True, slots=True)
class SettledView:
    """Vote that has ended.

    Attributes:
        decision: the decision, with its last votes.
        outcome: outcome. A decision is void if it became impossible before all votes were cast.
    """

    decision: DecisionView
    outcome: Literal["carried", "rejected", "expired", "void"]
