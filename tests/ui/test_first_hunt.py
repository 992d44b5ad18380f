"""docs/tutorials/first-hunt.md works: each of its commands is run in order, and prints what the page shows."""

from pathlib import Path

import pytest

from tests.support.programs.pages import follow
from tests.support.project import ROOT


@pytest.mark.slow
def test_every_command_of_the_page_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    run = [words[1] for words in follow(ROOT / "docs" / "tutorials" / "first-hunt.md")]
    assert {"play", "report", "bag", "replay"} <= set(run)
    assert Path("first.html").stat().st_size > 1000
