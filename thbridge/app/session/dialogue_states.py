"""States of dialogues in which robots argue, for recordings."""

from collections.abc import Iterator, Sequence

from thbridge.dialogue.arguing_moves import claim_of, last_play
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.dialogue.moves import Conclude, Dialogue, DialogueUtterance
from thbridge.dialogue.portrait import ObjectionsToClaim, portray
from thbridge.dialogue.propositions import Decided, Objected
from thbridge.hunt.events import ObjectionRaised, TeamEntry
from thbridge.ros.messages.session_records import DialogueStateRecord


class DialogueStates:
    """States of the dialogues of a session, with the objections of seats that only read along."""

    def __init__(self) -> None:
        self._states: dict[int, DialogueStateRecord] = {}
        # By robot: the last utterance of its present dialogue.
        self._last: dict[int, DialogueUtterance] = {}
        # By dialogue: its claim at the beginning, the seat that talks with the robot, and the objections.
        self._claims: dict[int, Literal] = {}
        self._seats: dict[int, str] = {}
        self._raised: dict[int, list[ObjectionRaised]] = {}

    def changed(
        self, utterances: Sequence[DialogueUtterance], team: Sequence[TeamEntry]
    ) -> Iterator[DialogueStateRecord]:
        """Yield the states that the utterances and objections of a tick have changed."""
        robots = dict.fromkeys(utterance.topic.robot for utterance in utterances)
        for utterance in utterances:
            self._last[utterance.topic.robot] = utterance
            self._claims.setdefault(utterance.dialogue, claim_of(utterance.topic))
            if utterance.seat:
                self._seats[utterance.dialogue] = utterance.seat
        for entry in team:
            if isinstance(entry, ObjectionRaised):
                self._raised.setdefault(entry.dialogue, []).append(entry)
                robots[entry.robot] = None
        for robot in robots:
            last = self._last.get(robot)
            if last is None or last.conversation is None:
                continue
            portrait = portray(last.conversation, self._objections(last))
            state = DialogueStateRecord(last.dialogue, robot, portrait.json())
            if self._states.get(robot) != state:
                self._states[robot] = state
                yield state

    def _objections(self, last: DialogueUtterance) -> ObjectionsToClaim | None:
        """Return the objections in a dialogue, and the decision in spite of them; None if there are no objections."""
        raised, claim = self._raised.get(last.dialogue, []), self._claims[last.dialogue]
        if not raised:
            return None
        play = last_play(Dialogue(last.dialogue, last.topic, conversation=last.conversation))
        agreed = play is not None and play.end is DialogueEnd.AGREEMENT and play.claim == claim
        seat = self._seats.get(last.dialogue, "")
        decided = agreed or (isinstance(last.move, Conclude) and last.move.about == claim)
        return ObjectionsToClaim(
            claim,
            tuple((each.seat, Literal(Objected(each.seat, each.reason.replace("-", "_")))) for each in raised),
            (seat, Literal(Decided(seat))) if decided else None,
        )
