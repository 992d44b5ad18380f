"""Practice games: played as the person's first game will be, and not left before what they are for is done."""

from pathlib import Path
from typing import Any

import pytest

from tests.support.studies.experiment_files import write_experiment
from thbridge.app.compose.setting import StudySetting
from thbridge.batch.hunt import play_hunt
from thbridge.batch.settings import SettingCache
from thbridge.experiment.design.experiment_file import ExperimentDesign, drawn_seed, practice_seed, read_experiment
from thbridge.experiment.design.plan import plan_of
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.progress import Run
from thbridge.experiment.trials import PracticeCount, setting_of_practice
from thbridge.files.errors import BadFile

STUDY = """\
title: Practice
base: {map: practice, templates: practice, robots: 2, game.energy: 37, dialogue.language: de, rate: 50, server.port: 0}
within:
  dialogue.condition: [supervisor, collaborator]
quota: 2
steps:
  - {step: practice, name: practice%s}
  - {step: trial, each_condition: true}
"""


SETTINGS = SettingCache(Path())
"""Files that are read once for all tests."""


def designed(folder: Path, keys: str = "") -> ExperimentDesign:
    return read_experiment(write_experiment(folder, STUDY % keys))


def at_practice(design: ExperimentDesign, place: int, attempt: int = 1) -> tuple[Run, Any, StudySetting]:
    where = design.allocation.place(place)
    plan = plan_of(design, where)
    step = next(step for step in plan if step.entry.step is StepKind.PRACTICE)
    run = Run("P-1", where, plan, begun={step.number: attempt})
    return run, step, setting_of_practice(design, SETTINGS, run, step)


def test_practice_is_played_in_the_first_condition_with_all_else_as_in_its_trial(tmp_path: Path) -> None:
    design = designed(tmp_path)
    met = set()
    for place in range(2):
        run, _, setting = at_practice(design, place)
        first = design.cells[0].studies[design.orders[run.place.order][0]]
        met.add(str(setting.study.dialogue.condition))
        assert setting.study.dialogue == first.dialogue
        assert (setting.study.map, setting.study.robots) == (first.map, first.robots)
        assert (setting.study.game.energy, setting.study.dialogue.language) == (37.0, "de")
    assert met == {"supervisor", "collaborator"}, "each person practices what they meet first"


def test_practice_shows_no_trial_and_never_the_same_treasures_twice(tmp_path: Path) -> None:
    design = designed(tmp_path)
    trials = {drawn_seed(design, trial) for trial in range(2)}
    seeds = [at_practice(design, 0, attempt)[2].study.seed for attempt in (1, 2, 3)]
    assert len(set(seeds)) == 3
    assert not trials & set(seeds)
    assert at_practice(design, 1)[2].study.seed == seeds[0], "the same for everybody"
    taken = practice_seed(design, 1)
    given = read_experiment(write_experiment(tmp_path, STUDY.replace("quota:", f"seeds: [{taken}, 1]\nquota:") % ""))
    assert practice_seed(given, 1) not in {taken, 1}


def test_keys_of_the_step_change_the_practice_game_alone(tmp_path: Path) -> None:
    design = designed(tmp_path, ", base: {dialogue: {condition: adviser}, game.energy: 80, robots: 1}")
    _, _, setting = at_practice(design, 0)
    assert str(setting.study.dialogue.condition) == "adviser"
    assert (setting.study.game.energy, setting.study.robots) == (80.0, 1)
    assert {study.game.energy for study in design.cells[0].studies} == {37.0}


@pytest.mark.parametrize(
    ("keys", "key", "problem"),
    [
        (", base: {robots: many}", "robots", "'many' is not a number"),
        (", base: {map: nowhere}", "map", "nowhere"),
        (", at_least: {moves: 3}", "steps[0].at_least.moves", "the map and the robots' energy allow at most 2"),
        (", base: {game.energy: 1}", "steps[0].at_least.moves", "allow at most 0"),
        (", at_least: {moves: 0.5}", "steps[0].at_least.moves", "not a whole number"),
        (", at_least: {jumps: 1}", "steps[0].at_least.jumps", "jumps is not counted in practice"),
        (", at_least: {moves: some}", "steps[0].at_least.moves", "'some' is not a number"),
        (", at_least: {seconds: 60}, max_seconds: 60", "steps[0].at_least.seconds", "the game ends after 60 s"),
        (
            ", at_least: {dialogues: 1}, base: {dialogue.condition: supervisor}",
            "steps[0].at_least.dialogues",
            "never talk",
        ),
    ],
)
def test_what_nobody_can_do_is_refused_with_its_line(tmp_path: Path, keys: str, key: str, problem: str) -> None:
    text = (STUDY % keys).replace("[supervisor, collaborator]", "[script]").replace(", dialogue.language: de", "")
    with pytest.raises(BadFile) as raised:
        read_experiment(write_experiment(tmp_path, text), with_files=True)
    (fault,) = getattr(raised.value, "faults", (raised.value,))
    assert problem in str(fault)
    assert (fault.line, fault.key) == (7, key)


def test_only_practice_takes_the_keys_of_practice(tmp_path: Path) -> None:
    text = (STUDY % "").replace("each_condition: true", "each_condition: true, at_least: {moves: 1}")
    with pytest.raises(BadFile, match="this key is only for practice games, not for the step trial"):
        read_experiment(write_experiment(tmp_path, text))


def test_what_a_person_does_is_counted_from_the_events_of_the_game(tmp_path: Path) -> None:
    asked = ", at_least: {moves: 2, identified: 1, dialogues: 1, seconds: 5}, base: {dialogue.condition: collaborator}"
    _, step, setting = at_practice(designed(tmp_path, asked), 0)
    count = PracticeCount(step, setting)
    assert dict(count.missing) == {"moves": 2, "identified": 1, "dialogues": 1, "seconds": 5}
    measures = play_hunt(setting, 300.0, recorders=[count])
    assert not count.missing, "a simulated participant does all of it"
    assert count.data["identified"] == measures.identified
    assert count.data["seconds"] == pytest.approx(measures.sim_seconds, abs=0.05)
    assert count.data["moves"] >= 2 and count.data["dialogues"] >= 1
    assert count.data["missing"] == []


def test_where_robots_never_talk_no_dialogue_is_asked_for(tmp_path: Path) -> None:
    design = designed(tmp_path, ", at_least: {dialogues: 1}")
    asked = []
    for place in range(2):
        _, step, setting = at_practice(design, place)
        asked.append((str(setting.study.dialogue.condition), list(PracticeCount(step, setting).missing)))
    assert sorted(asked) == [("collaborator", ["dialogues"]), ("supervisor", [])]


def test_by_default_a_robot_must_be_sent(tmp_path: Path) -> None:
    _, step, setting = at_practice(designed(tmp_path), 0)
    assert dict(PracticeCount(step, setting).missing) == {"moves": 1}
