"""Log of what programs were refused, for the people who run the server."""

import logging
from collections import Counter
from collections.abc import Iterable

from thbridge.roles.keeper.keeper import ProgramRefusal

_log = logging.getLogger(__name__)


MOST_KEPT = 1000
"""Different refusals that are counted; beyond that the counting begins anew."""


class RefusalLog:
    """Logs refusals; one that a program gets again is logged again only at the 10th, 100th, ... time."""

    def __init__(self) -> None:
        # By program and sentence.
        self._times: Counter[tuple[str, str]] = Counter()

    def note(self, refusals: Iterable[ProgramRefusal]) -> None:
        """Log the refusals of a tick."""
        for each in refusals:
            key = (each.program, each.refused.sentence)
            if key not in self._times and len(self._times) >= MOST_KEPT:
                self._times.clear()
            self._times[key] += 1
            times = self._times[key]
            if times == 1:
                _log.warning("%s", each)
            elif _is_power_of_ten(times):
                _log.warning("%s (%d times)", each, times)


def _is_power_of_ten(number: int) -> bool:
    text = str(number)
    return text == "1" + "0" * (len(text) - 1)
