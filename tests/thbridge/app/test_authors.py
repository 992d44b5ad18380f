"""Authors of wordings are found by the names of their entry points; what is wrong with one is told."""

import sys
from pathlib import Path

import pytest

from thbridge.app.compose.authors import installed_author
from thbridge.argumentation.propositions import Literal
from thbridge.dialogue.games.contents import DialogueMove
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.wording.authors import ask_author, request_of
from thbridge.dialogue.wording.wording import Wording
from thbridge.files.errors import BadFile
from thbridge.files.word_files import read_language
from thbridge.hunt.rooms import Room


@pytest.fixture(autouse=True)
def a_lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a distribution with authors for one test."""
    folder = tmp_path / "lab_of_tests-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-of-tests\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(
        "[thbridge.wordings]\npolite = lab_of_tests:polite\nnumber = lab_of_tests:SEVEN\nlost = lab_of_tests:lost\n"
    )
    (tmp_path / "lab_of_tests.py").write_text(
        "SEVEN = 7\n\ndef polite(request):\n    return 'Please: ' + request.sentence\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "lab_of_tests", raising=False)


def test_an_installed_author_words_a_move() -> None:
    request = request_of(Wording(read_language(), 0), DialogueMove("assert", Literal(NextRoom(0, Room(3)))))
    outcome = ask_author(installed_author("polite"), request)
    assert outcome.text == f"Please: {request.sentence}"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("polit", r"no author of wordings polit is installed. The nearest is polite"),
        ("x", r"Installed are: lost, number, polite"),
        ("number", r"lab_of_tests:SEVEN is no function"),
        ("lost", r"lab_of_tests:lost cannot be imported: AttributeError"),
    ],
)
def test_an_author_that_is_not_there_or_is_none_is_told(name: str, told: str) -> None:
    with pytest.raises(BadFile, match=told):
        installed_author(name)
