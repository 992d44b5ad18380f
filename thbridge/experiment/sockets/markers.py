"""Markers for other recorders: each event of a study's log is sent as a sample of the Lab Streaming Layer.

The stream has the type Markers and one channel of text, at no regular rate. A sample is JSON: sequence, kind,
participant, step, condition and the clocks of the event. Its time is `local_clock()`, which is also in the log. Answers
are not sent.

Recorders cannot delay a study: a separate thread passes samples to liblsl, and all its errors are reported as
troubles.
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
"""Name and type of the stream."""
MOST_WAITING = 2000
"""Largest number of markers waiting to be sent; when it is reached, new markers are dropped."""
INSTALL = "Install it: pip install 'thbridge[markers]'"
LIBRARY = "Install liblsl 1.16 or newer for this system, and name its file in the environment variable PYLSL_LIB"


def why_no_markers() -> str:
    """Return a sentence on why no markers can be sent from here, or an empty text if they can."""
    try:
        # Without markers, neither the package nor the library needs to be installed.
        import pylsl  # noqa: F401, PLC0415
    except ImportError:
        return f"Markers: pylsl is not installed. {INSTALL}."
    except (RuntimeError, OSError) as error:
        return f"Markers: liblsl cannot be loaded ({_first_line(error)}). {LIBRARY}."
    return ""


class MarkerStream:
    """Markers of one study, from the object's creation until it is closed.

    Args:
        study: title of the study.
        wanted: False for a study without markers; then nothing is loaded and nothing is sent.

    Attributes:
        source: source id of the stream, by which recorders find it again after the program restarts.
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
        """The reason why markers are not sent, in a sentence; empty while markers are sent."""
        lost = f" {self._lost} markers were not sent." if self._lost else ""
        return (self._trouble + lost,) if self._trouble else ()

    def stamping(self, clocks: Callable[[], Clocks]) -> Callable[[], Clocks]:
        """Return clocks that also give LSL's time."""

        def stamped() -> Clocks:
            return replace(clocks(), lsl=None if self._clock is None else self._clock())

        return stamped

    def push(self, logged: LoggedEvent) -> None:
        """Send the marker of a logged event. Returns at once and raises nothing."""
        if self._clock is None or self._trouble:
            self._lost += self._wanted
        elif self._waiting.qsize() >= MOST_WAITING:
            self._lost += 1
            self._trouble = "Markers: LSL no longer accepts markers. Restart the study program."
        else:
            stamp = logged.event.clocks.lsl
            self._waiting.put((_sample(logged), self._clock() if stamp is None else stamp))

    def close(self, timeout: float = 2.0) -> None:
        """Send the waiting markers and end the stream; give up after `timeout` seconds."""
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
            self._trouble = f"Markers: {_first_line(error)}. Restart the study program."
            self._lost = 1
            while not self._waiting.empty():
                self._lost += self._waiting.get() is not None


def _sample(logged: LoggedEvent) -> str:
    event, clocks = logged.event, logged.event.clocks
    sample = {
        "sequence": logged.sequence,
        "kind": event.kind,
        "participant": event.participant,
        "step": event.step,
        "condition": event.condition,
        "wall": clocks.wall,
        "monotonic_ns": clocks.monotonic_ns,
        "simulated": clocks.simulated,
    }
    return json.dumps(sample, ensure_ascii=False)


def _first_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0].rstrip(".")
