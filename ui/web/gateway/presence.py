"""Presence of people in a study: absences and connections are logged, and the study's rule ends absent runs."""

import asyncio
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from thbridge.experiment.conductor import Conductor, unfinished
from thbridge.experiment.design.presence import AbsenceRule, PresenceSection
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import EventKind, FrontEnd, JsonValue
from thbridge.files.errors import BadFile
from ui.hosting.kiosk.pages import KioskPages
from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.people import Visitor

LOOK_PERIOD = 1.0
"""Seconds between two looks at all people."""
NOTICED = 6.0
"""Seconds without an answer of a visible page after which a person counts as absent: about three heartbeats."""
MEASURED = 30.0
"""Seconds between two events about a person's connection, unless another step begins."""
GAMES = {StepKind.TRIAL, StepKind.PRACTICE}


@dataclass(frozen=True, slots=True)
class PersonHere:
    """Person who has opened the study since the gateway was started.

    Attributes:
        visitor: the visitor.
        pages: pages of their course.
    """

    visitor: Visitor
    pages: KioskPages

    @property
    def window(self) -> BrowserWindow:
        """Browser of the person."""
        return self.visitor.window


def absence_of(here: PersonHere | None, began: float, now: float) -> float:
    """Return for how many seconds a person has been absent.

    Args:
        here: the person; None if they have not opened the study since the gateway was started.
        began: monotonic time of this start.
        now: monotonic time now.
    """
    return now - (began if here is None else here.visitor.present_at)


class PresenceWatch:
    """Watch over all people of a study who take part in browsers, also those whose browsers have not come back yet.

    Args:
        section: section of the study's file.
        conductor: conductor of the study.
        here: people who have opened the study since the gateway was started, by their ids.
        report: function that receives sentences about problems, for the researcher.
    """

    def __init__(
        self,
        section: PresenceSection,
        conductor: Conductor,
        here: Mapping[str, PersonHere],
        report: Callable[[str], None],
    ) -> None:
        self._section = section
        self._conductor = conductor
        self._here = here
        self._report = report
        # People who had begun before the gateway was started are absent from its start on.
        self._began = time.monotonic()
        self._absent: dict[str, float] = {}
        self._measured: dict[str, tuple[float, int]] = {}

    async def run(self) -> None:
        """Look at all people until cancelled, or until the log cannot be written."""
        try:
            while True:
                now = time.monotonic()
                for run in unfinished(self._conductor.progress):
                    if run.front_end == FrontEnd.BROWSER:
                        self._look(run, now)
                await asyncio.sleep(LOOK_PERIOD)
        except BadFile as bad:
            self._report(str(bad))

    def _look(self, run: Run, now: float) -> None:
        participant = run.participant
        here = self._here.get(participant)
        absence = absence_of(here, self._began, now)
        present_at = now - absence
        if absence < NOTICED:
            if (since := self._absent.pop(participant, None)) is not None:
                self._tell(EventKind.PRESENT, run, here, {"seconds": round(present_at - since, 1)})
            if here is not None:
                self._measure(run, here, now)
            return
        if participant not in self._absent:
            self._absent[participant] = present_at
            connected = here is not None and here.visitor.live is not None
            self._tell(EventKind.ABSENT, run, here, {"seconds": round(absence, 1), "connected": connected})
        step = self._conductor.progress.next_step(participant)
        grace = self._section.grace if step is not None and step.entry.step in GAMES else self._section.page_grace
        if self._section.then is AbsenceRule.END and absence >= grace:
            self._conductor.leave(participant, f"absent for more than {grace:g} s", absent=True, actor="program")
            if here is not None:
                here.pages.wake()

    def _measure(self, run: Run, here: PersonHere, now: float) -> None:
        """Log the round-trip time if another step has begun, or if the last event is old."""
        at, step = self._measured.get(run.participant, (-math.inf, 0))
        if here.visitor.round_trip is None or (now - at < MEASURED and step == run.step):
            return
        self._measured[run.participant] = (now, run.step)
        greatest, here.visitor.greatest_round_trip = here.visitor.greatest_round_trip, 0.0
        self._tell(EventKind.CONNECTION_MEASURED, run, here, {"greatest_round_trip_ms": round(greatest, 1)})

    def _tell(self, kind: EventKind, run: Run, here: PersonHere | None, data: dict[str, JsonValue]) -> None:
        measured = None if here is None else here.visitor.round_trip
        data["round_trip_ms"] = None if measured is None else round(measured, 1)
        step = self._conductor.progress.next_step(run.participant) if run.under_way else None
        if step is None:
            self._conductor.tell_of_run(kind, run.participant, data, "program")
        else:
            self._conductor.tell(kind, run.participant, step, data, "program")
