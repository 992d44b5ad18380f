"""The methods text: right about designs, people, checks and settings, whatever happened in a study."""

import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.studies.experiment_files import EXAMPLE, write_experiment
from tests.support.studies.rehearsed_studies import rehearse
from tests.thbridge.experiment.crashing_laboratory import CrashingLaboratory
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.experiment_file import ExperimentDesign, read_experiment
from thbridge.experiment.export.folder import export_experiment, remake_export
from thbridge.experiment.export.methods.participants import FATES, outcomes_of
from thbridge.experiment.export.methods.text import methods_text
from thbridge.experiment.export.tables import ExperimentRecords, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.progress import RunState
from thbridge.experiment.questionnaires.form import SHIPPED, Item, read_form
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import EventKind, JsonValue, LogEntry

VERSIONS = {"thbridge": "1.0", "python": "3.11"}
HEADINGS = [
    "Participants",
    "Sample size, power, and precision",
    "Conditions and design",
    "Materials and apparatus",
    "Measures",
    "Procedure",
    "Data collection and quality of measurements",
    "Data diagnostics and exclusions",
    "Analytic strategy",
    "Preregistration and deviations",
    "Availability of data and materials",
]
"""Those of APA's reporting standards for a Method section, in their order."""


def text_of(records: ExperimentRecords, registered: str = "It was not frozen.") -> str:
    return methods_text(records, VERSIONS, registered)


def rehearsed(folder: Path, text: str, **people: object) -> str:
    place = rehearse(folder, SimulatedPeople(plays=False, **people), 1, text)
    return text_of(records_of(place.read(), read_log(place.log), folder))


WITHIN = "within: {dialogue.condition: [supervisor, collaborator]}\n"
THREE = "within: {dialogue.condition: [supervisor, script, collaborator]}\n"
BETWEEN = "between: {dialogue.condition: [supervisor, collaborator]}\n"
BOTH = "within: {robots: [1, 2]}\n" + BETWEEN
STEPS = """\
quota: 2
steps:
  - {step: trial, each_condition: true}
  - {step: form, form: workload, each_condition: true}
"""


@pytest.mark.parametrize(
    ("design", "has", "has_not"),
    [
        (
            WITHIN,
            ["within-participants design: each participant played in all 2 conditions", "balanced Latin square"],
            ["to groups", "between"],
        ),
        (
            BETWEEN,
            [
                "between-participants design with 2 groups: each participant played one game",
                "to groups at random",
                "| who decides: supervisor (robots obey); collaborator (robots argue, and both sides must agree "
                "before a robot acts) |",
            ],
            ["Latin square", "rder of conditions", "within-participants", "script", "autonomous"],
        ),
        (
            BOTH,
            [
                "a 2 x 2 mixed design. dialogue.condition varied between participants (2 groups), robots within",
                "to groups at random in blocks of 2",
                "Latin square",
                "in blocks within each group",
            ],
            [],
        ),
        ("", ["a single condition: no factor was varied"], ["Latin square", "to groups", "Factors", "order was"]),
        (THREE + "order: cyclic\n", ["cyclic Latin square", "not a multiple of 3"], ["balanced Latin"]),
        (THREE, ["with 6 orders", "not a multiple of 6"], []),
        (WITHIN + "order: fixed\n", ["in the same order, so condition and order are confounded"], ["Latin square"]),
    ],
)
def test_each_design_is_described_as_it_is(design: str, has: list[str], has_not: list[str], tmp_path: Path) -> None:
    text = rehearsed(tmp_path, f"title: x\n{design}{STEPS}", drop_out=0.0)
    assert re.findall("^### (.*)$", text, re.MULTILINE) == HEADINGS
    section = text[text.index("### Conditions") : text.index("### Materials")]
    for words in has:
        assert words in section
    for words in has_not:
        assert words not in section


class QuickLaboratory(CrashingLaboratory):
    """A laboratory whose log need not outlast a power cut."""

    def restart(self) -> None:
        self.log = ExperimentLog(self._path, synced=False)
        self.conductor = Conductor(self._design, self.log, self._now, self.chance.randrange)


