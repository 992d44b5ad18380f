"""Storage of the recordings and sessions that a researcher opened, and of bookmarks."""

import json
from collections.abc import Sequence

from PySide6.QtCore import QSettings

RECENT = 10
"""Maximum number of stored recordings and sessions."""
_RECENT_KEY, _BOOKMARKS_KEY = "watch/recent", "watch/bookmarks"


class WatchMemory:
    """Storage of recent recordings and sessions, and of the bookmarks of recordings.

    Args:
        settings: settings that store the data.
    """

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings

    def recent(self) -> list[str]:
        """Return the paths of recordings and addresses of sessions, the latest first."""
        kept = self._read(_RECENT_KEY)
        return [source for source in kept if isinstance(source, str)] if isinstance(kept, list) else []

    def add(self, source: str) -> None:
        """Store a path or an address as the latest entry."""
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

        When a recording is no longer among the recent entries, its bookmarks are removed.
        """
        self._write(_BOOKMARKS_KEY, {**self._bookmarks(), source: list(times)})

    def _bookmarks(self) -> dict[str, object]:
        kept = self._read(_BOOKMARKS_KEY)
        return kept if isinstance(kept, dict) else {}

    def _read(self, key: str) -> object:
        self._settings.sync()
        try:
            return json.loads(str(self._settings.value(key, "null")))
        except ValueError:  # Another program has written this value.
            return None

    def _write(self, key: str, value: object) -> None:
        self._settings.setValue(key, json.dumps(value))
        self._settings.sync()
