"""Log warnings about peers. Each warning is logged once, even if its cause is repeated."""

import logging

_REMEMBERED = 256
"""Largest number of different warnings. There is a limit, because peers choose parts of the text."""


class WarnOnce:
    """Logger of each warning once; repetitions go to the debug log."""

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._given: set[str] = set()

    def warn(self, warning: str) -> None:
        """Log a warning, unless it was logged before."""
        if warning in self._given or len(self._given) >= _REMEMBERED:
            self._log.debug("%s", warning)
            return
        self._given.add(warning)
        self._log.warning("%s", warning)