class Course:
    """A study in which somebody declined, left, was ended, excluded, failed, withdrew, is there, or completed."""

    def __init__(self, root: Path) -> None:
        self.folder = ExperimentFolder(root)
        write_experiment(
            root, EXAMPLE.replace("between", "recruitment: Students of our university were paid 10 EUR\nbetween")
        )
        self.folder.log.parent.mkdir()
        self.laboratory = QuickLaboratory(self.folder.read(), self.folder.log, 1)
        self.conductor = self.laboratory.conductor
        for fate in ("complete", "complete", "declined", "left", "ended", "excluded", "fails", "retries", "withdrawn"):
            self.take_part(fate)
        self.conductor.begin(self.conductor.admit().participant)
        self.laboratory.log.close()

    def take_part(self, fate: str) -> None:
        conductor, person = self.conductor, self.conductor.admit().participant
        wrong = {"fails": 2, "retries": 1}.get(fate, 0)
        while (step := conductor.begin(person)) is not None:
            if step.name == "consent_2":
                data = {"agrees": fate != "declined", "version": "ab" * 32}
                conductor.tell(EventKind.CONSENT_ANSWERED, person, step, data, "participant")
                if fate == "declined":
                    return conductor.leave(person, "did not agree", declined=True)
            if step.name == "trial_5" and fate in {"left", "ended"}:
                by = {"actor": "experimenter"} if fate == "ended" else {}
                return conductor.leave(person, "fire alarm" if by else "stopped taking part", **by)
            for item in conductor.form(step).items if step.entry.form else ():
                answer = item.correct or (item.options[0] if item.options else item.least)
                if item.correct and wrong:
                    answer, wrong = "they", wrong - 1
                data = {"item": item.id, "answer": answer}
                conductor.tell(EventKind.ITEM_GIVEN, person, step, data, "participant")
            conductor.end(person, step)
        if fate == "excluded":
            conductor.exclude(person, "knew the | study")
        if fate == "withdrawn":
            conductor.withdraw(person)
        return None


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    return Course(tmp_path_factory.mktemp("course"))


def test_everybody_who_began_is_in_the_flow_with_a_reason(course: Course) -> None:
    text = text_of(records_of(course.folder.read(), read_log(course.folder.log)))
    assert (
        "The plan required 8 participants with complete data. Of 10 participants who began, 1 declined to take part, "
        "1 left before the end, 1 had their run ended by the researcher, 2 were excluded, 1 withdrew and had all of "
        "their data deleted, 1 was still taking part at the time of this export, and 3 completed the study and were "
        "analyzed. Data collection was not complete at the time of this export. They took part on 2026-01-02."
    ) in text
    table = text[text.index("*Flow of participants*") :].split("\n\n")[1].splitlines()[2:]
    cells = [line.strip("| ").split(" | ") for line in table]
    rows = {tuple(row[:2]): [0 if number == "unknown" else int(number) for number in row[2:]] for row in cells}
    assert ["Withdrew, data deleted", "", "unknown", "unknown", "1"] in cells
    for row in (
        ("Declined", "did not agree"),
        ("Left", "stopped taking part, at trial_5"),
        ("Ended by the researcher", "fire alarm, at trial_5"),
        ("Excluded", "failed the check Before we begin"),
        ("Excluded", r"knew the \| study (after completing the study)"),
    ):
        assert rows[row][-1] == 1
    began = rows.pop(("Began, in total", ""))
    assert began == [sum(numbers) for numbers in zip(*rows.values(), strict=True)]
    assert (began[2], sum(began[:2])) == (10, 9), "the group of who withdrew is deleted with their data"


def test_checks_have_their_attempts_and_failures(course: Course) -> None:
    text = text_of(records_of(course.folder.read(), read_log(course.folder.log)))
    assert "The check *Before we begin* had 1 question with a right answer; it took 1 right answer to pass." in text
    assert "It could be tried up to 2 times, repeating from the step practice after a failure." in text
    assert "Participants who failed the last attempt were excluded." in text
    # Of ten who began, one declined, one is still reading, and one withdrew.
    assert (
        "Of 7 participants who answered it, 5 passed at the first attempt, 1 at a later attempt, and 1 did not pass "
        "(9 attempts, 3 failures)."
    ) in text
    assert "*Questions of Before we begin*" in text
    assert "| Who decides where robots go? | one of: you; they | you |" in text
    durations = text[text.index("*Durations of those analyzed*") : text.index("### Data collection")]
    assert "The step of a game includes its start and the page with its result." in durations
    assert "If steps were repeated after a failed check, each repetition counts." in durations
    # Data collection goes on: nothing says that it has ended.
    assert "was set to admit people until this number of valid runs was reached. If a run did not count" in text


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**6), withdrawn=st.integers(0, 2))
def test_outcomes_add_up_in_any_course_of_an_experiment(
    design: ExperimentDesign, tmp_path_factory: pytest.TempPathFactory, seed: int, withdrawn: int
) -> None:
    laboratory = QuickLaboratory(design, tmp_path_factory.mktemp("course") / "log", seed)
    people = [laboratory.conductor.admit().participant for _ in range(4)]
    for person in people[:3]:
        laboratory.run(person)
    if seed % 2:
        laboratory.conductor.exclude(people[1], "knew the study")
    for person in people[:withdrawn]:
        laboratory.conductor.withdraw(person)
    laboratory.log.close()
    records = records_of(design, read_log(laboratory.log.path))
    counts = Counter(outcome.fate for outcome in outcomes_of(records))
    assert sum(counts.values()) == len(people)
    assert {*counts} <= {*FATES}
    assert {*map(str, RunState)} <= {*FATES}
    assert counts["complete"] == len(records.progress.valid)
    assert counts["withdrawn"] == withdrawn
    assert f"Of {len(people)} participants who began" in text_of(records)


