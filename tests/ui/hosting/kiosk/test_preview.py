"""A preview shows one step as participants see it, and closes behind it."""

import asyncio
from pathlib import Path

import pytest

from tests.support.studies.kiosk_without_screen import STUDY, InstantGames, Laboratory, Person, ShownWindow
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.preview import PARTICIPANT, NoSuchStep, arrive, place_of
from thbridge.experiment.store.event_log import ExperimentLog
from ui.hosting.kiosk.game_steps import StudyClock
from ui.hosting.kiosk.host import KioskHost
from ui.model.kiosk import AnswerKept, FormToFill, TextToRead, ToKiosk

FACTORS = """\
within: {dialogue.condition: [supervisor, collaborator]}
between: {robots: [1, 2]}
"""
EACH = (
    STUDY.replace("steps:", FACTORS + "steps:")
    .replace(
        "  - {step: trial, name: first}\n  - {step: form, form: feelings.yaml, name: feelings}\n",
        "  - {step: trial, name: first, each_condition: true}\n"
        "  - {step: form, form: feelings.yaml, name: feelings, each_condition: true}\n",
    )
    .replace("  - {step: trial, name: second}\n", "")
)


class PreviewedGames(InstantGames):
    """Games that are over at once, and note the study that they are of."""

    def __init__(self, design) -> None:
        super().__init__()
        self._design = design
        self.studies = []

    async def play(self, run, step, watcher, *, goes_on: bool):
        self.studies.append(self._design.cells[run.place.cell].studies[step.condition])
        return await super().play(run, step, watcher, goes_on=goes_on)


def previewed(
    folder: Path, step: str, condition: str = "", group: str = ""
) -> tuple[list[ToKiosk], PreviewedGames, Path]:
    design = Laboratory(folder, EACH).design
    log_path = folder / "scratch-log"
    place, planned = place_of(design, step, condition, group)
    person, games = Person(), PreviewedGames(design)
    with ExperimentLog(log_path, synced=False) as log:
        clock = StudyClock()
        arrive(design, log, place, planned, clock())
        conductor = Conductor(design, log, clock, lambda most: 0)
        host = KioskHost(design, conductor, ShownWindow(person), games, clock)
        last = planned.number if step else len(conductor.progress.runs[PARTICIPANT].plan)
        asyncio.run(asyncio.wait_for(host.preview(PARTICIPANT, last), 60))
    return person.seen, games, log_path


def test_a_form_is_shown_alone_with_its_place_among_the_steps(tmp_path: Path) -> None:
    (page, *kept), games, _ = previewed(tmp_path, "final")
    assert all(isinstance(each, AnswerKept) for each in kept)
    assert isinstance(page, FormToFill)
    assert page.title == "The end"
    assert (page.progress.step, page.progress.steps) == (8, 9)
    assert games.played == []


@pytest.mark.parametrize(("condition", "group"), [("collaborator", "2"), ("supervisor", "1"), ("", "")])
def test_a_game_is_of_the_condition_and_group_asked_for(tmp_path: Path, condition: str, group: str) -> None:
    _, games, _ = previewed(tmp_path, "first", condition, group)
    (study,) = games.studies
    assert str(study.dialogue.condition) == (condition or "supervisor")
    assert study.robots == int(group or 1)


def test_all_steps_are_shown_if_none_is_named_and_the_study_keeps_nothing(tmp_path: Path) -> None:
    seen, games, _ = previewed(tmp_path, "")
    assert sum(isinstance(page, FormToFill) for page in seen) >= 4
    assert len(games.studies) == 2
    assert not (tmp_path / "store" / "log").exists()
    assert not any(isinstance(page, TextToRead) and page.anew for page in seen), "no welcome for the next person"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("nothing",), "the study has no step nothing. Write one of consent_1, practice"),
        (("first", "adviser"), "the study has no condition adviser. Write one of: dialogue.condition=supervisor; "),
        (("first", "", "3"), "the study has no group 3. Write one of: robots=1; robots=2"),
    ],
)
def test_what_the_study_does_not_have_is_refused(tmp_path: Path, arguments: tuple[str, ...], reason: str) -> None:
    with pytest.raises(NoSuchStep, match="the study has no") as refused:
        previewed(tmp_path, *arguments)
    assert reason in str(refused.value)
