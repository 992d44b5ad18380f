"""The check refuses what a later command would refuse or what spoils data, and advises on what a reviewer would ask."""

from functools import partial
from pathlib import Path

import pytest

from thbridge.experiment.check import check_experiment, read_for_people
from thbridge.experiment.design.advice import advice_on, people_in_words
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.soundness import TAKEN_COLUMNS, faults_of
from thbridge.experiment.export.tables import game_tables, log_tables, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import rehearse
from thbridge.files.errors import BadFile, BadFiles

VERSIONS = {"thbridge": "0"}
FORMS = {
    "understood.yaml": """\
title: Before we begin
like: {scale: choice, shuffle: true}
items:
  - {id: who, text: Who decides?, options: [you, they, both], correct: you}
  - {id: costs, text: What does it cost?, options: [energy, points], correct: energy}
""",
    "feelings.yaml": """\
title: How you feel
like: {low: not at all, high: very much, subscale: calm}
items:
  - {id: calm, text: I feel calm.}
  - {id: quick, text: I was quick., reverse: true}
  - {id: easy, text: It was easy.}
""",
}
SOUND = """\
title: x
base: {participant.shows.answers: false}
within: {dialogue.condition: [supervisor, collaborator]}
quota: 4
recruitment: People came from the campus and were paid.
ethics: The board of the university approved the study (12).
sample_size_reason: As many people came as in the study before.
exclusions: [People who knew the study were excluded.]
steps:
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice}
  - {step: check, form: understood.yaml, attempts: 2, repeat: practice}
  - {step: trial, name: game, each_condition: true}
  - {step: form, form: feelings.yaml, each_condition: true}
  - {step: debrief, text: debrief.txt}
"""
CONSENT = "  - {step: consent, text: consent.txt}\n"


def folder_of(root: Path, text: str = SOUND, **forms: str) -> ExperimentFolder:
    for name in ("consent.txt", "debrief.txt"):
        (root / name).write_text("Read this.\n")
    for name, content in {**FORMS, **{f"{stem}.yaml": form for stem, form in forms.items()}}.items():
        (root / name).write_text(content)
    (root / "experiment.yaml").write_text(text)
    return ExperimentFolder(root)


def replaced(old: str, new: str, text: str = SOUND) -> str:
    assert old in text
    return text.replace(old, new)


def refused(folder: ExperimentFolder) -> str:
    """All faults of a study, without reading maps and words, which takes most of the time of a check."""
    with pytest.raises(BadFile) as told:
        faults = tuple(faults_of(folder.read()))
        raise BadFiles(faults)
    return str(told.value)


def accepted(folder: ExperimentFolder) -> ExperimentDesign:
    design = folder.read()
    assert list(faults_of(design)) == []
    return design


def test_a_sound_study_has_neither_faults_nor_advice(tmp_path: Path) -> None:
    design, kept = check_experiment(folder_of(tmp_path), VERSIONS)
    assert (kept, advice_on(design)) == ((), ())


def test_prices_of_another_map_are_advised_against(tmp_path: Path) -> None:
    text = replaced("base: {", "base: {map: office, game.costs: original-2016, ")
    design, _ = check_experiment(folder_of(tmp_path, text), VERSIONS)
    assert "the costs of moves on the map office come from this file for the map arena8" in "".join(advice_on(design))


# Languages


def test_people_who_would_read_two_languages_are_told_of(tmp_path: Path) -> None:
    text = replaced("{dialogue.condition: [", "{dialogue.language: [en, de], dialogue.condition: [")
    advice, *of_the_set = advice_on(accepted(folder_of(tmp_path, text)))
    assert advice.startswith(
        "The pages of the study are in en, but games are in de. Participants would read several languages."
    )
    assert all("original-2016/de/" in each for each in of_the_set) and of_the_set
    text = replaced("base: {", "base: {dialogue.language: de, templates: everyday-things, ")
    assert advice_on(accepted(folder_of(tmp_path, text))) == ()


def test_words_that_map_and_templates_lack_are_told_of_once_each(tmp_path: Path) -> None:
    text = replaced("base: {", "base: {dialogue.language: de, templates: original-2016, ")
    told = advice_on(accepted(folder_of(tmp_path, text)))
    assert [each.split(":")[1].rpartition("/")[2] for each in told] == [
        "words.yaml, treasures",
        "words.yaml, values of colour",
        "words.yaml, values of footprint",
        "DialogueText",
    ]
    assert all(each.startswith("Participants would read another language: ") for each in told)


