"""Rehearsals: a whole experiment without people, that finds the effect which was put in, and none where none was."""

import hashlib
from pathlib import Path

import pandas as pd
import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.rehearsed_studies import rehearse
from thbridge.batch.hunt import play_hunt
from thbridge.batch.settings import SettingCache
from thbridge.experiment.export.tables import tables_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.rehearsal.people import PutInEffect, SimulatedPeople, read_people
from thbridge.experiment.store.event_log import read_log
from thbridge.experiment.store.events import EventKind, RunState
from thbridge.experiment.trials import best_possible
from thbridge.files.errors import BadFile, BadFiles
from thbridge.recording.bag.reading.reader import info
from thbridge.roles.keeper import keeper
from thbridge.roles.keeper.disclosed.debriefing import debrief_of
from thbridge.study.study_file import CostModel, GameSection, Study

COLLABORATOR = {"dialogue.condition": "collaborator"}


def scores(folder: ExperimentFolder, subscale: str) -> pd.DataFrame:
    table = next(table for table in tables_of(folder.read(), read_log(folder.log)) if table.name == "scores")
    frame = pd.DataFrame(table.rows)
    return frame[(frame.subscale == subscale) & frame.counts].dropna(subset="score")


def difference(folder: ExperimentFolder, subscale: str) -> tuple[float, float]:
    """Mean difference within people between the conditions, and its standard error."""
    wide = scores(folder, subscale).pivot_table(index="participant", columns="dialogue.condition", values="score")
    off = (wide.collaborator - wide.supervisor).dropna()
    return off.mean(), off.sem()


def test_an_effect_that_was_put_in_is_found_and_none_where_none_was(tmp_path: Path) -> None:
    people = SimulatedPeople(effects=(PutInEffect("workload", 0.2, COLLABORATOR),), plays=False)
    folder = rehearse(tmp_path, people, 3)
    mean, error = difference(folder, "workload")
    assert mean > 3.0 * error
    assert mean == pytest.approx(20.0, abs=4.0 * error)
    mean, error = difference(folder, "trust")
    assert abs(mean) < 3.0 * error


def test_a_rehearsal_with_games_links_each_trial_to_its_recording(tmp_path: Path) -> None:
    text = (
        "title: x\nbase: {map: arena8, game.energy: 10, participant.strategy: nearest}\n"
        "within: {robots: [1, 2]}\nquota: 2\nsteps:\n  - {step: trial, each_condition: true, max_seconds: 20}\n"
    )
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0), 1, text)
    played = [e.event for e in read_log(folder.log) if e.event.kind == EventKind.GAME_PLAYED]
    assert len(played) == 4
    for event in played:
        bag = tmp_path / event.data["bag"]
        assert info(bag).messages > 100
        assert hashlib.sha256(bag.read_bytes()).hexdigest() == event.data["sha256"]
        assert event.data["sim_seconds"] > 0


def test_the_same_seed_rehearses_the_same(tmp_path: Path) -> None:
    def logged(name: str, seed: int) -> list[object]:
        (tmp_path / name).mkdir()
        text = "title: x\nquota: 2\nsteps:\n  - {step: form, form: workload}\n  - {step: trial}\n"
        return read_log(rehearse(tmp_path / name, SimulatedPeople(plays=False), seed, text).log)

    assert logged("a", 1) == logged("b", 1) != logged("c", 2)


def test_people_who_drop_out_are_replaced(tmp_path: Path) -> None:
    text = "title: x\nquota: 8\nsteps:\n  - {step: check, form: understood.yaml}\n  - {step: trial}\n"
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.2, plays=False), 2, text)
    runs = Progress(folder.read()).after(read_log(folder.log)).runs.values()
    assert sum(run.state is RunState.COMPLETE for run in runs) == 8
    assert any(run.state is RunState.LEFT for run in runs)


def test_a_rehearsal_whose_program_dies_again_and_again_loses_and_doubles_nothing(tmp_path: Path) -> None:
    text = (
        "title: x\nwithin: {robots: [1, 2]}\nbetween: {noise.preset: [none, bad wheels]}\nquota: 4\nsteps:\n"
        "  - {step: consent, text: hello.txt}\n  - {step: check, form: understood.yaml, attempts: 3}\n"
        "  - {step: trial, each_condition: true}\n  - {step: form, form: workload, each_condition: true}\n"
    )
    (tmp_path / "hello.txt").write_text("Welcome to the study of robots.")
    folder = rehearse(tmp_path, SimulatedPeople(crashes=0.1, plays=False), 4, text)
    design, events = folder.read(), [entry.event for entry in read_log(folder.log)]
    assert sum(event.kind == EventKind.STEP_RESUMED for event in events) > 20
    progress = Progress(design).after(read_log(folder.log))
    whole = [run for run in progress.runs.values() if run.state is RunState.COMPLETE]
    assert sorted(run.place.number for run in whole) == list(range(8))
    for run in whole:
        mine = [event for event in events if event.participant == run.participant]
        begun = [event.step for event in mine if event.kind == EventKind.STEP_BEGUN]
        ended = [event.step for event in mine if event.kind == EventKind.STEP_ENDED]
        # The check may be tried again; all else is begun and ended once, in order.
        checks = {step.number for step in run.plan if step.name == "understood"}
        assert [step for step in begun if step not in checks] == [
            step.number for step in run.plan if step.number not in checks
        ]
        assert begun == ended
        given = [(e.step, e.data["item"]) for e in mine if e.kind == EventKind.ITEM_GIVEN and e.step not in checks]
        assert len(given) == len(set(given)) == 12


