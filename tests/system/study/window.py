"""A kiosk's window without a screen, for simulated people: `python -m tests.system.study.window FOLDER LEDGER`.

It speaks the messages of the real window, plays games by the real link, and answers as `rehearsal.yaml` says: by who
somebody is and where they are alone, so that a window opened anew does what the one before would have done. All that
it was shown and all answers that it was told are kept go into the ledger, a line of JSON each.
"""

import json
import os
import sys
import threading
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from sim.numerics import noise
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.setting import StudySetting
from thbridge.batch.settings import SettingCache
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.questionnaires.form import Item
from thbridge.experiment.rehearsal.people import normal, read_people
from thbridge.experiment.store.event_log import LogFollower
from thbridge.experiment.trials import setting_of_trial
from thbridge.files.language_texts import shipped_texts
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.shared.view import View
from ui.hosting.kiosk.answer_conversion import to_answer
from ui.model.kiosk import (
    KIOSK,
    Answer,
    AnswerKept,
    CloseKiosk,
    ConsentReply,
    ConsentToAsk,
    FormToFill,
    FromKiosk,
    GameNews,
    GamePrepared,
    GameRecorded,
    GameSeenOver,
    GameToJoin,
    InstructionsSoFar,
    ItemNews,
    KioskClosed,
    StoppedTakingPart,
    StudyTexts,
    TextToRead,
    ToKiosk,
    WentOn,
)
from ui.windows.link import ParticipantLink

SEED = 7
FULL = shipped_texts().text("kiosk.full")


class Somebody:
    """The person at the window: who they are stands in the log, as people know it of themselves."""

    def __init__(self, folder: ExperimentFolder) -> None:
        self.design = folder.read()
        self._people = read_people(folder.people, self.design)
        self._follower = LogFollower(folder.log)
        self._progress = Progress(self.design)
        self.settings = SettingCache(self.design.beside)

    def look_up(self) -> None:
        self._follower.poll()
        self._progress = self._progress.after(self._follower.entries[self._progress.sequence :])

    @property
    def run(self) -> Run:
        return list(self._progress.runs.values())[-1]

    @property
    def attempt(self) -> int:
        return self.run.begun.get(self.run.step, 0)

    def _chance(self, *names: str) -> Callable[[], int]:
        return noise.key(SEED, str(len(self._progress.runs)), str(self.run.step), str(self.attempt), *names)

    def leaves(self) -> bool:
        return noise.uniform(self._chance("leaves"), 0, 0) < self._people.drop_out

    def answer(self, name: str) -> Answer:
        run, counter = self.run, iter(range(1, 100))
        step = run.plan[run.step - 1]
        item: Item = next(item for item in self.design.forms[step.index].items if item.id == name)
        stream, manner = self._chance(name), noise.key(SEED, "manner", str(len(self._progress.runs)), step.name)
        within = {} if step.condition is None else self.design.conditions[step.condition].levels
        levels = {**self.design.cells[run.place.cell].levels, **within}
        return to_answer(
            self._people.answer(
                item,
                levels,
                normal(manner),
                lambda: float(noise.uniform(stream, next(counter), 0)),
                lambda: normal(stream, next(counter)),
            )
        )


class ShownGame:
    """A game that is played in the window, by a thread beside it."""

    def __init__(self, page: GameToJoin, setting: StudySetting, say: Callable[[FromKiosk], None]) -> None:
        self._link = ParticipantLink(page.host, page.port, page.token)
        self._bot = build_bot(setting.templates, BotStrategy.NEAREST, setting.study.seed)
        self._page, self._say = page.page, say
        self._ended = threading.Event()
        self._link.start()
        threading.Thread(target=self._play, daemon=True).start()

    def _play(self) -> None:
        over = False
        while not self._ended.wait(0.02):
            for received in self._link.take_events():
                if isinstance(received.event, View):
                    self._link.request(tuple(self._bot.requests(received.event)))
                    if received.event.over is not None and not over:
                        over = True
                        self._say(GameSeenOver(self._page))

    def close(self) -> None:
        self._ended.set()
        self._link.stop()


class Window:
    """Shows pages; the person answers each item once the one before is kept."""

    def __init__(self, folder: Path, ledger: Path) -> None:
        self._ledger = os.open(ledger, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
        self.note(opened=os.getpid())
        self._somebody = Somebody(ExperimentFolder(folder))
        self._game: ShownGame | None = None
        self._page = 0
        self._left: list[str] = []
        self._given = False
        self._writing = threading.Lock()

    def note(self, **told: object) -> None:
        os.write(self._ledger, json.dumps(told).encode() + b"\n")

    def say(self, message: FromKiosk) -> None:
        with self._writing:
            sys.stdout.buffer.write(KIOSK.encode(message))
            sys.stdout.buffer.flush()

    def run(self, lines: Iterable[bytes]) -> None:
        for line in lines:
            message = KIOSK.decode_from_host(line)
            if isinstance(message, CloseKiosk):
                self.say(KioskClosed())
                return
            self._somebody.look_up()
            if isinstance(message, AnswerKept):
                self._kept(message)
            elif not isinstance(message, GameNews | InstructionsSoFar | StudyTexts):
                self._shown(message)

    def _kept(self, message: AnswerKept) -> None:
        run = self._somebody.run
        self.note(kept=message.item, answer=message.answer, participant=run.participant, step=run.step)
        if message.page != self._page or not self._left or message.item != self._left[0]:
            return
        if self._given:
            self._left.pop(0)
            self._go_on()
        else:
            self._given = True
            self._tell("given", message.answer)

    def _go_on(self) -> None:
        """Answer the next item, or leave the page."""
        if not self._left:
            self.say(WentOn(self._page))
            return
        self._given = False
        self._tell("shown")
        self._tell("touched")
        self._tell("changed", self._somebody.answer(self._left[0]))

    def _tell(self, what: str, answer: Answer = None) -> None:
        self.say(ItemNews(self._page, self._left[0], what, time.monotonic_ns(), answer))

    def _shown(self, message: ToKiosk) -> None:
        if self._game is not None:
            self._game.close()
            self._game = None
        self._page = message.page
        progress = getattr(message, "progress", None)
        if isinstance(message, GameToJoin) or progress.steps:
            run = self._somebody.run
            told = getattr(message, "heading", "") or getattr(message, "title", "") or getattr(message, "sentence", "")
            self.note(
                page=type(message).__name__,
                told=told,
                participant=run.participant,
                step=run.step,
                attempt=self._somebody.attempt,
                items=[item.id for item in message.items] if isinstance(message, FormToFill) else [],
                answers=message.answers if isinstance(message, FormToFill) else {},
            )
        match message:
            case TextToRead(heading=heading) if heading == FULL:
                self.say(KioskClosed())
            case TextToRead(button=button) if button != "":
                self.say(WentOn(message.page))
            case ConsentToAsk():
                self.say(ConsentReply(message.page, True, time.monotonic_ns()))
            case FormToFill() if self._somebody.leaves():
                self.say(StoppedTakingPart())
            case FormToFill():
                self._left = [item.id for item in message.items if item.id not in message.answers]
                self._go_on()
            case GamePrepared():
                pass
            case GameToJoin():
                run, design = self._somebody.run, self._somebody.design
                setting = setting_of_trial(design, self._somebody.settings, run, run.plan[run.step - 1])
                self._game = ShownGame(message, setting, self.say)
            case GameRecorded():
                self.say(WentOn(message.page))


if __name__ == "__main__":
    Window(Path(sys.argv[1]), Path(sys.argv[2])).run(sys.stdin.buffer)
