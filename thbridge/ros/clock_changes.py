"""Jumps of a recording's time stamps because a clock was set, and single wrong time stamps."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

CLOCK_STEP_NS = 1_000_000_000
"""Minimum change that counts as a change of the clock. Reordered or delayed messages cause smaller changes."""


class Stamped(Protocol):
    """Object with a time stamp and a time of recording, nanoseconds."""

    @property
    def stamp_ns(self) -> int:
        """Time stamp that the object contains."""

    @property
    def received_ns(self) -> int:
        """Time of recording."""


Message = TypeVar("Message", bound=Stamped)


@dataclass(slots=True)
class ClockRun(Generic[Message]):
    """Messages between two changes of a clock, in the order of recording.

    Attributes:
        messages: the messages, at least one.
        changed_ns: change of the clock before the first message, positive if it was set ahead. 0 for the first run.
    """

    messages: list[Message]
    changed_ns: int = 0
    _latest_ns: int = field(init=False)
    _ahead_ns: int = field(init=False)

    def __post_init__(self) -> None:
        first = self.messages[0]
        self._latest_ns, self._ahead_ns = first.stamp_ns, first.stamp_ns - first.received_ns

    def continues_with(self, message: Message) -> bool:
        """Return True if the time stamp of a message may come from the clock of this run.

        A message gets its time stamp before it is recorded. So a time stamp can be ahead of the time of recording only
        by a limited time.
        """
        back = message.stamp_ns < self._latest_ns - CLOCK_STEP_NS
        return not back and message.stamp_ns - message.received_ns <= self._ahead_ns + CLOCK_STEP_NS

    def add(self, message: Message) -> None:
        """Add the next message."""
        self.messages.append(message)
        self._latest_ns = max(self._latest_ns, message.stamp_ns)
        self._ahead_ns = max(self._ahead_ns, message.stamp_ns - message.received_ns)


def split_by_clock(messages: Iterable[Message]) -> tuple[list[ClockRun[Message]], list[Message]]:
    """Return the runs of a clock, and the messages whose time stamps fit neither the earlier nor the later run.

    Args:
        messages: messages in the order of recording.
    """
    runs: list[ClockRun[Message]] = []
    odd: list[Message] = []
    # A message that does not fit the run. The next message shows whether its time stamp is wrong or the clock was set.
    waiting: ClockRun[Message] | None = None
    for message in messages:
        if not runs:
            runs.append(ClockRun([message]))
        elif runs[-1].continues_with(message):
            runs[-1].add(message)
            odd += waiting.messages if waiting else []
            waiting = None
        elif waiting is not None and waiting.continues_with(message):
            waiting.add(message)
            if len(runs[-1].messages) == 1 and len(runs) == 1:
                odd += runs.pop().messages
                waiting.changed_ns = 0
            runs.append(waiting)
            waiting = None
        else:
            odd += waiting.messages if waiting else []
            last = runs[-1].messages[-1]
            changed = (message.stamp_ns - message.received_ns) - (last.stamp_ns - last.received_ns)
            waiting = ClockRun([message], changed)
    odd += waiting.messages if waiting else []
    return runs, odd


class StampedIndex(NamedTuple):
    """Time stamp, time of recording, and index of a message."""

    stamp_ns: int
    received_ns: int
    place: int


def stamps_by_clock(
    stamps: NDArray[np.int64], received: NDArray[np.int64]
) -> tuple[list[tuple[NDArray[np.int64], int]], NDArray[np.int64]]:
    """Return the indices of each run of a clock with the change before it, and the indices of wrong stamps.

    See `split_by_clock`.

    Args:
        stamps: (n,) nanoseconds, in the order of recording.
        received: (n,) times of recording.
    """
    # Most recordings have no change of the clock. Arrays check this faster than `split_by_clock`.
    ahead = stamps - received
    back = stamps[1:] < np.maximum.accumulate(stamps)[:-1] - CLOCK_STEP_NS
    if not (back | (ahead[1:] > np.maximum.accumulate(ahead)[:-1] + CLOCK_STEP_NS)).any():
        whole = np.arange(len(stamps), dtype=np.int64)
        return ([(whole, 0)] if len(stamps) else []), np.empty(0, dtype=np.int64)
    each = zip(stamps.tolist(), received.tolist(), range(len(stamps)), strict=True)
    runs, odd = split_by_clock(StampedIndex(*message) for message in each)
    return [(_indices(run.messages), run.changed_ns) for run in runs], _indices(odd)


def _indices(messages: Iterable[StampedIndex]) -> NDArray[np.int64]:
    return np.array([message.place for message in messages], dtype=np.int64)
