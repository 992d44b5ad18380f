"""Events of an experiment's log."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

JsonValue = None | bool | int | float | str | list["JsonValue"] | dict[str, "JsonValue"]

Actor = Literal["participant", "experimenter", "robot", "program"]


@dataclass(frozen=True, slots=True)
class Clocks:
    """The times at which something happened, by all clocks that there are.

    Wall clocks jump, and simulated time begins anew with each trial: events are ordered by their sequence alone.

    Attributes:
        wall: date and time of day, ISO 8601 in UTC.
        monotonic_ns: nanoseconds of the clock of the process that saw it.
        simulated: seconds of simulated time; None outside of a trial.
        lsl: seconds of the Lab Streaming Layer's `local_clock()`; None where no markers are sent.
    """

    wall: str
    monotonic_ns: int
    simulated: float | None = None
    lsl: float | None = None


@dataclass(frozen=True, slots=True)
class NewEvent:
    """Something that happened, before it is in the log.

    Attributes:
        kind: its name, such as "answer-given".
        actor: who did it.
        clocks: the times at which it happened.
        participant: id of the person whose run it belongs to; empty: nobody's.
        step: number of the step of that run, from 1; 0: no step's.
        condition: name of the condition of that step; empty: none.
        cause: sequence number of the event from which it follows; 0: from none.
        data: what else there is to say.
    """

    kind: str
    actor: Actor
    clocks: Clocks
    participant: str = ""
    step: int = 0
    condition: str = ""
    cause: int = 0
    data: Mapping[str, JsonValue] | None = None


@dataclass(frozen=True, slots=True)
class LoggedEvent:
    """An event of the log.

    Attributes:
        sequence: its number, from 1, without gaps.
        event: what happened.
    """

    sequence: int
    event: NewEvent


@dataclass(frozen=True, slots=True)
class Tombstone:
    """An event that was deleted because somebody withdrew.

    Attributes:
        sequence: the number that it had.
    """

    sequence: int


LogEntry = LoggedEvent | Tombstone
