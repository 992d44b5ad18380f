"""A whole study in the real window, with the real programs: by mouse, and by keyboard alone, killed in the middle."""

import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support.programs.processes import Program
from tests.support.windows.desktop import Desktop, desktop, needs_desktop
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, RunState
from thbridge.recording.bag.reading.reader import info

pytestmark = needs_desktop

FILES = {
    "experiment.yaml": """\
title: A small study
base: {map: arena8, robots: 1, game.energy: 20, server.port: 0}
within: {dialogue.condition: [script, supervisor, adviser]}
quota: 6
steps:
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice, base: {dialogue.condition: supervisor}}
  - {step: check, form: understood.yaml, attempts: 2, repeat: practice}
  - {step: trial, each_condition: true, max_seconds: 3}
  - {step: form, form: feelings.yaml, name: feelings}
  - {step: form, form: person.yaml, name: person}
  - {step: debrief, text: debrief.txt}
""",
    "consent.txt": "We record what you do.\n",
    "debrief.txt": "It was about robots.\n",
    "understood.yaml": """\
title: Before we begin
items: [{id: who, text: Who decides?, scale: choice, options: [you, they], correct: you}]
""",
    "feelings.yaml": """\
title: How you feel
items:
  - {id: calm, text: I feel calm., points: 5, low: not at all, high: very much, not_applicable: true}
  - {id: hard, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
""",
    "person.yaml": """\
title: About you
items:
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99, unit: years}
  - {id: why, text: Anything else?, scale: text, required: false}
""",
}


@pytest.fixture
def screen() -> Iterator[Desktop]:
    with desktop(1024, 600) as opened:
        yield opened


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, content in FILES.items():
        (tmp_path / name).write_text(content)
    return tmp_path


class Kiosk:
    """`thbridge study run` on the desktop."""

    def __init__(self, folder: Path, screen: Desktop) -> None:
        self._folder, self._screen = folder, screen
        self.start()

    def start(self) -> None:
        self.program = Program(self._folder, "study", "run", ".", environment=self._screen.environment)
        self._screen.focus_window("Study")

    def kill(self) -> None:
        os.kill(self.program.process.pid, signal.SIGKILL)
        self._screen.found("The program has stopped")

    def close(self) -> None:
        self._screen.press("ctrl+alt+shift+q")
        assert self.program.process.wait(60) == 0, self.program.text


@pytest.fixture
def kiosk(folder: Path, screen: Desktop) -> Iterator[Kiosk]:
    opened = Kiosk(folder, screen)
    yield opened
    screen.picture(folder / "screen.png")
    opened.program.close()


def leave(screen: Desktop, name: str, deed: Callable[[], None]) -> None:
    """Wait for a page, and do something until it has gone; one that has just come is not left yet."""
    screen.found(name)

    def gone() -> bool:
        if screen.find(name) is not None:
            deed()
        return screen.find(name) is None

    screen.wait(f"{name} to go", gone)


def clicking(screen: Desktop, name: str, role: str = "push button") -> Callable[[], None]:
    def click() -> None:
        button = screen.find(name, role)
        if button is not None:
            screen.click(button)

    return click


def practice(screen: Desktop, go_on: Callable[[], None]) -> None:
    """Play the practice game: nothing leads on before the robot was sent to a room."""
    screen.found("Before you go on: send a robot to a room.", "label")
    screen.found("Score 0")
    go_on()
    assert screen.find("Before you go on: send a robot to a room.", "label") is not None
    screen.press("1")
    screen.found("You have tried out what you need.", "label")
    leave(screen, "Practice", go_on)


def finished(folder: Path) -> None:
    """The study as the log has it: one person, complete, whose games have their recordings."""
    entries = read_log(folder / "store" / "log")
    (run,) = Progress(ExperimentFolder(folder).read()).after(entries).runs.values()
    assert run.state is RunState.COMPLETE
    assert run.farewell_read
    assert run.attempts == {3: 2}
    practice = [entry.event.data for entry in entries if entry.event.kind == EventKind.PRACTICE_PLAYED]
    assert [(data["moves"] >= 1, data["missing"]) for data in practice] == [(True, [])] * 2, "again after the check"
    assert (run.answers["feelings.calm"], run.answers["person.age"]) == (4.0, 33.0)
    assert run.answers["person.why"] == "No"
    bags = [folder / str(e.event.data["bag"]) for e in entries if e.event.kind == EventKind.GAME_PLAYED]
    assert len(set(bags)) == 3
    assert all(info(bag).messages > 100 for bag in bags)