def test_an_export_that_is_made_again_says_that_somebody_withdrew(course: Course, tmp_path: Path) -> None:
    write_experiment(tmp_path)
    folder = ExperimentFolder(tmp_path)
    folder.log.parent.mkdir()
    laboratory = QuickLaboratory(folder.read(), folder.log, 3)
    people = [laboratory.conductor.admit().participant for _ in range(3)]
    for person in people:
        laboratory.run(person)
    export = tmp_path / "exports" / "first"

    def text() -> str:
        return (export / "methods.md").read_text()

    export_experiment(folder, folder.read(), read_log(folder.log), export, VERSIONS, None)
    assert "Of 3 participants who began" in text()
    assert "withdrew" not in text()
    # Somebody who came after the export is not in it, and neither is their withdrawal.
    later = laboratory.conductor.admit().participant
    laboratory.conductor.withdraw(later)
    laboratory.conductor.withdraw(people[0])
    laboratory.log.close()
    remake_export(folder, folder.read(), read_log(folder.log), export, VERSIONS, None)
    assert "Of 3 participants who began" in text()
    assert "1 withdrew and had all of their data deleted" in text()


FULL = """\
title: x
recruitment: Students were paid 10 EUR
ethics: The board of our university approved the study (number 12-3).
sample_size_reason: Two groups of 2 find nothing, which is enough for a test
exclusions: [Runs of colorblind participants, "Answers in less than a second."]
preregistration: https://osf.io/abcde
deviations: ["We tested 4 participants instead of 40, for lack of time."]
data_availability: https://osf.io/fghij
most_lag: 5
base: {robots: 3, game.energy: 40, dialogue.language: de, server.port: 0, each: {2: {localization: ekf}}}
quota: 2
steps:
  - {step: trial}
  - {step: form, form: people.yaml, name: people}
"""
PEOPLE = """\
title: About you
items:
  - {id: age, text: How old are you?, scale: number, minimum: 18, maximum: 99, unit: years}
  - {id: gender, text: What is your gender?, scale: choice, options: [woman, man, "another, or none"]}
  - {id: who, text: Who decided?, scale: choice, options: [I did., They did.]}
"""


def test_what_the_researcher_wrote_fills_the_brackets(tmp_path: Path) -> None:
    (tmp_path / "people.yaml").write_text(PEOPLE)
    text = rehearsed(tmp_path, FULL, drop_out=0.0)
    for said in (
        "Students were paid 10 EUR.",
        "(number 12-3).",
        "which is enough for a test.",
        "* Runs of colorblind participants\n* Answers in less than a second.",
        "* We tested 4 participants instead of 40, for lack of time.",
        "https://osf.io/abcde",
        "https://osf.io/fghij",
        "* A game that was more than 5 s behind real time.",
        "stated their age (M = ",
        "They stated as their gender: ",
        "| robots | 2 | 3 |",
        "| game.energy | 100.0 | 40.0 |",
        "| dialogue.language | en | de |",
        "| each.2.localization | not set | ekf |",
        "| age | How old are you? | number from 18 to 99 years |",
        "| who | Who decided? | one of: I did; They did |",
        "[Source of this form.]",
    ):
        assert said in text, said
    assert "server.port" not in text
    for gap in (
        "[State how, where",
        "[State which ethics",
        "[Reason for this",
        "[Rules by",
        "[State where",
        "[State each deviation",
    ):
        assert gap not in text


def test_a_rehearsal_says_that_programs_took_part(course: Course, tmp_path: Path) -> None:
    text = rehearsed(tmp_path, f"title: x\n{WITHIN}{STEPS}")
    assert "**This is a rehearsal by programs. No number below describes human participants.**" in text
    assert "simulated participants who began" in text
    real = text_of(records_of(course.folder.read(), read_log(course.folder.log)))
    assert "simulated participants" not in real
    assert "This is a rehearsal" not in real