def test_effects_name_what_the_experiment_has(tmp_path: Path) -> None:
    write_experiment(tmp_path)
    file = tmp_path / "rehearsal.yaml"
    file.write_text(
        "effects:\n  - {score: wrkload}\n  - {score: trust, where: {dialogue: supervisor}}\n"
        "  - {score: trust, where: {dialogue.condition: superviser}}\nspread: 2\n"
    )
    with pytest.raises(BadFile, match="spread"):
        read_people(file, ExperimentFolder(tmp_path).read())
    file.write_text(file.read_text().replace("spread: 2\n", ""))
    with pytest.raises(BadFiles) as told:
        read_people(file, ExperimentFolder(tmp_path).read())
    problems = [str(fault) for fault in told.value.faults]
    assert "line 2, effects[0].score: no form has a score wrkload" in problems[0]
    assert "dialogue is not a factor. Write one of dialogue.condition" in problems[1]
    assert "dialogue.condition has no level superviser" in problems[2]


def test_time_passes_as_people_need_it(tmp_path: Path) -> None:
    text = "title: x\nquota: 2\nsteps:\n  - {step: form, form: workload}\n  - {step: trial}\n"
    (tmp_path / "slow").mkdir()
    (tmp_path / "fast").mkdir()

    def seconds(name: str, answering: float) -> float:
        people = SimulatedPeople(answering=answering, hesitation=0.0, plays=False, drop_out=0.0)
        folder = rehearse(tmp_path / name, people, 1, text)
        times = [e.event.clocks.monotonic_ns for e in read_log(folder.log) if e.event.participant]
        assert times == sorted(times)
        return times[-1] / 1e9

    assert seconds("slow", 10.0) - seconds("fast", 2.0) == pytest.approx(2 * 6 * 8.0)


def test_simulated_people_who_leave_after_they_agreed_read_the_debriefing(tmp_path: Path) -> None:
    text = (
        "title: x\nquota: 8\nsteps:\n"
        "  - {step: instructions, text: welcome.md}\n  - {step: consent, text: consent.txt}\n"
        "  - {step: check, form: understood.yaml}\n  - {step: pause}\n  - {step: debrief, text: debrief.md}\n"
    )
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.2, crashes=0.05, plays=False), 2, text)
    runs = Progress(folder.read()).after(read_log(folder.log)).runs
    left = {name: run.step for name, run in runs.items() if run.state is RunState.LEFT}
    assert {step > 2 for step in left.values()} == {True, False}, "some before they agreed, some after"
    excluded = {name for name, run in runs.items() if run.state is RunState.EXCLUDED}
    assert excluded, "some fail the check"
    table = next(table for table in tables_of(folder.read(), read_log(folder.log)) if table.name == "participants")
    told = {row["participant"]: row["debriefed"] for row in pd.DataFrame(table.rows).to_dict("records")}
    for name, run in runs.items():
        # A participant who leaves in the middle of the debriefing has not read it to its end.
        expected = run.state is not RunState.LEFT or (2 < run.step < 5)
        assert told[name] is expected, (name, run.state, run.step)


@pytest.mark.parametrize("model", [CostModel.POSITION, CostModel.MATRIX])
def test_the_best_possible_score_is_the_one_that_a_game_tells_at_its_end(
    model: CostModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = []

    def telling(*arguments):
        told.append(debrief_of(*arguments))
        return told[-1]

    monkeypatch.setattr(keeper, "debrief_of", telling)
    study = Study(seed=4, game=GameSection(energy=14.0, cost_model=model))
    setting = SettingCache(Path()).of(study)
    play_hunt(setting, 300.0)
    assert best_possible(setting) == told[0].best > 0


def test_simulated_people_who_are_too_slow_are_stopped_by_the_time_limit(tmp_path: Path) -> None:
    (tmp_path / "quick.yaml").write_text(
        "title: Quickly\nitems:\n  - {id: quick, text: How calm are you?, seconds: 5}\n"
        "  - {id: look, text: Choose 2 here., correct: 2, attention: true}\n"
    )
    text = "title: x\nquota: 20\nsteps:\n  - {step: form, form: quick.yaml}\n"
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0, wrong=0.3, plays=False), 2, text)
    tables = {table.name: pd.DataFrame(table.rows) for table in tables_of(folder.read(), read_log(folder.log))}
    quick = tables["answers"][tables["answers"]["item"] == "quick"]
    assert 3 < quick.timed_out.sum() < 17
    assert quick[quick.timed_out].answer.isna().all() and quick[~quick.timed_out].answer.notna().all()
    assert quick[quick.timed_out].seen_s.tolist() == pytest.approx([5.0] * int(quick.timed_out.sum()))
    assert quick[~quick.timed_out].seen_s.max() < 5.0
    people = tables["participants"]
    assert (people.attention_checks == 1).all()
    assert 8 < people.attention_passed.sum() < 20
