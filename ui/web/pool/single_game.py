"""Game of a study file, for one visitor or several."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app import play as hunt
from thbridge.app.compose.game import build_participant
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import HuntUnfinished, PlayOptions
from thbridge.app.session.session import TickRecord
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.errors import BadFile
from thbridge.roles.participant.tabui import TabUI
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.study_file import Study
from ui.command_line.settings import setting_of
from ui.hosting.games import practice_setting
from ui.web.page.patches import Json
from ui.web.pool.messages import GamePassed
from ui.web.pool.worker import TICKS_AT_ONCE, PeopleInGame


@dataclass(frozen=True, slots=True)
class SingleGame:
    """Game of a study file; see `GameRequest`.

    Attributes:
        study: the study.
        file: its file, for relative paths.
        bag: path of the recording; None for no recording.
        practice: True for the practice game.
        consents: see `GameRequest`.
        max_seconds: simulated seconds after which the game is stopped.
        once: True because another page follows the game.
        programs: see `GameRequest`.
    """

    study: Study
    file: Path | None
    bag: Path | None
    practice: bool
    consents: Mapping[str, str]
    max_seconds: float
    once: bool = True
    programs: frozenset[str] = frozenset()

    @property
    def windows(self) -> frozenset[str]:
        """See `GameRequest`. People play games of a study file in browsers."""
        return frozenset()

    @property
    def joins_next(self) -> bool:
        """See `GameRequest`."""
        return False

    def texts(self) -> Texts:
        """See `GameRequest`."""
        return setting_of(self.study, self.file).texts

    def participant(self, seat: str) -> TabUI:
        """See `GameRequest`."""
        return build_participant(self._setting(), seat)

    async def play(self, people: PeopleInGame) -> Json:
        """Play the game; return its score, and the reason for its end."""
        setting = self._setting()
        inputs = None if self.bag is None else self.bag.with_suffix(".inputs")
        options = PlayOptions(
            setting.study.rate or 1.0,
            self.bag,
            frozenset(),
            "",
            self.max_seconds,
            left=people.have_left,
            inputs=inputs,
            checkpoints=people.checkpoints,
            ticks_at_once=TICKS_AT_ONCE,
            seats=frozenset(self.consents) | self.programs,
        )

        def progress(moment: TickRecord) -> None:
            if moment.tick % TICKS_PER_SECOND == 0:
                people.report(GamePassed(moment.tick * TICK, 0.0, 0.0))

        def ready(where: ListeningAddress | CannotListen) -> None:
            if isinstance(where, CannotListen):
                raise BadFile(self.file or Path("study"), str(where), "write server.port: 0")
            people.ready(where)

        try:
            outcome = await hunt.play(setting, (), options, ready, progress)
        except HuntUnfinished as early:
            outcome = early.outcome
        return {"score": outcome.score, "over": outcome.over}

    def _setting(self) -> StudySetting:
        # Many games run on one machine, so each takes any free port.
        server = replace(self.study.server, host="127.0.0.1", port=0)
        setting = setting_of(replace(self.study, server=server), self.file)
        return practice_setting(setting) if self.practice else setting