def _with_practice(folder: Path) -> tuple[ExperimentDesign, list[LogEntry]]:
    """A study with practice in each condition, which nobody has taken part in."""
    folder.mkdir()
    text = (
        f"title: x\n{WITHIN}ethics: '[Write who approved it.]'\nsteps:\n"
        "  - {step: practice, max_seconds: 300, each_condition: true}\n  - {step: trial, each_condition: true}\n"
    )
    return read_experiment(write_experiment(folder, text)), []


def test_practice_debriefing_and_consent_elsewhere_are_in_the_procedure(tmp_path: Path) -> None:
    text = rehearsed(
        tmp_path,
        f"title: x\n{WITHIN}quota: 2\nconsent_elsewhere: Participants signed a form on paper\nsteps:\n"
        "  - {step: practice, max_seconds: 300, base: {game.energy: 20}, at_least: {moves: 2, pictures: 0, "
        "identified: 1}}\n"
        "  - {step: instructions, text: welcome.md, each_condition: true, only_at: {dialogue.condition: supervisor}}\n"
        "  - {step: trial, each_condition: true, max_seconds: 60}\n"
        "  - {step: debrief, text: debrief.md, results: true}\n",
        drop_out=0.0,
    )
    section = text[text.index("### Procedure") : text.index("### Data collection")]
    assert (
        "1. Practice game of at most 300 s, in the settings of the participant's first condition, except for "
        "game.energy: 20.0, with another random seed; participants could continue after at least "
        "2 moves and 1 named treasure.\n"
        "2. For each condition, in the participant's order:\n"
        "    * Instructions on screen (welcome.md); only at dialogue.condition=supervisor.\n"
        "    * Game of at most 60 s.\n"
        "3. Debriefing on screen (debrief.md), with the score and the best possible score of each game, also for "
        "participants who left or were excluded.\n"
    ) in section
    assert "Participants signed a form on paper." in section
    each = text_of(records_of(*_with_practice(tmp_path / "each")))
    assert "* Practice game of at most 300 s, in the settings of that condition, with another random seed; part" in each
    assert "[Write who approved it.] " not in each
    assert "[Write who approved it.]\n" in each
    assert "[How" not in section


class SilentPeople(SimulatedPeople):
    """People who answer only what has to be answered."""

    def answer(self, item: Item, *rest: Any) -> JsonValue:
        return super().answer(item, *rest) if item.required else None


def test_a_study_between_participants_names_no_first_condition_and_what_might_be_left_out(tmp_path: Path) -> None:
    (tmp_path / "more.yaml").write_text(
        "title: More\nitems:\n  - {id: calm, text: I felt calm., low: no, high: yes}\n"
        "  - {id: why, text: Anything else?, scale: text, required: false}\n"
        "  - {id: pick, text: Which?, scale: choice, options: [one, other, none], shuffle: true, pinned: [none]}\n"
    )
    steps = "base: {robots: 1}\nquota: 1\nsteps:\n  - {step: practice}\n"
    steps += "  - {step: trial}\n  - {step: form, form: more.yaml}\n"
    place = rehearse(tmp_path, SilentPeople(plays=False, drop_out=0.0), 1, f"title: x\n{BETWEEN}{steps}")
    text = text_of(records_of(place.read(), read_log(place.log), tmp_path))
    assert (
        "in the settings of the participant's condition, with another random seed; participants could continue" in text
    )
    assert "One participant and one simulated mobile robot searched the rooms" in text
    assert "one of: one; other; none, in random order except for “none” |" in text
    assert "Of 6 answers to questionnaires, 2 were empty (2 of them to optional items)" in text


def test_what_a_study_leaves_out_is_not_made_up(tmp_path: Path) -> None:
    text = rehearsed(tmp_path, "title: x\nquota: 1\nsteps:\n  - {step: form, form: usability}\n", drop_out=0.0)
    assert "treasure hunt" not in text
    assert "[How simulated participants gave informed consent: no step of the program asked for it.]" in text
    assert "All settings of the games were the defaults" in text
    for words in ("Latin square", "recording", "random seed"):
        assert words not in text


@pytest.mark.parametrize("form", sorted(SHIPPED.glob("*.yaml")), ids=lambda path: path.stem)
def test_forms_that_come_with_the_program_name_their_source_and_whose_words_they_have(form: Path) -> None:
    source = read_form(form).value.source
    assert "in thbridge's own words, which no published study has validated" in source
    assert re.search(r"\d{4}\)", source) or form.stem == "preference"
