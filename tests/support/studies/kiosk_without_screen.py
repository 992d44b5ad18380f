"""Laboratory without a screen: a window that exchanges the kiosk's messages, a person at it, and games that end at
once.

A test can let the program die at any event.
"""

import asyncio
import itertools
import random
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

from thbridge.app.compose.recording import build_writer
from thbridge.batch.hunt import play_hunt
from thbridge.batch.settings import SettingCache
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.design.steps import PracticeTerm
from thbridge.experiment.progress import Progress, Run
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import LoggedEvent, NewEvent
from thbridge.experiment.trials import PracticeCount, played, setting_of_practice, setting_of_trial
from thbridge.files.language_texts import shipped_texts
from thbridge.sockets.addresses import ListeningAddress
from ui.hosting.kiosk.game_steps import GamesOfStudy, StudyClock
from ui.hosting.kiosk.host import KioskHost
from ui.model.kiosk import (
    KIOSK,
    Answer,
    CloseKiosk,
    ConsentReply,
    ConsentToAsk,
    FormItem,
    FormToFill,
    FromKiosk,
    GameRecorded,
    ItemNews,
    KioskClosed,
    StudyTexts,
    TextToRead,
    ToKiosk,
    WentOn,
)

TEXTS = shipped_texts()
STUDY = """\
title: A small study
seed: 5
quota: 2
steps:
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice}
  - {step: check, form: understood.yaml, attempts: 2, repeat: practice}
  - {step: trial, name: first}
  - {step: form, form: feelings.yaml, name: feelings}
  - {step: trial, name: second}
  - {step: form, form: final.yaml, name: final}
  - {step: debrief, text: debrief.txt}
"""
FILES = {
    "consent.txt": "We record what you do.\n",
    "debrief.txt": "It was about robots.\n",
    "understood.yaml": """\
title: Before we begin
items:
  - {id: who, text: Who decides?, scale: choice, options: [you, they], correct: you}
  - {id: played, text: Have you played before?, scale: choice, options: ['yes', 'no']}
""",
    "feelings.yaml": """\
title: How you feel
shuffle: true
page: 2
like: {scale: likert, points: 7, low: not at all, high: very much, not_applicable: true}
items:
  - {id: calm, text: I feel calm.}
  - {id: quick, text: I was quick.}
  - {id: sure, text: I felt sure.}
""",
    "final.yaml": """\
title: The end
items:
  - {id: line, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99}
  - {id: why, text: Anything else?, scale: text, required: false}
""",
}


class KilledError(BaseException):
    """The program dies."""


class MortalLog(ExperimentLog):
    """Log whose program dies at one of its events, either just before or just after the event is written.

    Args:
        path: path of the log.
        dies: number of calls of `append` that succeed before the program dies. If None, it never dies.
        written: True if the last event is still written.
    """

    def __init__(self, path: Path, dies: int | None, written: bool) -> None:
        super().__init__(path)
        self._left, self._written = dies, written

    def append(self, events: list[NewEvent]) -> list[LoggedEvent]:
        if self._left == 0:
            if self._written:
                super().append(events)
            raise KilledError
        self._left = None if self._left is None else self._left - 1
        return super().append(events)


@dataclass
class Person:
    """Person at the window.

    Attributes:
        answers: answers by the ids of items; all other items get a valid answer.
        learns: True if they answer a check correctly at the second attempt.
        agrees: True if they agree to take part.
        does: function that returns what they do on a page instead; None for the usual behavior.
        seen: pages that they have seen.
    """

    answers: dict[str, Answer] = field(default_factory=dict)
    learns: bool = False
    agrees: bool = True
    does: Callable[[ToKiosk], Iterable[FromKiosk] | None] = lambda _page: None
    seen: list[ToKiosk] = field(default_factory=list)

    def answer(self, item: FormItem) -> Answer:
        if item.id in self.answers:
            return self.answers[item.id]
        if self.learns and item.id == "who":
            return "you" if TEXTS.text("kiosk.once_more") in headings(self) else "they"
        match item.scale:
            case "choice":
                return item.options[0]
            case "text":
                return "words"
            case "number":
                return item.maximum
            case "analogue":
                return 35.0
        return 3.0

    def react(self, shown: ToKiosk) -> Iterable[FromKiosk]:
        self.seen.append(shown)
        instead = self.does(shown)
        if instead is not None:
            yield from instead
            return
        match shown:
            case ConsentToAsk(page=page):
                yield ConsentReply(page, self.agrees, 1)
            case FormToFill(page=page, items=items, answers=given):
                for item in items:
                    if item.id in given:
                        continue
                    yield ItemNews(page, item.id, "shown", 1)
                    yield ItemNews(page, item.id, "touched", 2)
                    answer = self.answer(item)
                    yield ItemNews(page, item.id, "changed", 3, answer)
                    yield ItemNews(page, item.id, "given", 4, answer)
                yield WentOn(page)
            case TextToRead(page=page, button=button) if button != "":
                yield WentOn(page)
            case GameRecorded(page=page):
                yield WentOn(page)


