"""Requests of the researcher to the kiosk, and what the desk shows of it."""

from collections.abc import Callable

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor, unfinished
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.events import LoggedEvent, RunState
from ui.hosting.kiosk import words
from ui.hosting.kiosk.pages import KioskPages


class HostedStudy:
    """The kiosk as the researcher's desk sees and steers it; see `StudyUnderWay`.

    Args:
        conductor: of the study's log.
        pages: of the kiosk.

    Attributes:
        changed: called after each event of the log, and when `kiosk` or `troubles` are others.
    """

    def __init__(self, conductor: Conductor, pages: KioskPages) -> None:
        self.changed: Callable[[], None] = lambda: None
        self._conductor = conductor
        self._pages = pages
        pages.changed = self._tell
        conductor.listeners.append(self._tell)

    def _tell(self, *_event: LoggedEvent) -> None:
        self.changed()

    @property
    def progress(self) -> Progress:
        """Places and steps of everybody."""
        return self._conductor.progress

    @property
    def kiosk(self) -> str:
        """The page that is shown, in words."""
        return f"{self._pages.person}: {self._pages.shown}" if self._pages.person else self._pages.shown

    @property
    def troubles(self) -> tuple[str, ...]:
        """Sentences about what somebody has to look at."""
        troubles = []
        if self._pages.looks_away and self._pages.person:
            troubles.append("At the kiosk, keys and clicks go to another window.")
        if self._pages.lag:
            troubles.append(words.LAGS.format(self._pages.lag))
        return tuple(troubles)

    def admit_next(self) -> str | None:
        """Begin the run of the next person; else return why that cannot be."""
        if under_way := unfinished(self.progress):
            return f"{under_way[0].participant} is still under way."
        if isinstance(place := self.progress.next_place(), NoPlace):
            return words.NO_PLACE_TOLD[place]
        self._pages.admits = True
        self._pages.wake()
        return None

    def note(self, text: str, participant: str) -> str | None:
        """Take down words of the researcher."""
        self._conductor.note(text, participant)
        return None

    def exclude(self, participant: str, reason: str) -> str | None:
        """Decide that a run does not count; whoever is in it is told that it ends."""
        if participant not in self.progress.runs:
            return f"Nobody is called {participant}."
        if self.progress.runs[participant].state is RunState.EXCLUDED:
            return f"{participant} is excluded already."
        if other := self._other_in(reason, participant):
            return words.NAMES_OTHER.format(other)
        self._conductor.exclude(participant, reason)
        self._pages.wake()
        return None

    def end_run(self, participant: str, reason: str) -> str | None:
        """End a run: the person went, or cannot go on."""
        run = self.progress.runs.get(participant)
        if run is None or run.state is not RunState.UNDER_WAY:
            return f"{participant} is not under way."
        if other := self._other_in(reason, participant):
            return words.NAMES_OTHER.format(other)
        self._conductor.leave(participant, reason, actor="experimenter")
        self._pages.wake()
        return None

    def busy_with(self, participant: str) -> str | None:
        """Return why a participant cannot withdraw now: they are still at the kiosk."""
        run = self.progress.runs.get(participant)
        if participant == self._pages.person or (run is not None and run.state is RunState.UNDER_WAY):
            return f"{participant} is still at the kiosk. End the run first, and let the last page be left."
        return None

    def _other_in(self, reason: str, participant: str) -> str | None:
        """Return who else is named in a reason, which stays when they withdraw."""
        return next((other for other in self.progress.runs if other in reason and other != participant), None)