def test_texts_that_a_language_lacks_are_told_of(tmp_path: Path) -> None:
    (tmp_path / "words" / "nl").mkdir(parents=True)
    (tmp_path / "words" / "nl" / "ours.yaml").write_text("language: {title: Nederlands, falls_back_on: en}\n")
    text = replaced("base: {", "base: {dialogue.language: nl, dialogue.words: words, ")
    design, _ = check_experiment(folder_of(tmp_path, text), VERSIONS)
    advice = advice_on(design)[0]
    assert advice.startswith("language nl: ") and f"Write them in {tmp_path}/words/nl/texts/" in advice


def test_forms_of_the_program_are_in_the_language_of_the_study_or_it_is_told(tmp_path: Path) -> None:
    feelings = "  - {step: form, form: feelings.yaml, each_condition: true}\n"
    text = replaced(feelings, feelings.replace("feelings.yaml", "preference"))
    design = accepted(folder_of(tmp_path, replaced("base: {", "base: {dialogue.language: de, ", text)))
    (form,) = (form for form in design.forms.values() if "Zusammenarbeit" in form.title)
    assert form.items[0].options[0] == "the first" and form.items[0].labels[0] == "die erste"
    (tmp_path / "words" / "nl").mkdir(parents=True)
    (tmp_path / "words" / "nl" / "ours.yaml").write_text("language: {title: Nederlands, falls_back_on: en}\n")
    text = replaced("base: {", "base: {dialogue.language: nl, dialogue.words: words, ", text)
    assert any(
        advice.startswith("preference: there is no translation of this form into nl, so")
        for advice in advice_on(accepted(folder_of(tmp_path, text)))
    )


# Consent


def test_nobody_is_recorded_without_consent(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, replaced(CONSENT, ""))
    for read in (read_for_people, partial(check_experiment, versions=VERSIONS)):
        with pytest.raises(BadFile, match=r"line 9, steps: no step asks for consent. Write {step: consent"):
            read(folder)


@pytest.mark.parametrize(
    ("behind", "line"),
    [
        ("  - {step: practice, name: practice}\n", "line 10, steps[0]: practice is before the consent"),
        ("  - {step: form, form: feelings.yaml, each_condition: true}\n", "line 10, steps[0]: practice is before"),
    ],
)
def test_consent_comes_before_all_that_is_recorded(tmp_path: Path, behind: str, line: str) -> None:
    text = replaced(behind, behind + CONSENT, replaced(CONSENT, ""))
    assert line in refused(folder_of(tmp_path, text))


def test_a_text_may_come_before_consent(tmp_path: Path) -> None:
    text = replaced(CONSENT, "  - {step: instructions, text: debrief.txt}\n" + CONSENT)
    accepted(folder_of(tmp_path, text))


def test_consent_may_be_given_elsewhere_in_so_many_words(tmp_path: Path) -> None:
    text = replaced("quota: 4\n", "quota: 4\nconsent_elsewhere: Participants signed a form.\n", replaced(CONSENT, ""))
    design = accepted(folder_of(tmp_path, text))
    assert design.file.consent_elsewhere == "Participants signed a form."
    assert "no step asks for consent" in refused(
        folder_of(tmp_path, text.replace("Participants signed a form.", "' '"))
    )


def test_each_group_is_asked_for_consent(tmp_path: Path) -> None:
    text = replaced("within:", "between:").replace("{step: consent,", "{step: consent, only_at: {GROUP},")
    one, other = "dialogue.condition: supervisor", "dialogue.condition: collaborator"
    said = refused(folder_of(tmp_path, text.replace("GROUP", one)))
    assert "no step asks for consent at dialogue.condition=collaborator" in said
    line = replaced("{step: consent,", "{step: consent, name: consent2, only_at: {GROUP},", CONSENT)
    both = text.replace("GROUP", one).replace(
        "  - {step: practice", line.replace("GROUP", other) + "  - {step: practice"
    )
    accepted(folder_of(tmp_path, both))


def test_an_empty_text_is_no_consent(tmp_path: Path) -> None:
    folder = folder_of(tmp_path)
    (tmp_path / "consent.txt").write_text(" \n")
    assert "consent.txt: the consent text is empty" in refused(folder)


def test_a_study_under_way_goes_on_with_faults_that_an_earlier_release_let_pass(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, replaced(CONSENT, ""))
    rehearse(folder, folder.read(), SimulatedPeople(plays=False), 1)
    assert read_for_people(folder).file.title == "x"
    _, kept = check_experiment(folder, VERSIONS)
    assert [fault.problem for fault in kept] == ["no step asks for consent"]


