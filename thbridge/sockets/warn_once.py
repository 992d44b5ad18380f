"""Warnings about peers, which are logged only once even if their cause is repeated."""

import logging

_REMEMBERED = 256
"""Maximum number of different warnings. Without a limit, peers could fill the log, because they choose parts of the
texts."""


class WarnOnce:
    """Logger of warnings. Repeated warnings go to the debug log."""

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._given: set[str] = set()

    def warn(self, warning: str) -> None:
        """Log a warning. If it was logged before, or there were too many warnings, only the debug log gets it."""
        if warning in self._given or len(self._given) >= _REMEMBERED:
            self._log.debug("%s", warning)
            return
        self._given.add(warning)
        self._log.warning("%s", warning)
