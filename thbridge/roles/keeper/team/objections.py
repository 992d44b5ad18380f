"""Objections of participants in dialogues of other seats with robots."""

from collections.abc import Collection

from thbridge.dialogue.moves import Dialogue
from thbridge.hunt.events import ObjectionRaised
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.seats import Seat
from thbridge.roles.keeper.agreements import MATTERS
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.team_notices import LONGEST_REASON, REASONS, ObjectionView, RaiseObjection


class TeamObjections:
    """The objections of a game. A participant objects at most once in a dialogue."""

    def __init__(self) -> None:
        self._raised: list[ObjectionRaised] = []

    def object_to(
        self, dialogue: Dialogue, seat: Seat, request: RaiseObjection, after: int, now: float, *, talk_is_open: bool
    ) -> tuple[ObjectionRaised, ...] | RequestRefused:
        """Return the event of an objection, or a refusal. A repeated objection has no event.

        Args:
            dialogue: the open dialogue.
            seat: seat of the participant who objects, who has the right to do so.
            request: the objection.
            after: number of sentences in the dialogue so far.
            now: simulated time, s.
            talk_is_open: True if participants may send texts to each other now.
        """
        text, topic = request.text.strip(), dialogue.topic
        before = next(
            (each for each in self._raised if (each.dialogue, each.seat) == (dialogue.number, seat.name)), None
        )
        if before is not None and (before.reason, before.text) == (request.reason, text):
            return ()
        if before is not None:
            return RequestRefused(KeeperReason.HAS_OBJECTED, "You have already objected in this dialogue.")
        if request.reason not in REASONS[MATTERS[topic.scenario]]:
            return RequestRefused(KeeperReason.NOT_READY, "This reason does not fit the dialogue.")
        if text and not talk_is_open:
            return RequestRefused(KeeperReason.TALK_IS_OFF, "Messages between people are switched off now.")
        if len(text) > LONGEST_REASON:
            return RequestRefused(KeeperReason.TOO_LONG, f"An objection has at most {LONGEST_REASON} characters.")
        return (ObjectionRaised(dialogue.number, seat.name, topic.robot, topic.room, request.reason, text, after, now),)

    def note(self, entry: ObjectionRaised) -> None:
        """Process an event."""
        self._raised.append(entry)

    def views(self, dialogues: Collection[int]) -> tuple[ObjectionView, ...]:
        """Return the objections in these dialogues, given by number, in the form for participants."""
        return tuple(
            ObjectionView(each.dialogue, each.seat, each.reason, each.text, each.after)
            for each in self._raised
            if each.dialogue in dialogues
        )
