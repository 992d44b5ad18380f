"""Game of a study with people: a trial or a practice game of one person or of a group."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from thbridge.app.compose.game import build_participant
from thbridge.app.compose.setting import texts_of
from thbridge.batch.settings import SettingCache
from thbridge.dialogue.wording.texts import Texts
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Run
from thbridge.experiment.store.events import FrontEnd
from thbridge.experiment.trials import setting_of_practice, setting_of_trial
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from ui.hosting.kiosk.games import StudyGames
from ui.web.page.patches import Json, tree
from ui.web.pool.messages import GamePassed, RecordingBrokenOff, RecordingCutOff, StillToDo, TimeIsUp
from ui.web.pool.worker import TICKS_AT_ONCE, PeopleInGame

PASSED_PERIOD = 0.5
"""Simulated seconds between two reports of the times of a game."""


@dataclass(frozen=True, slots=True)
class StudyGame:
    """Game of a person or a group in a study; see `GameRequest`.

    Attributes:
        folder: folder of the study.
        run: run of the person, or of a person of the group.
        step: step of the game.
        practice: True for a practice game.
        goes_on: True to resume a game that an earlier worker began.
        consents: see `GameRequest`.
        group: id of the group; empty for a game with one participant.
        programs: see `GameRequest`.
        once: True because another step follows.
        windows: see `GameRequest`.
    """

    folder: Path
    run: Run
    step: PlannedStep
    practice: bool
    goes_on: bool
    consents: Mapping[str, str]
    group: str = ""
    programs: frozenset[str] = frozenset()
    once: bool = True
    windows: frozenset[str] = frozenset()

    @property
    def joins_next(self) -> bool:
        """See `GameRequest`."""
        return False

    def participant(self, seat: str) -> TabUI:
        """See `GameRequest`."""
        design = ExperimentFolder(self.folder).read()
        settings = SettingCache(design.beside)
        trial = None if self.practice else setting_of_trial(design, settings, self.run, self.step)
        return build_participant(trial or setting_of_practice(design, settings, self.run, self.step), seat)

    def texts(self) -> Texts:
        """See `GameRequest`."""
        design = ExperimentFolder(self.folder).read()
        return texts_of(design.study, design.beside)

    async def play(self, people: PeopleInGame) -> Json:
        """Play the game; return its entry in the log, or the counts of a practice game."""
        folder = ExperimentFolder(self.folder)
        games = StudyGames(folder, folder.read(), people.checkpoints, people.watch, TICKS_AT_ONCE)
        watcher = _PeopleWatcher(people)
        if self.practice:
            count = await games.practise(self.run, self.step, watcher)
            missing: dict[str, Json] = {str(term): number for term, number in count.missing.items()}
            return {"data": tree(count.data), "missing": missing}
        seats = frozenset(self.consents) | self.programs
        return tree(await games.play(self.run, self.step, watcher, goes_on=self.goes_on, group=self.group, seats=seats))


class _PeopleWatcher:
    """Watcher of a game that passes everything on to the gateway; see `GameWatcher` for the methods."""

    def __init__(self, people: PeopleInGame) -> None:
        self._people = people
        self._passed = -PASSED_PERIOD
        self._missing: dict[str, float] | None = None

    def ready(self, where: ListeningAddress) -> None:
        self._people.ready(where)

    def passed(self, seconds: float, lag: float, left: float) -> None:
        if seconds - self._passed >= PASSED_PERIOD:
            self._passed = seconds
            self._people.report(GamePassed(seconds, lag, left))

    def still_to_do(self, missing: Mapping[PracticeTerm, float]) -> None:
        named = {str(term): float(number) for term, number in missing.items()}
        if named != self._missing:
            self._missing = named
            self._people.note(StillToDo(named))

    def time_is_up(self) -> None:
        self._people.note(TimeIsUp())

    def has_left(self) -> bool:
        return self._people.have_left()

    def has_seen_end(self) -> bool:
        return self._people.have_seen_end()

    def broken_off(self, bag: Path | None) -> None:
        self._people.note(RecordingBrokenOff(None if bag is None else str(bag)))

    def cut_off(self, bag: Path) -> None:
        self._people.note(RecordingCutOff(str(bag)))


def seats_at_windows(runs: Mapping[str, Run]) -> frozenset[str]:
    """Return the names of the seats whose people take part at a window; `runs` are the runs of all seats."""
    return frozenset(seat for seat, run in runs.items() if run.front_end == FrontEnd.WINDOW)
