"""docs/tutorials/first-study.md works: each of its commands is run in order, and prints what the page shows."""

from pathlib import Path

import pytest

from tests.support.programs.pages import follow
from tests.support.project import ROOT
from tests.support.studies.kiosk_without_screen import RehearsedGames, WindowOfTwo

PAGE = ROOT / "docs" / "tutorials" / "first-study.md"


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


@pytest.mark.slow
def test_every_command_of_the_page_prints_what_it_shows(at_the_lab: Path) -> None:
    run = [words[:3] for words in follow(PAGE)]
    study = ["new", "check", "rehearse", "power", "freeze", "run", "status", "backup", "export", "withdraw"]
    assert {each for each in study if ["thbridge", "study", each] in run} == set(study)
    drawn = Path("rehearsal/exports/first/results/workload-python.png")
    assert drawn.stat().st_size > 1000
