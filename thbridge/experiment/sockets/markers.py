"""Markers for other recording programs: each event of a study's log is sent as a Lab Streaming Layer (LSL) sample.

The stream has the type Markers, one channel of text and an irregular rate. A sample is JSON with the sequence number,
kind, participant, step, condition and clocks of the event. The time of the sample is `local_clock()`; the log contains
this time, too. Answers are not sent.

Recording programs cannot delay a study: a separate thread passes samples to liblsl. The property `troubles` reports all
errors of this thread.
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
"""Maximum number of unsent markers. Above this number, new markers are dropped."""
INSTALL = "Install pylsl: pip install 'thbridge[markers]'"
LIBRARY = "Install liblsl 1.16 or newer, and write the path of its file into the environment variable PYLSL_LIB"


def why_no_markers() -> str:
    """Return the reason why this program cannot send markers, as a sentence, or an empty text if it can."""
    try:
        # The package and the library are optional.
        import pylsl  # noqa: F401, PLC0415
    except ImportError:
        return f"Markers: pylsl is not installed. {INSTALL}."
    except (RuntimeError, OSError) as error:
        return f"Markers: liblsl cannot be loaded ({_first_line(error)}). {LIBRARY}."
    return ""


class MarkerStream:
    """Sender of the markers of one study. It sends markers until `close` is called.

    Args:
        study: title of the study.
        wanted: False for a study without markers. Then liblsl is not loaded, and no markers are sent.

    Attributes:
        source: source id of the stream. With this id, recording programs find the stream again after a restart.
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
        """Sentence with the reason why markers are not sent. Empty if markers are sent."""
        lost = f" {self._lost} markers were not sent." if self._lost else ""
        return (self._trouble + lost,) if self._trouble else ()

    def stamping(self, clocks: Callable[[], Clocks]) -> Callable[[], Clocks]:
        """Return a function that adds LSL's time to the clocks."""

        def stamped() -> Clocks:
            return replace(clocks(), lsl=None if self._clock is None else self._clock())

        return stamped

    def push(self, logged: LoggedEvent) -> None:
        """Send the marker of a logged event, without waiting and without exceptions."""
        if self._clock is None or self._trouble:
            self._lost += self._wanted
        elif self._waiting.qsize() >= MOST_WAITING:
            self._lost += 1
            self._trouble = "Markers: LSL no longer accepts markers. Restart the study program."
        else:
            stamp = logged.event.clocks.lsl
            self._waiting.put((_sample(logged), self._clock() if stamp is None else stamp))

    def close(self, timeout: float = 2.0) -> None:
        """Send all unsent markers and end the stream. Give up after `timeout` seconds."""
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
