"""Log of dialogues in which robots argue; it has the state of each robot's latest dialogue at any time."""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

from thbridge.dialogue.portrait import DialoguePortrait, read_portrait
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord

MAX_KEPT = 20_000
"""Maximum number of moves and of states per robot; when there are more, the oldest are dropped."""


@dataclass(frozen=True, slots=True)
class DialogueCourse:
    """Latest dialogue of a robot at a certain time.

    Attributes:
        moves: moves of the dialogue so far, each with its stamp, oldest first.
        portrait: the robot's view of the dialogue; empty if unknown.
    """

    moves: tuple[tuple[int, DialogueMoveRecord], ...] = ()
    portrait: DialoguePortrait = field(default_factory=DialoguePortrait)


class DialogueLog:
    """Log of dialogues; moves and states must be added in order of time."""

    def __init__(self) -> None:
        self._moves: defaultdict[int, list[tuple[int, DialogueMoveRecord]]] = defaultdict(list)
        self._states: defaultdict[int, list[tuple[int, DialogueStateRecord]]] = defaultdict(list)
        self._read: dict[int, tuple[DialogueStateRecord, DialoguePortrait]] = {}

    def take_move(self, stamp_ns: int, move: DialogueMoveRecord) -> None:
        """Add a move."""
        moves = self._moves[move.robot]
        moves.append((stamp_ns, move))
        if len(moves) > MAX_KEPT:
            del moves[: MAX_KEPT // 10]

    def take_state(self, stamp_ns: int, state: DialogueStateRecord) -> None:
        """Add the state of a dialogue as the robot sees it."""
        states = self._states[state.robot]
        states.append((stamp_ns, state))
        if len(states) > MAX_KEPT:
            del states[: MAX_KEPT // 10]

    def course(self, robot: int, since_ns: int, until_ns: int) -> DialogueCourse:
        """Return the latest dialogue of a robot between two times; empty if the robot has not argued between them."""
        moves, states = self._moves.get(robot, []), self._states.get(robot, [])
        end = begin = _until(moves, until_ns)
        while begin and moves[begin - 1][0] >= since_ns and moves[begin - 1][1].talk == moves[end - 1][1].talk:
            begin -= 1
        held = _until(states, until_ns) - 1
        portrait = DialoguePortrait()
        if held >= 0 and states[held][0] >= since_ns:
            portrait = self._portrait(robot, states[held][1])
        return DialogueCourse(tuple(moves[begin:end]), portrait)

    def _portrait(self, robot: int, state: DialogueStateRecord) -> DialoguePortrait:
        """Parse a state. The last result is cached, because the same state is often requested several times."""
        known, portrait = self._read.get(robot, (None, DialoguePortrait()))
        if known is not state:
            try:
                portrait = read_portrait(state.json)
            except ValueError:
                portrait = DialoguePortrait()
            self._read[robot] = state, portrait
        return portrait


def _until(kept: Sequence[tuple[int, object]], until_ns: int) -> int:
    return bisect_right(kept, until_ns, key=lambda each: each[0])
