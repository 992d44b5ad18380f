"""Markers for other recorders: each event of a study's log goes out as a sample of the Lab Streaming Layer.

One stream of type Markers, one channel of text, at no regular rate. A sample is JSON: sequence, kind, participant,
step, condition and the clocks of the event; its time is `local_clock()`, which the event has in the log as well.
Answers do not leave the log.

Nobody who records can hold a study up: a thread of its own hands samples to liblsl, and all that fails there is told as
a trouble.
"""

import json
import socket
import threading
from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue
from typing import Self

from thbridge.experiment.store.events import Clocks, LoggedEvent

STREAM, STREAM_TYPE = "thbridge", "Markers"
"""Name of the stream, and its type."""
MOST_WAITING = 2000
"""Markers that may wait to be handed over; beyond it the newest are left out."""
INSTALL = "Install it: pip install 'thbridge[markers]'"
LIBRARY = "Install liblsl 1.16 or newer for this system, and name its file by the environment variable PYLSL_LIB"


def why_no_markers() -> str:
    """Return why no markers can be sent from here, in a sentence; empty: they can."""
    try:
        # Where nobody wants markers, neither package nor library need be there.
        import pylsl  # noqa: F401, PLC0415
    except ImportError:
        return f"Markers: pylsl is not installed. {INSTALL}."
    except (RuntimeError, OSError) as error:
        return f"Markers: liblsl cannot be loaded ({_first_line(error)}). {LIBRARY}."
    return ""


class MarkerStream:
    """The markers of one study, from when it is made until it is closed.

    Args:
        study: title of the study.
        wanted: False for a study without markers; nothing is sent then, and nothing is loaded.

    Attributes:
        source: the stream's source id, by which recorders find it again when the program began anew.
    """

    def __init__(self, study: str, *, wanted: bool = True) -> None:
        self._study = study
        self.source = f"{STREAM} {study} {socket.gethostname()}"
        self._wanted = wanted
        self._trouble = why_no_markers() if wanted else ""
        self._lost = 0
        self._clock: Callable[[], float] | None = None
        self._waiting: SimpleQueue[tuple[str, float] | None] = SimpleQueue()
        if self._trouble or not wanted:
            return
        import pylsl  # noqa: PLC0415

        self._clock = pylsl.local_clock
        self._thread = threading.Thread(target=self._hand_over, name="markers", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def troubles(self) -> tuple[str, ...]:
        """The reason why markers do not go out, in a sentence; none while they do."""
        lost = f" {self._lost} markers did not go out." if self._lost else ""
        return (self._trouble + lost,) if self._trouble else ()

    def stamping(self, clocks: Callable[[], Clocks]) -> Callable[[], Clocks]:
        """Return clocks that tell LSL's time as well."""

        def stamped() -> Clocks:
            return replace(clocks(), lsl=None if self._clock is None else self._clock())

        return stamped

    def push(self, logged: LoggedEvent) -> None:
        """Send the marker of an event that is in the log; returns at once, and raises nothing."""
        if self._clock is None or self._trouble:
            self._lost += self._wanted
        elif self._waiting.qsize() >= MOST_WAITING:
            self._lost += 1
            self._trouble = "Markers: liblsl takes none any more. Begin the study's program anew."
        else:
            stamp = logged.event.clocks.lsl
            self._waiting.put((_sample(logged), self._clock() if stamp is None else stamp))

    def close(self, timeout: float = 2.0) -> None:
        """Send what waits, and end the stream; what takes longer than some seconds is given up."""
        self._waiting.put(None)
        if self._clock is not None:
            self._thread.join(timeout)

    def _hand_over(self) -> None:
        try:
            import pylsl  # noqa: PLC0415

            info = pylsl.StreamInfo(STREAM, STREAM_TYPE, 1, pylsl.IRREGULAR_RATE, pylsl.cf_string, self.source)
            info.desc().append_child_value("study", self._study)
            info.desc().append_child("channels").append_child("channel").append_child_value("label", "event as JSON")
            outlet = pylsl.StreamOutlet(info)
            while (waiting := self._waiting.get()) is not None:
                text, stamp = waiting
                outlet.push_sample([text], stamp)
        except Exception as error:
            self._trouble = f"Markers: {_first_line(error)}. Begin the study's program anew."
            self._lost = 1
            while not self._waiting.empty():
                self._lost += self._waiting.get() is not None


def _sample(logged: LoggedEvent) -> str:
    event, clocks = logged.event, logged.event.clocks
    told = {
        "sequence": logged.sequence,
        "kind": event.kind,
        "participant": event.participant,
        "step": event.step,
        "condition": event.condition,
        "wall": clocks.wall,
        "monotonic_ns": clocks.monotonic_ns,
        "simulated": clocks.simulated,
    }
    return json.dumps(told, ensure_ascii=False)


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0].rstrip(".")
