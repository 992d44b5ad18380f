"""Log warnings that peers cause, each given once however often its cause is repeated."""

import logging

_REMEMBERED = 256
"""Most different warnings: peers choose parts of their text, so their number must have a bound."""


class WarnOnce:
    """Logger that gives each warning once; repetitions go to the debug log."""

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._given: set[str] = set()

    def warn(self, warning: str) -> None:
        """Log a warning, unless it was given before."""
        if warning in self._given or len(self._given) >= _REMEMBERED:
            self._log.debug("%s", warning)
            return
        self._given.add(warning)
        self._log.warning("%s", warning)
