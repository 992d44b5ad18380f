"""Replies of a simulated participant in dialogues. They depend on the participant's attitude."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.numerics import noise
from thbridge.dialogue.games.strategies import Attitude
from thbridge.hunt.events import ObjectionReason
from thbridge.roles.shared.team_notices import REASONS
from thbridge.roles.shared.view import DialogueView

MOST_REPLIES = 8
"""A sceptic gives in or leaves after this number of replies in a dialogue."""
MOST_TALK = 24
"""Every participant leaves a dialogue after this number of replies, because a robot may mishear repeatedly."""
QUESTION_PROBABILITY = 0.2
"""Probability that a sceptic asks a question before the reply."""
REJECTION_PROBABILITY = 0.5
"""Probability that a sceptic rejects a claim after hearing reasons, and probability of not giving in at the end."""
STOP_PROBABILITY = 0.3
"""Probability that a sceptic stops a robot that asks scripted questions, if the sceptic did not choose the room. Also
probability that a sceptic votes against another participant's move."""


OBJECTION_PROBABILITY = 0.2
"""Probability that a sceptic objects in a dialogue of another participant, if the seat may object."""


@dataclass(frozen=True, slots=True)
class Opinion:
    """Opinion of a participant about a proposal in a dialogue.

    Attributes:
        is_own: True if the proposal is from the participant.
        is_liked: True if no other room costs less.
        is_dear: True if the room costs much more than another room.
    """

    is_own: bool = False
    is_liked: bool = False
    is_dear: bool = False


@dataclass(frozen=True, slots=True)
class ReplyPolicy:
    """Policy for the replies of a simulated participant in dialogues. Replies depend only on the view and the seed.

    Credulous participants always make the first choice, which is the most agreeable choice. Cautious participants agree
    to proposals that they would choose themselves. They challenge all other proposals and accept the reasons. If they
    cannot ask for reasons, they stop robots with too expensive choices. Sceptical participants challenge all claims if
    possible, and reject half of the justified claims. They insist on their own choices, and sometimes ask questions.
    Finally, they give in or leave.

    Attributes:
        attitude: attitude to robots' claims.
        seed: random seed. Only sceptical participants use random numbers.
    """

    attitude: Attitude
    seed: int

    def reply(self, dialogue: DialogueView, opinion: Opinion) -> int:
        """Return the number of the choice, from 0, in a dialogue with choices."""
        if dialogue.acts[-1:] == ("leave",) and dialogue.speakers.count("person") >= MOST_TALK:
            return len(dialogue.choices) - 1
        match self.attitude:
            case Attitude.CAUTIOUS:
                wanted: Sequence[str] = _cautious(dialogue, opinion)
            case Attitude.SCEPTICAL:
                wanted = self._sceptical(dialogue, opinion.is_own)
            case _:
                wanted = ()
        act = next((act for act in wanted if act in dialogue.acts), None)
        if act is None:
            return 0
        found = [choice for choice, offered in enumerate(dialogue.acts) if offered == act]
        # A sceptic chooses randomly among equal acts, for example among reasons. Other participants choose the first.
        varies = self.attitude is Attitude.SCEPTICAL
        return found[int(self._uniform("reasons", dialogue) * len(found))] if varies else found[0]

    def agrees(self, decision: int, *, is_dear: bool) -> bool:
        """Return True to vote for another participant's move.

        Args:
            decision: number of the decision.
            is_dear: True if the move costs much more than another move.
        """
        match self.attitude:
            case Attitude.CAUTIOUS:
                return not is_dear
            case Attitude.SCEPTICAL:
                votes = noise.key(self.seed, "participant", "votes")
                return noise.uniform(votes, decision, 0) >= STOP_PROBABILITY
            case _:
                return True

    def objection(self, dialogue: DialogueView, *, is_dear: bool) -> ObjectionReason | None:
        """Return the reason to object in a dialogue of another participant, or None. Only sceptics object.

        Args:
            dialogue: the dialogue.
            is_dear: True if the dialogue is about a move that costs much more than another move.
        """
        draw, number = noise.key(self.seed, "participant", "objections"), dialogue.dialogue
        if self.attitude is not Attitude.SCEPTICAL or noise.uniform(draw, number, 0) >= OBJECTION_PROBABILITY:
            return None
        reasons = REASONS[dialogue.matter]
        return ObjectionReason.TOO_FAR if is_dear else reasons[int(noise.uniform(draw, number, 1) * len(reasons))]

    def _sceptical(self, dialogue: DialogueView, is_own: bool) -> tuple[str, ...]:
        """Return a sceptic's preferred acts, in order of preference."""
        doubts = self._uniform("rejections", dialogue) < REJECTION_PROBABILITY
        if "continue" in dialogue.acts:
            stops = not is_own and self._uniform("stops", dialogue) < STOP_PROBABILITY
            return ("stop",) if stops else ("continue",)
        if dialogue.speakers.count("person") >= MOST_REPLIES:
            return ("override", "leave") if doubts and is_own else ("leave",) if doubts else ("accept", "leave")
        if "open-questions" in dialogue.acts and self._uniform("questions", dialogue) < QUESTION_PROBABILITY:
            return ("open-questions",)
        insists = ("override", "assert") if is_own else ()
        # Three assertions are the answers to a robot's question: yes, no, and don't know.
        answers = ("assert",) if dialogue.acts.count("assert") == 3 else ()
        return ("enquire", "challenge", *insists, "reject" if doubts else "accept", "question", *answers, "leave")

    def _uniform(self, of: str, dialogue: DialogueView) -> float:
        return noise.uniform(noise.key(self.seed, "participant", of), dialogue.dialogue, dialogue.turn)


def _cautious(dialogue: DialogueView, opinion: Opinion) -> Sequence[str]:
    """Return a cautious participant's preferred acts, in order of preference."""
    if "continue" in dialogue.acts:
        return ("stop",) if opinion.is_dear and not opinion.is_own else ("continue",)
    liked = ("accept",) if opinion.is_liked else ()
    return (*liked, "challenge", "accept", "question", "assert", "leave")
