"""Kinds of files that the form can edit: study files, files of studies with people, and questionnaires."""

from pathlib import Path

from ui.model.study_form import draft as studies
from ui.model.study_form import experiment, questionnaire
from ui.model.study_form.draft import StudyDraft
from ui.model.study_form.experiment import is_experiment
from ui.model.study_form.questionnaire import is_questionnaire


def draft_of_file(path: Path, text: str) -> StudyDraft:
    """Read and check the text of a file as `thbridge study check` does; the kind of the file selects the reader."""
    if is_experiment(path):
        return experiment.experiment_draft(path, text)
    if is_questionnaire(path, text):
        return questionnaire.questionnaire_draft(path, text)
    return studies.draft_of(path, text)


def header_of(path: Path) -> str:
    """Return the text of a new file of this kind."""
    if is_experiment(path):
        return experiment.HEADER
    return questionnaire.START if is_questionnaire(path, "") else studies.HEADER


def all_well(path: Path, text: str) -> str:
    """Return the sentence for a file without faults."""
    if is_experiment(path):
        return "No faults found: this study is ready for people."
    if is_questionnaire(path, text):
        return "No faults found: this questionnaire can be used."
    return "No faults found: games of this study can be played."
