"""Attention checks among the items of a questionnaire: their right answers are checked, and methods count failures."""

from pathlib import Path

from tests.support.studies.rehearsed_studies import rehearse
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.export.methods.text import methods_text
from thbridge.experiment.export.tables import records_of
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import read_log

STUDY = "title: x\nquota: 20\nsteps:\n  - {step: form, form: mood.yaml}\n"
MOOD = """\
title: Mood
like: {points: 5, low: no, high: 'yes', subscale: mood}
items:
  - {id: calm, text: I am calm.}
  - {id: look, text: Please choose 2 here., correct: 2, attention: true}
  - {id: glad, text: I am glad.}
"""


def test_a_right_answer_that_nobody_can_give_is_refused_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "experiment.yaml").write_text(STUDY)
    (tmp_path / "mood.yaml").write_text(MOOD.replace("correct: 2", "correct: 6"))
    found = faults_of(read_experiment(tmp_path / "experiment.yaml"))
    (fault,) = [each for each in found if each.path.name == "mood.yaml"]
    assert (fault.path.name, fault.line, fault.key) == ("mood.yaml", 5, "items[1].correct")


def test_methods_count_those_who_failed_and_no_score_has_an_attention_check(tmp_path: Path) -> None:
    (tmp_path / "mood.yaml").write_text(MOOD)
    folder = rehearse(tmp_path, SimulatedPeople(drop_out=0.0, wrong=0.3, plays=False), 2, STUDY)
    records = records_of(folder.read(), read_log(folder.log))
    failed = sum(subject.attempt.items["look"].answer != 2.0 for subject in records.subjects)
    assert 0 < failed < 20
    text = methods_text(records, {}, "Not registered.")
    assert "The questionnaires had 1 attention check, which did not count for scores." in text
    failures = "1 failure" if failed == 1 else f"{failed} failures"
    analyzed = "Of 20 analyzed participants who answered attention checks"
    assert f"{analyzed}, {failed} failed at least one check ({failures} in total)." in text
    assert "| look | Please choose 2 here. |" in text and "| attention check |" in text
    assert all([item.id for item in score.items] == ["calm", "glad"] for score in records.scores)