# What later commands refuse, and what spoils data


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "{participant.shows.answers: false}",
            "{robots: 2, dialogue.each: {3: {persistence: 1}}}",
            "line 2, base.dialogue.each.3: there is no robot 3: the study has 2. Write a number from 1 to 2",
        ),
        ("{participant.shows.answers: false}", "{robots_from: ros}", "line 2, base.robots_from: the kiosk supports"),
        ("{participant.shows.answers: false}", "{robots_from: ros2}", "line 2, base.robots_from: the kiosk supports"),
        ("{participant.shows.answers: false}", "{external_nodes: both}", "line 2, base.external_nodes: "),
        (
            "dialogue.condition: [",
            "score: {a: {robots: 1}, b: {robots: 2}}, dialogue.condition: [",
            "within.score: exp",
        ),
        ("quota: 4", "quota: 4\nseeds: [1]", "seeds: 2 trials need 2 seeds, but the list has 1"),
        (
            "game, each_condition: true}",
            "game, each_condition: true}\n  - {step: trial, name: more}",
            "steps[4]: this trial",
        ),
        (
            "form: feelings.yaml,",
            "form: feelings.yaml, when: {practice.who: you},",
            "steps[4].when: practice has no form, so it has no answers",
        ),
        (
            "form: feelings.yaml,",
            "form: feelings.yaml, when: {understood.whom: you},",
            "steps[4].when: understood has no item whom. Write one of understood.who, understood.costs",
        ),
        (
            "form: feelings.yaml,",
            "form: feelings.yaml, when: {understood.who: me},",
            "steps[4].when: 'me' is not a possible answer to understood.who. Write one of you, they, both",
        ),
        (
            "{step: debrief,",
            "{step: debrief, when: {feelings.calm: '5'},",
            "steps[5].when: feelings.calm is not an item with one chosen answer",
        ),
        ("{step: debrief,", "{step: debrief, only_at: {robots: 2},", "steps[5].only_at: robots is not a factor"),
        (
            "{step: debrief,",
            "{step: debrief, only_at: {dialogue.condition: superviser},",
            "steps[5].only_at: dialogue.condition has no level superviser. Write one of supervisor, collaborator",
        ),
        (
            "{step: debrief,",
            "{step: debrief, only_at: {dialogue.condition: supervisor},",
            "steps[5].only_at: each participant plays at all levels of dialogue.condition",
        ),
        (
            "attempts: 2",
            "attempts: 2, right: 3",
            "steps[2].right: the check needs 3 right answers, but only 2 items have a right answer",
        ),
        (
            "repeat: practice}\n  - {step: trial, name: game, each_condition: true}",
            "repeat: practice, each_condition: true}\n  - {step: trial, name: game, each_condition: true}",
            "steps[2].repeat: a participant who fails the check would repeat game, which counts as data",
        ),
    ],
)
def test_what_would_spoil_data_is_refused_at_its_key(tmp_path: Path, old: str, new: str, told: str) -> None:
    assert told in refused(folder_of(tmp_path, replaced(old, new)))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "correct: you",
            "correct: me",
            "line 4, items[0].correct: 'me' is not one of the item's options. Write one of you, they",
        ),
        ("correct: you", "correct: you, several: true", "items[0].correct: an item with several answers"),
        (
            "options: [energy, points]",
            "options: [energy, points, points]",
            "items[1].options: 'points' is listed twice",
        ),
        (
            "options: [energy, points], correct: energy",
            "scale: number, maximum: 5, shuffle: false, correct: '7'",
            "items[1].correct: '7' is not a possible answer. Write a number from 0 to 5",
        ),
        ("correct: you", "correct_by_condition: {robots=2: you}", "correct_by_condition: robots is not a factor"),
        (
            "correct: you",
            "correct_by_condition: {dialogue.condition=supervisor: you}",
            "the right answer at dialogue.condition=collaborator is missing",
        ),
        (
            "correct: you",
            "correct_by_condition: {dialogue.condition=superviser: you}",
            "dialogue.condition has no level superviser. Write one of supervisor, collaborator",
        ),
        (
            "correct: you",
            "correct_by_condition: {dialogue.condition=supervisor: you, dialogue.condition=collaborator: both}",
            "each participant plays at all levels of dialogue.condition, but this item is asked only once",
        ),
    ],
)
def test_a_check_that_judges_wrongly_is_refused_at_its_key(tmp_path: Path, old: str, new: str, told: str) -> None:
    folder = folder_of(tmp_path, understood=replaced(old, new, FORMS["understood.yaml"]))
    said = refused(folder)
    assert str(tmp_path / "understood.yaml") in said
    assert told in said


def test_a_check_in_each_condition_or_by_group_may_be_judged_by_it(tmp_path: Path) -> None:
    by = "correct_by_condition: {dialogue.condition=supervisor: you, dialogue.condition=collaborator: both}"
    understood = replaced("correct: you", by, FORMS["understood.yaml"])
    within = replaced("repeat: practice}", "each_condition: true}")
    accepted(folder_of(tmp_path, within, understood=understood))
    between = replaced("within:", "between:")
    accepted(folder_of(tmp_path, between, understood=understood))


