"""Actions of the researcher in a running study, for the desk of the kiosk and for the desk of the gateway."""

from collections.abc import Callable

from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.store.events import RunState


class StudyActions:
    """Actions that change runs. Each method returns a sentence if it refuses the action, otherwise None.

    Args:
        conductor: conductor of the study.
        texts: texts of the researcher's language.
        wake: function that makes the course of a participant look at their run again.
    """

    def __init__(self, conductor: Conductor, texts: Texts, wake: Callable[[str], None]) -> None:
        self._conductor = conductor
        self._texts = texts
        self._wake = wake

    def exclude(self, participant: str, reason: str, author: str = "") -> str | None:
        """Exclude a run from the data. If the run is still under way, it ends, and the person is informed."""
        runs = self._conductor.progress.runs
        if participant not in runs:
            return self._texts.text("desk.no_participant", participant=participant)
        if runs[participant].state is RunState.EXCLUDED:
            return self._texts.text("desk.already_excluded", participant=participant)
        if other := self.other_in(reason, participant):
            return self._texts.text("desk.names_other", participant=other)
        self._conductor.exclude(participant, reason, author)
        self._wake(participant)
        return None

    def end_run(self, participant: str, reason: str, author: str = "") -> str | None:
        """End a run, because the person left or cannot continue."""
        run = self._conductor.progress.runs.get(participant)
        if run is None or run.state is not RunState.UNDER_WAY:
            return self._texts.text("desk.not_under_way", participant=participant)
        if other := self.other_in(reason, participant):
            return self._texts.text("desk.names_other", participant=other)
        self._conductor.leave(participant, reason, actor="experimenter", author=author)
        self._wake(participant)
        return None

    def other_in(self, text: str, participant: str) -> str | None:
        """Return another participant whose id is in a text. The text is kept even if that person withdraws."""
        runs = self._conductor.progress.runs
        return next((other for other in runs if other in text and other != participant), None)
