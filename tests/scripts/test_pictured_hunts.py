"""The hunts of the pictures begin: one in a participant's window, and one with a wizard for the researcher."""

import importlib
from collections.abc import Callable
from types import ModuleType

import pytest
from PySide6.QtWidgets import QApplication

from tests.support.project import ROOT

Import = Callable[[str], ModuleType]


@pytest.fixture
def drawing(monkeypatch: pytest.MonkeyPatch) -> Import:
    """Import of modules that are next to the scripts, which find their own folder when they are run."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "draw"))
    return importlib.import_module


def test_a_window_shows_a_hunt(drawing: Import, qapp: QApplication) -> None:
    (shot,) = drawing("pictured.participant").consent()
    assert shot.name == "consent"
    picture = drawing("windows").grabbed(shot)
    assert picture.size == (1200, 800)
    assert len(picture.getcolors(picture.width * picture.height)) > 10
    shot.window.close()


def test_a_hunt_is_played_for_the_researcher(drawing: Import) -> None:
    researcher = drawing("pictured.researcher")
    messages = researcher._MessageCollector()
    researcher.play([messages], 3, researcher.SPOKEN_FOR)
    assert {"/robot3/odom", "/hunt/wizard"} <= {getattr(each, "topic", "") for each in messages.events}
