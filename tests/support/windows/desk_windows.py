"""Window of the experimenter's desk, on a rehearsed study."""

from collections.abc import Iterator

import pytest
from msgspec import structs
from pytestqt.qtbot import QtBot

from tests.support.studies.rehearsed_studies import RehearsedStudy, clocks, rehearsed_study
from thbridge.experiment.progress import Progress
from thbridge.experiment.store.events import EventKind
from ui.model.desk.messages import DeskState
from ui.model.desk.state import ToldToDesk, desk_state
from ui.windows.desk.window import DeskWindow


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> RehearsedStudy:
    return rehearsed_study(tmp_path_factory.mktemp("desk"))


@pytest.fixture
def state(study: RehearsedStudy) -> DeskState:
    """Return the state of the study while a person fills in a form."""
    # The first item of a form has just been shown.
    begun = {entry.sequence for entry in study.entries if entry.event.kind == EventKind.STEP_BEGUN}
    shown = [entry.sequence for entry in study.entries if entry.event.kind == EventKind.ITEM_SHOWN]
    length = max(sequence for sequence in shown if sequence - 1 in begun and study.entries[sequence].event.step)
    entries = study.entries[:length]
    progress = Progress(study.design).after(entries)
    someone = entries[-1].event.participant
    told = ToldToDesk(clocks(length).wall, (), "the form workload", (), someone)
    return structs.replace(desk_state(study.design, progress, entries, told), no_next="")


@pytest.fixture
def desk(qtbot: QtBot, state: DeskState) -> Iterator[DeskWindow]:
    made = DeskWindow()
    qtbot.addWidget(made)
    made.heard = []
    made.asked.connect(made.heard.append)
    with qtbot.waitExposed(made):
        made.show()
    made.receive(state)
    yield made
    made.leave()