def test_an_answer_key_by_a_factor_that_was_removed_is_refused(tmp_path: Path) -> None:
    by = "correct_by_condition: {dialogue.condition=supervisor: you, dialogue.condition=collaborator: both}"
    understood = replaced("correct: you", by, FORMS["understood.yaml"])
    removed = replaced("within: {dialogue.condition: [supervisor, collaborator]}\n", "")
    said = refused(folder_of(tmp_path, removed, understood=understood))
    assert "dialogue.condition is not a factor of the study. Write `correct` instead." in said


def test_what_rehearsals_read_is_checked_as_well(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, replaced(CONSENT, ""))
    folder.people.write_text("effects:\n  - {score: workload}\n")
    with pytest.raises(BadFile) as told:
        check_experiment(folder, VERSIONS)
    said = str(told.value)
    assert "rehearsal.yaml, line 2, effects[0].score: no form has a score workload. Write one of calm" in said
    assert "no step asks for consent" in said


def test_no_table_has_a_column_that_a_factor_may_be_called(tmp_path: Path) -> None:
    text = replaced("base: {", "base: {game.energy: 10, ").replace("quota: 4", "quota: 2")
    folder = folder_of(tmp_path, text.replace("name: game,", "name: game, max_seconds: 20,"))
    rehearse(folder, folder.read(), SimulatedPeople(drop_out=0.0, wrong=0.0), 1)
    records = records_of(folder.read(), folder.entries())
    tables = [*log_tables(records), *game_tables(records)]
    columns = {column.name for table in tables for column in table.columns}
    assert columns - {"dialogue.condition"} - TAKEN_COLUMNS == set(), "add these to TAKEN_COLUMNS"
    assert len(tables) > 8


# Advice


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("{participant.shows.answers: false}", "{robots: 2}", "may bias their answers to the later form feelings"),
        ("  - {step: debrief, text: debrief.txt}\n", "", "No step explains the purpose of the study afterwards"),
        ("  - {step: practice, name: practice}\n", "", "There is no practice before the first trial"),
        ("quota: 4", "quota: 3", "The quota, 3, is not a multiple of the number of orders, 2"),
        ("quota: 4", "quota: 4\norder: fixed", "All people play the conditions in the same order"),
        ("quota: 4", "quota: 4\nseeds: [5, 5]", "Two trials have the same seed"),
        ("attempts: 2, repeat: practice", "attempts: 1", "understood: a single wrong answer excludes a person"),
        ("recruitment: People came from the campus and were paid.\n", "", "these keys have no text: recruitment."),
        (
            "12).\nsample_size_reason: As many",
            "[Write it]).\nsample_size_reason: As many",
            "these keys have no text: ethics.",
        ),
    ],
)
def test_what_a_reviewer_would_ask_is_advice(tmp_path: Path, old: str, new: str, told: str) -> None:
    text = replaced(old, new)
    text = text if "name: practice" in text else text.replace(", repeat: practice", "")
    (advice,) = advice_on(accepted(folder_of(tmp_path, text)))
    assert told in advice


@pytest.mark.parametrize(
    ("form", "old", "new", "told"),
    [
        (
            "feelings",
            "low: not at all, high: very much, ",
            "",
            "feelings: calm, quick, easy: the ends of the scale have",
        ),
        (
            "feelings",
            "easy, text: It was easy.",
            "easy, text: I feel calm.",
            "feelings: calm, easy: these items have the same text",
        ),
        ("feelings", ", reverse: true", "", "feelings: no item of the score calm is reversed"),
        ("feelings", "It was easy.", "It was easy., subscale: ease", "feelings: the score ease has only one item"),
        ("understood", ", shuffle: true", "", "understood: the right answer is always the first option"),
    ],
)
def test_what_a_reviewer_would_ask_of_a_form_is_advice(
    tmp_path: Path, form: str, old: str, new: str, told: str
) -> None:
    folder = folder_of(tmp_path, **{form: replaced(old, new, FORMS[f"{form}.yaml"])})
    assert any(advice.startswith(told) for advice in advice_on(accepted(folder)))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("quota", "quota", "4 people, 2 conditions for each"),
        ("within:", "between:", "8 people in 2 groups; each person meets one of 2 conditions"),
        (
            "quota:",
            "between: {robots: [1, 2, 3]}\nquota:",
            "12 people in 3 groups; each person meets 2 of 6 conditions",
        ),
        ("within: {dialogue.condition: [supervisor, collaborator]}\n", "", "4 people, one condition"),
    ],
)
def test_conditions_are_counted_as_people_meet_them(tmp_path: Path, old: str, new: str, told: str) -> None:
    design = accepted(folder_of(tmp_path, replaced(old, new)))
    assert people_in_words(design) == told
