"""Memory of the researcher's windows: previously opened recordings and sessions, and bookmarks."""

import json
from collections.abc import Sequence

from PySide6.QtCore import QSettings

RECENT = 10
"""Largest number of recordings and sessions to remember."""
_RECENT_KEY, _BOOKMARKS_KEY = "watch/recent", "watch/bookmarks"


class WatchMemory:
    """Recent recordings and sessions, and their bookmarks.

    Args:
        settings: storage of the memory.
    """

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings

    def recent(self) -> list[str]:
        """Return paths of recordings and addresses of sessions, the latest first."""
        kept = self._read(_RECENT_KEY)
        return [source for source in kept if isinstance(source, str)] if isinstance(kept, list) else []

    def add(self, source: str) -> None:
        """Make a path or an address the latest entry."""
        others = [each for each in self.recent() if each != source]
        self._write(_RECENT_KEY, [source, *others][:RECENT])
        bookmarks = self._bookmarks()
        self._write(_BOOKMARKS_KEY, {each: bookmarks[each] for each in self.recent() if each in bookmarks})

    def bookmarks(self, source: str) -> list[float]:
        """Return the bookmarks of a recording, seconds since its beginning."""
        kept = self._bookmarks().get(source)
        return [float(time) for time in kept if isinstance(time, int | float)] if isinstance(kept, list) else []

    def keep_bookmarks(self, source: str, times: Sequence[float]) -> None:
        """Store the bookmarks of a recording.

        They are removed when the recording is no longer among the recent ones.
        """
        self._write(_BOOKMARKS_KEY, {**self._bookmarks(), source: list(times)})

    def _bookmarks(self) -> dict[str, object]:
        kept = self._read(_BOOKMARKS_KEY)
        return kept if isinstance(kept, dict) else {}

    def _read(self, key: str) -> object:
        self._settings.sync()
        try:
            return json.loads(str(self._settings.value(key, "null")))
        except ValueError:  # Another program wrote this value.
            return None

    def _write(self, key: str, value: object) -> None:
        self._settings.setValue(key, json.dumps(value))
        self._settings.sync()
