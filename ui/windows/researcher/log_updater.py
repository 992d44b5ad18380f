"""Update of the lists and of the timeline with entries from the log of a session or recording."""

from collections.abc import Iterator, Sequence

from thbridge.analysis.report.report import index_in, label_of
from ui.model.watching.scene import Entry, EntryKind
from ui.windows.researcher.docked_window import DockedWindow
from ui.windows.researcher.docks.log import LogRow
from ui.windows.researcher.docks.playback import TimelineBar, TimelineMark
from ui.windows.researcher.feeds.feed import Feed

MAX_NEW_ROWS = 2000
"""Maximum number of rows added to a list at once."""
MARK_TOLERANCE = 0.01
"""Seconds. If the time shown and a mark's time do not differ by more than this, they count as equal."""


class LogUpdater:
    """Updater that copies new log entries to the lists in small portions, so that it does not block the window.

    Args:
        feed: source of the log.
        window: window with the lists.
    """

    def __init__(self, feed: Feed, window: DockedWindow) -> None:
        self._feed = feed
        self._window = window
        self._taken: dict[EntryKind, int] = {}
        self._marks: tuple[TimelineMark, ...] = ()
        self._marked = (0, 0.0)

    def clear(self) -> None:
        """Empty the lists before the entries of another log are shown."""
        self._taken = {}
        for log in self._window.logs.values():
            log.clear()

    def show(self) -> None:
        """Copy the next portion of new entries."""
        session_log = self._feed.data.log
        for kind, log in self._window.logs.items():
            dropped, entries = session_log.dropped(kind), session_log.entries(kind)
            new = max(self._taken.get(kind, 0) - dropped, 0)
            log.extend([self._row(entry) for entry in entries[new : new + MAX_NEW_ROWS]])
            self._taken[kind] = dropped + min(new + MAX_NEW_ROWS, len(entries))
        total = sum(session_log.dropped(kind) + len(session_log.entries(kind)) for kind in ("event", "said"))
        total += session_log.ways_made.changes
        if not self._feed.live and (total, self._feed.transport.span) != self._marked:
            self._marked = total, self._feed.transport.span
            self._marks = tuple(self._timeline_marks())
            self._window.playback.show_span(self._feed.transport.span, self._marks, tuple(self._timeline_bars()))

    def _row(self, entry: Entry) -> LogRow:
        time = (entry.stamp_ns - self._feed.data.start_ns) / 1e9
        room = self._room(entry) if entry.room else "" if entry.room is None else "corridor"
        match entry.kind:
            case "event":
                cells: tuple[str, ...] = (entry.who, entry.what, room, entry.text)
            case "said":
                cells = (entry.who, room or entry.what, entry.text)
            case "line":
                cells = (entry.what, entry.text)
            case "input" | "log":
                cells = (entry.who, entry.what, entry.text)
        return LogRow(time, cells, entry.robot)

    def _room(self, entry: Entry) -> str:
        """Return the room of an entry in words; empty if the entry has no room or is about the corridor."""
        return self._feed.data.log.room_names.titled(entry.room) if entry.room else ""

    def _timeline_marks(self) -> Iterator[TimelineMark]:
        start_ns = self._feed.data.start_ns
        for entry in self._feed.data.log.marks():
            room = self._room(entry)
            text = " ".join(part for part in (entry.who, entry.what, room) if part)
            yield TimelineMark((entry.stamp_ns - start_ns) / 1e9, text, entry.robot, is_utterance=False)
        for entry in self._feed.data.log.entries("said"):
            yield TimelineMark(
                (entry.stamp_ns - start_ns) / 1e9, f"{entry.who}: {entry.text}", entry.robot, is_utterance=True
            )

    def _timeline_bars(self) -> Iterator[TimelineBar]:
        start, ways_made = self._feed.data.start_ns / 1e9, self._feed.data.log.ways_made
        for robot in ways_made.robots:
            for made in ways_made.of(robot, start + self._feed.transport.span):
                text = f"{label_of(robot)} makes way for {label_of(made.robot)}"
                yield TimelineBar(made.start - start, made.end - start, text, index_in(robot) or 0)

    def neighbouring_mark(self, direction: int, bookmarks: Sequence[float]) -> float:
        """Return the time of the next (1) or previous (-1) mark or bookmark.

        If there is no such mark, return the time of the end or the beginning.
        """
        times = sorted([*bookmarks, *(mark.time for mark in self._marks if not mark.is_utterance)])
        here = self._feed.transport.time
        if direction > 0:
            return next((time for time in times if time > here + MARK_TOLERANCE), self._feed.transport.span)
        return next((time for time in reversed(times) if time < here - MARK_TOLERANCE), 0.0)
