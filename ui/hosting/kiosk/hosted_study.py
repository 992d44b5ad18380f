"""Interface between the kiosk and the researcher's desk: requests of the desk, and the state that the desk shows."""

from collections.abc import Callable

from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.events import FrontEnd, LoggedEvent, RunState
from thbridge.files.language_texts import shipped_texts
from ui.hosting.kiosk import words
from ui.hosting.kiosk.pages import KioskPages
from ui.hosting.kiosk.study_actions import StudyActions


def runs_at_kiosk(progress: Progress) -> list[Run]:
    """Return the runs of people at the kiosk. People in browsers may take part in the same study."""
    return [run for run in progress.runs.values() if run.front_end != FrontEnd.BROWSER]


def unfinished_at_kiosk(progress: Progress) -> list[Run]:
    """Return the runs of people at the kiosk that can be resumed."""
    return [run for run in runs_at_kiosk(progress) if run.state is RunState.UNDER_WAY]


class HostedStudy:
    """Interface of the kiosk for the researcher's desk; see `StudyUnderWay`.

    Args:
        conductor: conductor of the study.
        pages: pages of the kiosk.

    Attributes:
        changed: function that is called after each event of the log, and when `kiosk` or `troubles` change.
    """

    def __init__(self, conductor: Conductor, pages: KioskPages) -> None:
        self.changed: Callable[[], None] = lambda: None
        self._conductor = conductor
        self._pages = pages
        self._actions = StudyActions(conductor, shipped_texts(), lambda _: pages.wake())
        pages.changed = self._notify
        conductor.listeners.append(self._notify)

    def _notify(self, *_event: LoggedEvent) -> None:
        self.changed()

    @property
    def progress(self) -> Progress:
        """Places and steps of all participants."""
        return self._conductor.progress

    @property
    def kiosk(self) -> str:
        """Description of the page that is shown."""
        return f"{self._pages.person}: {self._pages.shown}" if self._pages.person else self._pages.shown

    @property
    def troubles(self) -> tuple[str, ...]:
        """Sentences about problems that a person must look at."""
        troubles = []
        if self._pages.looks_away and self._pages.person:
            troubles.append("Another window at the kiosk receives keys and clicks. Click into the kiosk's window.")
        if self._pages.lag:
            troubles.append(words.LAGS.format(self._pages.lag))
        return tuple(troubles)

    def admit_next(self) -> str | None:
        """Begin the run of the next person; return a sentence if this is not possible."""
        if under_way := unfinished_at_kiosk(self.progress):
            return f"{under_way[0].participant} is still in the study."
        if isinstance(place := self.progress.next_place(), NoPlace):
            return words.NO_PLACE_TOLD[place]
        self._pages.admits = True
        self._pages.wake()
        return None

    def note(self, text: str, participant: str) -> str | None:
        """Record a note of the researcher."""
        self._conductor.note(text, participant)
        return None

    def exclude(self, participant: str, reason: str) -> str | None:
        """Exclude a run from the data. If the run is still under way, it ends, and the person is informed."""
        return self._actions.exclude(participant, reason)

    def end_run(self, participant: str, reason: str) -> str | None:
        """End a run, because the person left or cannot continue."""
        return self._actions.end_run(participant, reason)

    def busy_with(self, participant: str) -> str | None:
        """Return a sentence if a participant cannot withdraw, because they are at the kiosk; otherwise None."""
        run = self.progress.runs.get(participant)
        if participant == self._pages.person or (run is not None and run.state is RunState.UNDER_WAY):
            return f"{participant} is still at the kiosk. End the run first, then leave its last page."
        return None
