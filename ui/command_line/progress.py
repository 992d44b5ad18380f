"""Progress of long commands: a bar on a terminal; otherwise a line per minute, or JSON lines, on standard error."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event, Lock, Thread

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from thbridge.files.progress import Tell, untold
from ui.command_line.options import ProgressKind
from ui.command_line.terminal import err, note

EVERY = 60.0
"""Seconds from one line to the next."""
_A_MINUTE, _AN_HOUR = 60.0, 3600.0


@dataclass(slots=True)
class _CountedTask:
    """Task with a count: it was `first` at the time `began` (seconds), and is `done` now. 0 is an unknown total."""

    began: float
    first: int
    done: int
    total: int

    def seconds_left(self, now: float) -> float | None:
        """Return the seconds left at the mean rate so far; None if nothing has been done yet."""
        here = self.done - self.first
        return (now - self.began) * (self.total - self.done) / here if here > 0 and self.total else None


class ProgressLines:
    """Lines about the latest task of a command.

    Args:
        doing: name of the work, which is shown until the first count arrives.
        now: monotonic start time, seconds.
    """

    def __init__(self, doing: str, now: float) -> None:
        self._doing, self._began = doing, now
        self._tasks: dict[str, _CountedTask] = {}
        self._latest = doing
        self._lock = Lock()

    def take(self, what: str, done: int, total: int, now: float) -> None:
        """Record the completed number and the total number of a task's units; a total of 0 means unknown."""
        with self._lock:
            self._latest = what
            task = self._tasks.setdefault(what, _CountedTask(now, done, done, total))
            task.done, task.total = done, total

    def sentence(self, now: float) -> str:
        """Return the progress as a line for people."""
        with self._lock:
            elapsed, task = f"{_span(now - self._began)} elapsed", self._tasks.get(self._latest)
            if task is None:
                return f"{self._doing}: {elapsed}"
            left = task.seconds_left(now)
            of_all = f" of {task.total} ({task.done / task.total:.0%})" if task.total else ""
            more = "" if left is None else f", about {_span(left)} left"
            return f"{self._latest}: {task.done}{of_all}, {elapsed}{more}"

    def as_json(self, now: float) -> str:
        """Return the progress as a line of JSON: task, done, total, seconds elapsed and left; null where unknown."""
        with self._lock:
            task = self._tasks.get(self._latest)
            left = None if task is None else task.seconds_left(now)
            values = {
                "task": self._latest,
                "done": None if task is None else task.done,
                "total": (None if task is None else task.total) or None,
                "elapsed_seconds": round(now - self._began, 1),
                "seconds_left": None if left is None else round(left, 1),
            }
        return json.dumps(values)


@contextmanager
def shown_progress(
    kind: ProgressKind, doing: str, every: float = EVERY, *, beside_text: bool = False
) -> Iterator[Tell]:
    """Show the progress of a command.

    Args:
        kind: format, as given by --progress.
        doing: name of the work, which is shown until the first count arrives.
        every: seconds from one line to the next.
        beside_text: True for a command that also prints events. A terminal then shows no bar.
    """
    if kind is ProgressKind.AUTO and err.is_terminal:
        if beside_text:
            yield untold
            return
        with _bar() as tell:
            yield tell
        return
    lines, ended = ProgressLines(doing, time.monotonic()), Event()
    line = lines.as_json if kind is ProgressKind.JSON else lines.sentence

    def write() -> None:
        while not ended.wait(every):
            note(line(time.monotonic()))

    writer = Thread(target=write, daemon=True)
    writer.start()
    try:
        yield lambda what, done, total: lines.take(what, done, total, time.monotonic())
    finally:
        ended.set()
        writer.join()
        if kind is ProgressKind.JSON:
            note(line(time.monotonic()))


@contextmanager
def _bar() -> Iterator[Tell]:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _RateColumn(),
        TimeRemainingColumn(),
    )
    # Two games of a sweep, or two trips, may end minutes apart.
    with Progress(*columns, console=err, transient=True, speed_estimate_period=600.0) as bar:
        tasks: dict[str, TaskID] = {}

        def tell(what: str, done: int, total: int) -> None:
            if what not in tasks:
                tasks[what] = bar.add_task(what, total=total or None)
            bar.update(tasks[what], completed=done, total=total or None)

        yield tell


class _RateColumn(ProgressColumn):
    """Rate, in items per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.0f}/s" if speed >= 10.0 else f"{speed:.2f}/s")


def _span(seconds: float) -> str:
    """Return a duration as text, in seconds, minutes or hours."""
    if seconds < _A_MINUTE:
        return f"{seconds:.0f} s"
    if seconds < _AN_HOUR:
        return f"{seconds / _A_MINUTE:.0f} min"
    return f"{seconds / _AN_HOUR:.1f} h"