@pytest.mark.slow
def test_a_whole_study_by_mouse(kiosk: Kiosk, screen: Desktop, folder: Path) -> None:
    leave(screen, "Welcome", clicking(screen, "Begin"))
    leave(screen, "What you agree to", clicking(screen, "I agree"))
    practice(screen, clicking(screen, "Go on with the study"))
    screen.click(screen.rested("they", "radio button"))
    leave(screen, "Before we begin", clicking(screen, "Continue"))
    leave(screen, "Once more", clicking(screen, "Continue"))
    practice(screen, clicking(screen, "Go on with the study"))
    screen.click(screen.rested("you", "radio button"))
    leave(screen, "Before we begin", clicking(screen, "Continue"))
    for _ in range(3):
        leave(screen, "The game has ended", clicking(screen, "Continue"))
    # A screen reader hears of each item, each value of its scale, and whether it is chosen.
    screen.found("Question 1 of 2: I feel calm. Not answered.")
    points = [one for one in screen.look() if one.role == "radio button"]
    between = [f"{number} of 5, from 1, not at all, to 5, very much" for number in (2, 3, 4)]
    assert [one.name for one in points] == ["1 of 5, not at all", *between, "5 of 5, very much"]
    assert {one.description for one in points} == {"I feel calm."}
    assert not any(one.checked for one in points)
    screen.click(points[3])
    screen.found("Question 1 of 2: I feel calm. Answered: 4.")
    assert [one.checked for one in screen.look() if one.role == "radio button"] == [False, False, False, True, False]
    screen.found("Not applicable", "check box")
    screen.found("How hard was it?, not marked, line from 0, easy, to 100, hard", "slider")
    screen.click(screen.rested("Continue"))
    screen.found("Question 2 of 2: How hard was it? Not answered. Please answer this question.")
    screen.click(screen.rested("How hard was it?, not marked", "slider"))
    screen.found("How hard was it?, marked at 50", "slider")
    leave(screen, "How you feel", clicking(screen, "Continue"))
    screen.click(screen.rested("How old are you?", "text"))
    screen.do("type", "33")
    screen.click(screen.rested("Anything else?", "text"))
    screen.do("type", "No")
    leave(screen, "About you", clicking(screen, "Continue"))
    leave(screen, "What this study was about", clicking(screen, "Continue"))
    screen.found("Completion code: ")
    leave(screen, "Thank you", clicking(screen, "Finish"))
    screen.found("Welcome")
    kiosk.close()
    finished(folder)


@pytest.mark.slow
def test_a_whole_study_by_keyboard_alone_and_killed_in_the_middle(kiosk: Kiosk, screen: Desktop, folder: Path) -> None:
    def pressing(*keys: str) -> Callable[[], None]:
        return lambda: screen.press(*keys)

    leave(screen, "Welcome", pressing("Return"))
    leave(screen, "What you agree to", pressing("a"))
    practice(screen, pressing("F10"))
    leave(screen, "Before we begin", pressing("2", "ctrl+Return"))
    leave(screen, "Once more", pressing("Return"))
    practice(screen, pressing("F10"))
    leave(screen, "Before we begin", pressing("1", "ctrl+Return"))
    screen.found("Score 0")
    kiosk.kill()
    kiosk.start()
    screen.found("The study goes on where you were")
    leave(screen, "The study goes on where you were", pressing("Return"))
    for _ in range(3):
        leave(screen, "The game has ended", pressing("Return"))
    screen.found("Question 1 of 2: I feel calm.")
    screen.press("4")
    screen.found("Question 1 of 2: I feel calm. Answered: 4.")
    windows = subprocess.run(
        ["pgrep", "-P", str(kiosk.program.process.pid), "-f", "hosted"], capture_output=True, text=True, check=True
    )
    os.kill(int(windows.stdout.split()[0]), signal.SIGKILL)
    screen.wait("it to be told", lambda: "crashed" in kiosk.program.text)
    screen.focus_window("Study")
    screen.found("Question 1 of 2: I feel calm. Answered: 4.")
    # The focus is at the first item without an answer.
    screen.press("Right", "Right")
    leave(screen, "How you feel", pressing("ctrl+Return"))
    screen.found("About you")
    screen.do("type", "33")
    screen.press("Tab")
    screen.do("type", "No")
    leave(screen, "About you", pressing("ctrl+Return"))
    leave(screen, "What this study was about", pressing("Return"))
    screen.found("Completion code: ")
    leave(screen, "Thank you", pressing("Return"))
    screen.found("Welcome")
    kiosk.close()
    finished(folder)


PAGES = {
    "experiment.yaml": """\
title: All pages
quota: 1
recruiting: {ask: Which code do you have?}
steps:
  - {step: instructions, text: long.md}
  - {step: consent, text: consent.txt}
  - {step: form, form: all.yaml, name: all}
  - {step: check, form: understood.yaml, attempts: 2}
  - {step: pause}
  - {step: debrief, text: debrief.txt}
""",
    "long.md": "# How it goes\n\n" + "You send **robots** through rooms. " * 30,
    "all.yaml": """\
title: All scales
instructions: There are no right answers.
page: 4
items:
  - {id: points, text: I feel calm., points: 3, low: not at all, high: very much, not_applicable: true}
  - {id: labels, text: I was quick., points: 3, labels: [never, seldom, often]}
  - {id: line, text: How hard was it?, scale: analogue, low: easy, high: hard, step: 5}
  - {id: warm, scale: differential, points: 3, low: cold, high: warm}
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99, unit: years}
  - {id: hand, text: Which hand?, scale: choice, options: [left, right]}
  - {id: used, text: Which do you know?, scale: choice, several: true, options: [drones, arms]}
  - {id: why, text: Anything else?, scale: text, required: false}
""",
}


