"""docs/first-study.md does what it says: each of its commands is run in order, and says what stands there."""

import re
import runpy
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.support.studies.kiosk_without_screen import Person, ShownWindow
from thbridge.app.compose.recording import build_writer
from thbridge.batch.hunt import play_hunt
from thbridge.batch.settings import SettingCache
from thbridge.experiment.trials import PracticeCount, played, setting_of_practice, setting_of_trial
from thbridge.sockets.addresses import ListeningAddress
from ui.cli import app
from ui.model.kiosk import Answer, FormItem, TextToRead

PAGE = Path(__file__).parents[2] / "docs" / "first-study.md"


class RehearsedGames:
    """Games at the kiosk as simulated people play them, as fast as the machine can."""

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
    """A person who understands the example's check, if they have read how the next game works."""

    def answer(self, item: FormItem) -> Answer:
        read = next((page.text for page in reversed(self.seen) if isinstance(page, TextToRead)), "")
        decides = "room that I choose" if "you decide." in read else "until it and I agree"
        right = (option for option in item.options if decides in option or option == "Energy.")
        return next(right, None) or super().answer(item)


class WindowOfTwo(ShownWindow):
    """The kiosk's window, at which two people sit one after the other."""

    given_up = False

    def __init__(self, *_: object, people: int = 2) -> None:
        super().__init__(Reader(), people)


@pytest.fixture
def at_the_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, instead in (
        ("WindowProcess", WindowOfTwo),
        ("StudyGames", RehearsedGames),
        ("why_no_window", lambda: None),
    ):
        monkeypatch.setattr(f"ui.commands.study.run.{name}", instead)
    return tmp_path


def blocks() -> Iterator[tuple[str, str]]:
    for block in re.finditer(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL):
        yield block[1], block[2]


def commands(session: str) -> Iterator[tuple[str, str]]:
    """The commands of a terminal's session, and what is said to each."""
    yield from re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", session, re.MULTILINE)


def carried_out(command: str) -> str:
    program, *arguments = command.split()
    if program == "thbridge":
        done = CliRunner().invoke(app, arguments)
        assert done.exit_code == 0, f"{command}: {done.output}"
        return done.output
    if program == "python":
        runpy.run_path(arguments[0], run_name="__main__")
        return ""
    if shutil.which(program) is not None:
        subprocess.run([program, *arguments], check=True, capture_output=True)
    return ""


def assert_said(command: str, shown: str, said: str) -> None:
    """Whatever the width of the terminal, and where `...` stands anything may."""
    pattern = r"\s+".join(map(re.escape, shown.split()))
    for gap, anything in (("...", ".*"), ("P-XXXXX", "P-[2-9A-Z]{5}")):
        pattern = pattern.replace(re.escape(gap), anything)
    assert re.fullmatch(rf"\s*{pattern}\s*", said, re.DOTALL), f"$ {command}\n{said}"


@pytest.mark.slow
def test_every_command_of_the_page_does_what_stands_there(at_the_lab: Path) -> None:
    said, run = "", []
    for kind, block in blocks():
        if kind == "sh":
            subprocess.run(["bash", "-e", "-c", block], check=True)
        elif kind == "python":
            exec(compile(block, str(PAGE), "exec"), {})
        else:
            assert kind == "console"
            for command, shown in commands(block):
                now = command
                if "P-XXXXX" in command:
                    now = command.replace("P-XXXXX", re.findall(r"P-\w{5}", said)[0])
                before, said = said, carried_out(now)
                assert_said(now, shown, said)
                said = said if "P-" in said else before
                run.append(command.split()[:3])
    study = ["new", "check", "rehearse", "power", "freeze", "run", "status", "backup", "export", "withdraw"]
    assert {each for each in study if ["thbridge", "study", each] in run} == set(study)
    drawn = Path("rehearsal/exports/first/results/workload-python.png")
    assert drawn.stat().st_size > 1000
