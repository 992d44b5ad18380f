"""Running study with people, read from its folder."""

from collections.abc import Callable

from thbridge.app.compose.machine import versions
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import deviations
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import LogFollower
from thbridge.experiment.store.events import Tombstone
from thbridge.files.errors import BadFile
from ui.model.desk.messages import DeskState
from ui.model.desk.state import ToldToDesk, desk_state


class ExperimentSource:
    """Reader that follows a study's log and returns the state that the desk shows.

    Args:
        folder: folder of the study.
        now: function that returns the date and time of day, ISO 8601 in UTC.

    Attributes:
        folder: folder of the study.

    Raises:
        BadFile: the design cannot be read.
    """

    def __init__(self, folder: ExperimentFolder, now: Callable[[], str]) -> None:
        self.folder = folder
        self._now = now
        self._design = folder.read()
        self._follower = LogFollower(folder.log)
        self._progress = Progress(self._design)
        self._trouble = ""
        self._changed: tuple[str, ...] | None = None
        self._look_at_freeze()

    def poll(self) -> bool:
        """Read new entries of the log; return False if there are none."""
        known = len(self._follower.entries)
        try:
            if not self._follower.poll():
                return False
            entries = self._follower.entries
            gone = any(isinstance(entry, Tombstone) for entry in entries)
            grown = self._progress.sequence == known <= len(entries) and not gone and not self._trouble
            people = len(self._progress.runs)
            self._progress = self._progress.after(entries[known:]) if grown else Progress(self._design).after(entries)
            self._trouble = ""
            if people != len(self._progress.runs):
                self._look_at_freeze()
        except BadFile as fault:
            self._trouble = str(fault)
        return True

    def state(self, shown: str, kiosk: str = "", troubles: tuple[str, ...] = (), read_only: str = "") -> DeskState:
        """Return the state that the desk shows; see `ToldToDesk` for the arguments."""
        troubles = (self._trouble, *troubles) if self._trouble else troubles
        inputs = ToldToDesk(self._now(), self._changed, kiosk, troubles, shown, read_only)
        return desk_state(self._design, self._progress, self._follower.entries[: self._progress.sequence], inputs)

    def _look_at_freeze(self) -> None:
        """Compare the study with its frozen fingerprint, which requires reading all files that it covers."""
        self._changed = deviations(self.folder, versions())