def spoken(screen: Desktop) -> list[str]:
    """All that a screen reader can stop at, and all words of labels and texts."""
    return [one.name or one.text for one in screen.look() if one.name or one.text]


@pytest.mark.slow
def test_a_screen_reader_reads_every_item_of_every_page_and_sigterm_is_told(screen: Desktop, tmp_path: Path) -> None:
    for name, content in {**FILES, **PAGES}.items():
        (tmp_path / name).write_text(content)
    kiosk = Kiosk(tmp_path, screen)
    try:
        screen.found("If you are the next person to take part", "label")
        leave(screen, "Welcome", clicking(screen, "Begin"))
        screen.found("Question 1 of 1: Which code do you have? Not answered.")
        screen.click(screen.rested("Which code do you have?, one line", "text"))
        screen.do("type", "SVC-7")
        leave(screen, "Before you begin", clicking(screen, "Continue"))
        screen.wait("the text", lambda: any("How it goes" in one.text for one in screen.look()))
        leave(screen, "A text to read", clicking(screen, "Continue"))
        screen.wait("consent", lambda: any(one.text == "We record what you do." for one in screen.look()))
        assert {"I agree", "I do not take part"} <= {one.name for one in screen.look() if one.role == "push button"}
        leave(screen, "What you agree to", clicking(screen, "I agree"))
        screen.found("There are no right answers.", "label")
        shown = spoken(screen)
        asked = ("I feel calm.", "I was quick.", "How hard was it?", "Cold – warm")
        for number, text in enumerate(asked, start=1):
            assert f"Question {number} of 4: {text} Not answered." in shown
        assert {"1 of 3, not at all", "2 of 3, seldom", "3 of 3, warm", "Not applicable"} <= set(shown)
        assert "Page 1 of 2. 0 of 4 answered." in shown
        leave(screen, "Page 1 of 2. 0 of 4 answered.", clicking(screen, "Continue"))
        screen.found("4 answers are missing; they are marked.", "label")
        assert "Question 2 of 4: I was quick. Not answered. Please answer this question." in spoken(screen)
        for name in ("1 of 3, not at all", "2 of 3, seldom", "3 of 3, warm"):
            screen.click(screen.rested(name, "radio button"))
        screen.click(screen.rested("How hard was it?, not marked", "slider"))
        leave(screen, "Page 1 of 2. 4 of 4 answered.", clicking(screen, "Continue"))
        screen.found("Page 2 of 2. 0 of 4 answered.", "label")
        shown = spoken(screen)
        assert {"How old are you?, years, a number from 18 to 99", "Anything else?, free text"} <= set(shown)
        roles = {one.name: one.role for one in screen.look()}
        assert (roles["left"], roles["drones"]) == ("radio button", "check box")
        leave(screen, "Page 2 of 2", clicking(screen, "Back"))
        screen.found("Question 2 of 4: I was quick. Answered: 2.")
        os.kill(kiosk.program.process.pid, signal.SIGTERM)
        assert kiosk.program.process.wait(60) == 0
        screen.found("The researcher has stopped the program.", "label")
        kiosk.program.close()
        kiosk.start()
        leave(screen, "The study goes on where you were", clicking(screen, "Continue"))
        screen.found("Page 2 of 2. 0 of 4 answered.", "label")
        screen.click(screen.rested("How old are you?", "text"))
        screen.do("type", "33")
        for name, role in (("left", "radio button"), ("drones", "check box")):
            screen.click(screen.rested(name, role))
        leave(screen, "All scales", clicking(screen, "Continue"))
        screen.click(screen.rested("they", "radio button"))
        leave(screen, "Before we begin", clicking(screen, "Continue"))
        screen.found("Not all of your answers were right.", "label")
        leave(screen, "Once more", clicking(screen, "Continue"))
        screen.click(screen.rested("you", "radio button"))
        leave(screen, "Before we begin", clicking(screen, "Continue"))
        screen.found("Take a rest if you like.", "label")
        screen.ask_to_close(screen.focus_window("Study"))
        asked_to_leave = {"Go on with the study", "Stop taking part: ", "Close the window, for the researcher"}
        screen.found("You can stop at any time and do not need to say why.", "label")
        assert all(screen.find(name, "push button") for name in asked_to_leave)
        leave(screen, "Leave the study?", lambda: screen.press("Escape"))
        leave(screen, "A pause", clicking(screen, "Continue"))
        screen.found("It was about robots.", "label")
        leave(screen, "What this study was about", clicking(screen, "Continue"))
        code = screen.found("Completion code: ").name.removeprefix("Completion code: ").replace(", ", "")
        leave(screen, "Thank you", clicking(screen, "Finish"))
        screen.found("The study is complete")
        kiosk.close()
    finally:
        screen.picture(tmp_path / "screen.png")
        kiosk.program.close()
    (run,) = Progress(ExperimentFolder(tmp_path).read()).after(read_log(tmp_path / "store" / "log")).runs.values()
    assert (run.state, run.code, run.recruiting_code) == (RunState.COMPLETE, code, "SVC-7")
    assert run.answers["all.line"] == 50.0
