"""Replies of a simulated participant in dialogues: which of the choices it makes, by its attitude."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.numerics import noise
from thbridge.dialogue.games.strategies import Attitude
from thbridge.roles.shared.view import DialogueView

MOST_REPLIES = 8
"""Replies of a sceptic in one dialogue, after which it gives in or leaves."""
MOST_TALK = 24
"""Replies of any participant in one dialogue, after which it leaves: a robot may mishear it again and again."""
QUESTION_PROBABILITY = 0.2
"""Probability that a sceptic asks something before it replies."""
REJECTION_PROBABILITY = 0.5
"""Probability that a sceptic does not accept what it has heard reasons for, and that it does not give in at last."""
STOP_PROBABILITY = 0.3
"""Probability that a sceptic stops a robot that asks scripted questions about a room that it did not choose."""


@dataclass(frozen=True, slots=True)
class Opinion:
    """Opinion of a participant of what a dialogue is about.

    Attributes:
        is_own: they brought it up.
        is_liked: no other room costs less.
        is_dear: it costs much more than another room.
    """

    is_own: bool = False
    is_liked: bool = False
    is_dear: bool = False


@dataclass(frozen=True, slots=True)
class ReplyPolicy:
    """Policy by which a simulated participant replies in dialogues: a function of the view and of its seed.

    The credulous make the first choice, the most agreeable one. The cautious agree to what they would choose
    themselves; they challenge anything else, and accept the reasons; where none can be asked for, they stop what costs
    too much. The sceptical challenge whatever they can, reject half of what they hear reasons for, hold to what they
    chose, ask questions now and then, and in the end give in or leave.

    Attributes:
        attitude: towards what robots say.
        seed: of its random numbers; only the sceptical draw any.
    """

    attitude: Attitude
    seed: int

    def reply(self, dialogue: DialogueView, opinion: Opinion) -> int:
        """Return the choice, counted from 0, in a dialogue that has choices."""
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
        # A sceptic has its wish, and other reasons; the others put forward what comes first.
        varies = self.attitude is Attitude.SCEPTICAL
        return found[int(self._chance("reasons", dialogue) * len(found))] if varies else found[0]

    def _sceptical(self, dialogue: DialogueView, is_own: bool) -> tuple[str, ...]:
        """Return the acts that a sceptic would make, the one it likes best first."""
        doubts = self._chance("rejections", dialogue) < REJECTION_PROBABILITY
        if "continue" in dialogue.acts:
            stops = not is_own and self._chance("stops", dialogue) < STOP_PROBABILITY
            return ("stop",) if stops else ("continue",)
        if dialogue.speakers.count("person") >= MOST_REPLIES:
            return ("override", "leave") if doubts and is_own else ("leave",) if doubts else ("accept", "leave")
        if "open-questions" in dialogue.acts and self._chance("questions", dialogue) < QUESTION_PROBABILITY:
            return ("open-questions",)
        insists = ("override", "assert") if is_own else ()
        # Whoever is asked has three answers: that it is so, that it is not so, and not to know.
        answers = ("assert",) if dialogue.acts.count("assert") == 3 else ()
        return ("enquire", "challenge", *insists, "reject" if doubts else "accept", "question", *answers, "leave")

    def _chance(self, of: str, dialogue: DialogueView) -> float:
        return noise.uniform(noise.key(self.seed, "participant", of), dialogue.dialogue, dialogue.turn)


def _cautious(dialogue: DialogueView, opinion: Opinion) -> Sequence[str]:
    """Return the acts that somebody cautious would make, the one they like best first."""
    if "continue" in dialogue.acts:
        return ("stop",) if opinion.is_dear and not opinion.is_own else ("continue",)
    liked = ("accept",) if opinion.is_liked else ()
    return (*liked, "challenge", "accept", "question", "assert", "leave")
