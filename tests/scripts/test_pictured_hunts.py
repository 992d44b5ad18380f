"""The hunts of the pictures begin: one for a participant, and one with a wizard for the researcher."""

import importlib
from collections.abc import Callable
from types import ModuleType

import pytest

from tests.support.project import ROOT

Import = Callable[[str], ModuleType]


@pytest.fixture
def drawing(monkeypatch: pytest.MonkeyPatch) -> Import:
    """Import of modules that are next to the scripts, which find their own folder when they are run."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "draw"))
    return importlib.import_module


def test_a_hunt_begins_for_a_participant(drawing: Import) -> None:
    hunt = drawing("pictured.hunt").PicturedHunt(drawing("pictured.participant").STANDARD)
    assert len(hunt.screen.cards) == hunt.screen.cards[-1].robot + 1


def test_a_hunt_is_played_for_the_researcher(drawing: Import) -> None:
    researcher = drawing("pictured.researcher")
    messages = researcher._MessageCollector()
    researcher.play([messages], 3, researcher.SPOKEN_FOR)
    assert {"/robot3/odom", "/hunt/wizard"} <= {getattr(each, "topic", "") for each in messages.events}