class ShownWindow:
    """Window at which people sit, one after the other; after the last one, it is closed at the next welcome page.

    Args:
        person: behavior of each of them.
        people: number of people who go through the study.
    """

    def __init__(self, person: Person, people: int = 1) -> None:
        self._person = person
        self._left = people
        self.left_open = False
        self._said: asyncio.Queue[FromKiosk] = asyncio.Queue()

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        yield

    async def send(self, message: ToKiosk) -> None:
        message = KIOSK.decode_from_host(KIOSK.encode(message))
        if isinstance(message, CloseKiosk | StudyTexts):
            return
        waits = isinstance(message, TextToRead) and message.anew
        self._left -= waits
        if waits and (self._left < 0 or not message.button):
            self._person.seen.append(message)
            reactions = self._person.does(message) or [KioskClosed()]
        else:
            reactions = list(self._person.react(message))
        for each in reactions:
            self.say(each)

    def say(self, message: FromKiosk) -> None:
        """Send a message to the host."""
        self._said.put_nowait(KIOSK.decode_from_window(KIOSK.encode(message)))

    def leave_open(self) -> None:
        self.left_open = True

    async def next_request(self) -> FromKiosk:
        return await self._said.get()


class InstantGames:
    """Games that end at once.

    Attributes:
        played: name of the step of each game, and True if it continued a game.
        during: function that is called in each game.
        missing: terms of practice that are not fulfilled when its game ends.
    """

    def __init__(self) -> None:
        self.played: list[tuple[str, bool]] = []
        self.during: Callable[[], None] = lambda: None
        self.missing: dict[PracticeTerm, float] = {}

    async def practise(self, run, step, watcher):
        self.played.append((step.name, False))
        watcher.still_to_do(self.missing)
        await self._at(watcher)
        return SimpleNamespace(missing=self.missing, data={"missing": [*self.missing]})

    async def play(self, run, step, watcher, *, goes_on: bool):
        self.played.append((step.name, goes_on))
        await self._at(watcher)
        return None if watcher.has_left() else {"bag": f"{step.name}.bag", "score": 10, "over": "all visited"}

    async def _at(self, watcher) -> None:
        watcher.ready(ListeningAddress("0.0.0.0", 4711))
        watcher.passed(12.5, 0.0, 60.0)
        self.during()
        for _ in range(10):
            # Messages of the window are read between two ticks.
            await asyncio.sleep(0)
            watcher.has_left()


class Laboratory:
    """Study in a folder, and the program that takes people through it.

    Args:
        folder: folder of the study.
        text: text of experiment.yaml. If None, the folder already contains all files.
    """

    def __init__(self, folder: Path, text: str | None = STUDY) -> None:
        for name, content in {**FILES, "experiment.yaml": text}.items() if text is not None else ():
            (folder / name).write_text(content)
        self._log = folder / "store" / "log"
        self._log.parent.mkdir(exist_ok=True)
        self.design = read_experiment(folder / "experiment.yaml")
        self.games: GamesOfStudy = InstantGames()
        self.host: KioskHost | None = None
        self.conductor: Conductor
        self.window: ShownWindow | None = None
        self._chance = random.Random(1)

    def run(self, person: Person, people: int = 1, dies: int | None = None, *, written: bool = True) -> None:
        """Run the program until the window is closed; raise KilledError if the program dies."""
        clock = StudyClock()
        with MortalLog(self._log, dies, written) as log:
            conductor = self.conductor = Conductor(self.design, log, clock, self._chance.randrange)
            self.window = ShownWindow(person, people)
            self.host = KioskHost(self.design, conductor, self.window, self.games, clock)
            asyncio.run(asyncio.wait_for(self.host.run(), 60))

    @property
    def events(self) -> list[NewEvent]:
        return [entry.event for entry in read_log(self._log) if isinstance(entry, LoggedEvent)]

    def kinds(self) -> list[str]:
        return [event.kind for event in self.events]

    @property
    def people(self) -> list[Run]:
        return list(Progress(self.design).after(read_log(self._log)).runs.values())

    def data(self, kind: str) -> list[dict]:
        return [dict(event.data or {}) for event in self.events if event.kind == kind]


def headings(person: Person) -> list[str]:
    """Return the headings of the pages that a person has seen."""
    found = (getattr(page, "heading", "") or getattr(page, "title", "") for page in person.seen)
    return [heading for heading, _ in itertools.groupby(filter(None, found))]


class RehearsedGames:
    """Games at the kiosk as simulated people play them, as fast as the machine permits."""

    def __init__(self, folder, design) -> None:
        self._folder, self._design = folder, design
        self._settings = SettingCache(design.beside)

    async def practise(self, run, step, watcher) -> PracticeCount:
        watcher.ready(ListeningAddress("127.0.0.1", 4711))
        setting = setting_of_practice(self._design, self._settings, run, step)
        count = PracticeCount(step, setting)
        play_hunt(setting, 60.0, recorders=[count])
        return count

    async def play(self, run, step, watcher, *, goes_on):
        setting = setting_of_trial(self._design, self._settings, run, step)
        bag = self._folder.bag(run.participant, step.number)
        bag.parent.mkdir(parents=True, exist_ok=True)
        with build_writer(setting, bag) as writer:
            measures = play_hunt(setting, step.entry.max_seconds, [writer])
        return played(measures, bag, self._folder.root)


class Reader(Person):
    """Person who answers the example's check correctly after having read how the next game works."""

    def answer(self, item: FormItem) -> Answer:
        read = next((page.text for page in reversed(self.seen) if isinstance(page, TextToRead)), "")
        decides = "room that I choose" if "you decide." in read else "until it and I agree"
        right = (option for option in item.options if decides in option or option == "Energy.")
        return next(right, None) or super().answer(item)


class WindowOfTwo(ShownWindow):
    """Window of the kiosk at which two people sit, one after the other."""

    given_up = False

    def __init__(self, *_: object, people: int = 2) -> None:
        super().__init__(Reader(), people)
