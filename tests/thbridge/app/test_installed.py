"""Authors and strategies are found by the names of their entry points; what is wrong with one is told."""

import logging
import sys
import threading
from pathlib import Path

import pytest

from thbridge.app.compose.installed import impatient_author, installed_author, installed_strategy
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.examples import jhri2015
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.wording.authors import ask_author, request_of
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.errors import BadFile
from thbridge.files.game_files import read_rulebook
from thbridge.files.word_files import read_language
from thbridge.hunt.rooms import Room
from thbridge.study.study_file import load_study

PROGRAMS = """
SEVEN = 7
MAY_GO_ON = abs

def polite(request):
    print("how do I say it?")
    return "Please: " + request.sentence

def fussy():
    return None

def mute(manner, seed):
    return "mute"

def sick(manner, seed):
    raise RuntimeError("not today")

class Stubborn:
    def __init__(self, manner, seed):
        self.told = f"persistence({manner.persistence} {seed})"

    def choose(self, conversation, number):
        MAY_GO_ON(60)
        print("no")
        return self.told
"""


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a distribution with authors for one test."""
    folder = tmp_path / "lab_of_tests-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-tests\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[thbridge.wordings]\npolite = lab_of_tests:polite\nnumber = lab_of_tests:SEVEN\nlost = lab_of_tests:lost\n"
        "[thbridge.strategies]\nstubborn = lab_of_tests:Stubborn\nfussy = lab_of_tests:fussy\n"
        "sick = lab_of_tests:sick\nmute = lab_of_tests:mute\n"
    )
    (tmp_path / "lab_of_tests.py").write_text(PROGRAMS)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "lab_of_tests", raising=False)


def test_an_installed_author_words_a_move() -> None:
    request = request_of(Wording(read_language(), 0), DialogueMove("assert", Literal(NextRoom(0, Room(3)))))
    outcome = ask_author(installed_author("polite"), request)
    assert outcome.text == f"Please: {request.sentence}"


def test_what_programs_of_others_print_stays_out_of_results(capsys: pytest.CaptureFixture[str]) -> None:
    request = request_of(Wording(read_language(), 0), DialogueMove("assert", Literal(NextRoom(0, Room(3)))))
    installed_author("polite")(request)
    impatient_author("polite", 60.0)(request)
    (exchange, *_) = jhri2015(read_rulebook())
    installed_strategy("stubborn")(Manner(), 5).choose(exchange.start, 1)
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "how do I say it?\nhow do I say it?\nno\n")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("polit", r"no author of wordings polit is installed. The nearest name is polite"),
        ("x", r"Installed are: lost, number, polite"),
        ("number", r"lab_of_tests:SEVEN is not a function"),
        ("lost", r"lab_of_tests:lost cannot be imported: AttributeError"),
    ],
)
def test_an_author_that_is_not_there_or_is_none_is_told(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        installed_author(name)


def test_an_installed_strategy_is_told_of_the_manner_and_a_seed() -> None:
    strategy = installed_strategy("stubborn")(Manner(persistence=7), 5)
    (exchange, *_) = jhri2015(read_rulebook())
    assert str(strategy.choose(exchange.start, 1)) == "persistence(7 5)"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("stuborn", r"no strategy stuborn is installed. The nearest name is stubborn"),
        (
            "fussy",
            r"fussy: package lab-of-tests 1.0: making the object failed: TypeError: .* arguments? but 2 were given",
        ),
        (
            "sick",
            r"sick: package lab-of-tests 1.0: making the object failed: RuntimeError: "
            r"not today \(lab_of_tests.py, line \d+\). Name a class",
        ),
        ("mute", r"mute: package lab-of-tests 1.0: the result is a str, which has no method choose. Name a class"),
    ],
)
def test_a_strategy_that_is_not_there_or_cannot_be_made_is_told(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        installed_strategy(name)


class _Release(logging.Handler):
    """Lets a strategy go on as soon as something is logged."""

    def __init__(self) -> None:
        super().__init__()
        self.text = ""
        self.told = threading.Event()

    def emit(self, record: logging.LogRecord) -> None:
        self.text = record.getMessage()
        self.told.set()


def test_people_are_told_while_a_game_waits_for_a_strategy(monkeypatch: pytest.MonkeyPatch) -> None:
    release = _Release()
    log = logging.getLogger("thbridge.app.compose.installed")
    monkeypatch.setattr("thbridge.app.compose.installed.PATIENCE", 0.0)
    monkeypatch.setattr(log, "handlers", [release])
    strategy = installed_strategy("stubborn")(Manner(), 5)
    monkeypatch.setattr(sys.modules["lab_of_tests"], "MAY_GO_ON", release.told.wait)
    (exchange, *_) = jhri2015(read_rulebook())
    assert str(strategy.choose(exchange.start, 1)) == "persistence(2 5)"
    assert release.told.is_set() and "the strategy stubborn needs more than 0 s to choose a move" in release.text


def study_of(folder: Path, text: str) -> StudySetting:
    path = folder / "study.yaml"
    path.write_text(text)
    written = load_study(path)
    return read_setting(written.value, folder, written=written)


def test_a_study_names_a_strategy_for_all_robots_or_for_one(tmp_path: Path) -> None:
    assert study_of(tmp_path, "dialogue: {strategy: template}").strategies == {None: None}
    both = study_of(tmp_path, "dialogue: {strategy: stubborn, each: {2: {strategy: manner}, 1: {persistence: 1}}}")
    assert both.strategies.keys() == {None, 1} and both.strategies[1] is None and both.strategies[None] is not None


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "dialogue:\n  strategy: stuborn\n",
            "line 2, dialogue.strategy: thbridge.strategies: no strategy stuborn .* The nearest name is stubborn",
        ),
        (
            "dialogue:\n  manner:\n    strategy: x\n",
            "line 3, dialogue.manner.strategy: .* no strategy x is installed. Installed are: fussy, mute, sick, stub",
        ),
        (
            "dialogue:\n  strategy: stubborn\n  each:\n    2: {strategy: mute}\n",
            "line 4, dialogue.each.2.strategy: .* the result is a str",
        ),
    ],
)
def test_a_study_with_an_unknown_strategy_is_told_of_its_line(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        study_of(tmp_path, text)
