"""Log of what programs were refused, for the people who run the server."""

import logging
from collections.abc import Iterable

from thbridge.roles.keeper.keeper import ProgramRefusal

_log = logging.getLogger(__name__)


class RefusalLog:
    """Logs refusals; one that a program repeats is logged again only at the 10th, 100th, ... time."""

    def __init__(self) -> None:
        # By program, the last sentence and how often it was told in a row.
        self._last: dict[str, tuple[str, int]] = {}

    def note(self, refusals: Iterable[ProgramRefusal]) -> None:
        """Log the refusals of a tick."""
        for each in refusals:
            sentence, times = self._last.get(each.program, ("", 0))
            times = times + 1 if sentence == each.refused.sentence else 1
            self._last[each.program] = (each.refused.sentence, times)
            if times == 1:
                _log.warning("%s", each)
            elif str(times).strip("0") == "1":
                _log.warning("%s (%d times)", each, times)
