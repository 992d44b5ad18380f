"""Log of refused requests and failed strategies, for the people who run a session or a server."""

import logging
from collections import Counter
from collections.abc import Iterable

from sim.common.robot_numbers import robot_name
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.roles.keeper.keeper import ProgramRefusal

_log = logging.getLogger(__name__)


MOST_KEPT = 1000
"""Maximum number of different problems that are counted. When there are more, counting restarts."""


class TroubleLog:
    """Log of problems. A problem is logged when it occurs for the 1st, 10th, 100th, ... time."""

    def __init__(self) -> None:
        # Number of occurrences of each problem, by program or robot, and by sentence.
        self._times: Counter[tuple[str, str]] = Counter()

    def note(self, refusals: Iterable[ProgramRefusal], utterances: Iterable[DialogueUtterance] = ()) -> None:
        """Log the refusals of a tick, and the faults of strategies that the tick's utterances contain."""
        for refusal in refusals:
            self._count((refusal.program, refusal.refused.sentence), str(refusal))
        for said in utterances:
            if said.fault:
                name = robot_name(said.topic.robot)
                sentence = f"{name} chose a move by its own strategy, because the study's strategy failed: {said.fault}"
                self._count((name, said.fault), sentence)

    def _count(self, key: tuple[str, str], sentence: str) -> None:
        if key not in self._times and len(self._times) >= MOST_KEPT:
            self._times.clear()
        self._times[key] += 1
        times = self._times[key]
        if times == 1:
            _log.warning("%s", sentence)
        elif _is_power_of_ten(times):
            _log.warning("%s (%d times)", sentence, times)


def _is_power_of_ten(number: int) -> bool:
    text = str(number)
    return text == "1" + "0" * (len(text) - 1)
