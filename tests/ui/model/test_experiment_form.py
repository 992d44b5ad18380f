"""The file of a study with people as a form: all its keys, faults at their rows, every other byte kept."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.studies.experiment_files import EXAMPLE, UNDERSTOOD
from thbridge.experiment.design.experiment_file import ExperimentFile, read_experiment
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.folder import EXAMPLE as SHIPPED
from thbridge.files.yaml.edit import moved
from thbridge.files.yaml.tree import parse
from thbridge.hunt.refusals import RequestRefused
from ui.model.study_form.experiment import _OF_KINDS, ExperimentDraft
from ui.model.study_form.files import draft_of_file, header_of
from ui.model.study_form.form import FormField, editable_text
from ui.model.study_form.resources import is_named, resources_for

COMMENTED = """\
# who decides
title: Robots that argue   # for the registration
consent_elsewhere: Participants signed a form.
within:
  dialogue.condition: [supervisor, collaborator]  # the factor
steps:
  # welcome
  - {step: instructions, text: welcome.md}
  - step: trial  # the game
    each_condition: true
  # at the end
  - {step: form, form: trust}   # ours
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("welcome.md", "consent.txt", "debrief.md"):
        (tmp_path / name).write_text("Read this.\n")
    (tmp_path / "understood.yaml").write_text(UNDERSTOOD)
    return tmp_path


def drafted(folder: Path, text: str = EXAMPLE) -> ExperimentDraft:
    draft = draft_of_file(folder / "experiment.yaml", text)
    assert isinstance(draft, ExperimentDraft)
    return draft


def changed(folder: Path, outcome: str | RequestRefused) -> ExperimentDraft:
    assert isinstance(outcome, str), outcome
    return drafted(folder, outcome)


def faulty(draft: ExperimentDraft) -> dict[str, str]:
    """The faults by the keys of their rows."""
    found: dict[str, str] = {}
    for fault in draft.faults:
        field = draft.field_of(fault)
        found["" if field is None else field.key] = str(fault)
    return found


def test_every_key_has_a_row_with_words(folder: Path) -> None:
    draft = drafted(folder)
    assert draft.faults == ()
    fields = draft.fields()
    groups = draft.groups()
    names = {name for name in ExperimentFile.__dataclass_fields__ if name not in groups}
    assert names <= set(fields)
    assert {"base", "within", "between", "recruiting", "steps", "steps[8]"} <= set(groups)
    assert all(field.help for field in fields.values())
    assert editable_text(fields["within.dialogue.condition"]) == "[supervisor, collaborator]"
    assert fields["base.robots"].written == "2"
    assert groups["steps[3]"].label == "4: check (understood.yaml)"


def test_each_kind_of_step_shows_its_own_keys_and_what_is_written(folder: Path) -> None:
    fields = drafted(folder).fields()
    shown = {key.rpartition(".")[2] for key in fields if key.startswith("steps[3].")}
    assert {"form", "right", "attempts", "repeat", "failed"} <= shown
    assert not {"text", "max_seconds"} & shown
    assert "steps[4].max_seconds" in fields and "steps[4].form" not in fields
    written = drafted(folder, "title: x\nsteps:\n  - {step: pause, attempts: 3}\n").fields()
    assert "steps[0].attempts" in written
    assert set().union(*_OF_KINDS.values()) <= set(StepKind)


def test_factors_and_steps_are_added_changed_and_removed(folder: Path) -> None:
    draft = drafted(folder)
    draft = changed(folder, draft.add_key(draft.groups()["within"], "dialogue.strategy"))
    draft = changed(folder, draft.add_key(draft.groups()["between"], "game.costs_known"))
    assert "between.game.costs_known" in faulty(draft), "no key of studies"
    draft = changed(folder, draft.reset(draft.fields()["between.game.costs_known"]))
    draft = changed(folder, draft.reset(draft.fields()["within.dialogue.strategy"]))
    assert draft.text == EXAMPLE
    draft = changed(folder, draft.add_key(draft.groups()["within"], "participant.attitude"))
    assert draft.fields()["within.participant.attitude"].written.startswith("[")
    assert not [key for key in faulty(draft) if key != "within.participant.attitude"]
    draft = changed(folder, draft.reset(draft.fields()["within.participant.attitude"]))
    draft = changed(folder, draft.set(draft.fields()["within.dialogue.condition"], ""))
    faults = faulty(draft)
    assert "the factor has no levels" in faults["within.dialogue.condition"], "the row stays while it is typed anew"
    draft = changed(folder, draft.set(draft.fields()["within.dialogue.condition"], "[collaborator, supervisor]"))
    draft = changed(folder, draft.add(draft.groups()["steps"]))
    assert draft.groups()["steps[9]"].label == "10: pause"
    draft = changed(folder, draft.set(draft.fields()["steps[9].step"], "form"))
    assert "the step form has no form" in faulty(draft)["steps[9].step"]
    draft = changed(folder, draft.remove(draft.groups()["steps[9]"]))
    assert draft.faults == ()


def test_a_rehearsal_that_no_longer_fits_is_a_fault_as_in_the_check(folder: Path) -> None:
    (folder / "rehearsal.yaml").write_text("effects: [{score: workload, where: {dialogue.condition: supervisor}}]\n")
    assert drafted(folder).faults == ()
    fault, *_ = drafted(folder, EXAMPLE.replace("form: workload", "form: usability")).faults
    assert (fault.path.name, fault.problem) == ("rehearsal.yaml", "no form has a score workload")


def test_a_step_is_moved_with_its_comments_and_all_else_stays(folder: Path) -> None:
    draft = drafted(folder, COMMENTED)
    assert draft.faults == ()
    later = changed(folder, draft.move(draft.groups()["steps[1]"], 1))
    trial, form = "  - step: trial  # the game\n    each_condition: true\n", "  - {step: form, form: trust}   # ours\n"
    end = "  # at the end\n"
    assert later.text == COMMENTED.replace(trial + end + form, end + form + trial)
    assert changed(folder, later.move(later.groups()["steps[2]"], -1)).text == COMMENTED
    assert draft.move(draft.groups()["steps[2]"], 1) == COMMENTED
    assert draft.move(draft.groups()["steps[0]"], -1) == COMMENTED


@given(st.lists(st.sampled_from(["a", "{b: 1}", "[c, d]", "'e'"]), min_size=2, max_size=5), st.data())
def test_an_item_moved_and_moved_back_is_the_same_text(items: list[str], data: st.DataObject) -> None:
    flow, ends = data.draw(st.booleans()), data.draw(st.booleans())
    newline = data.draw(st.sampled_from(["\n", "\r\n"]))
    lines = [f"  # above {index}\n  - {item}  # behind" for index, item in enumerate(items)]
    text = f"key: [{', '.join(items)}]" if flow else "key:\n" + "\n".join(lines)
    text = (text + ("\n" if ends else "")).replace("\n", newline)
    index = data.draw(st.integers(0, len(items) - 2))
    there = moved(text, f"key[{index}]", 1)
    assert isinstance(there, str)
    assert sorted(there) == sorted(text)
    swapped = list(items)
    swapped[index], swapped[index + 1] = swapped[index + 1], swapped[index]
    assert parse(Path("x"), there) is not None
    back = moved(there, f"key[{index + 1}]", -1)
    assert isinstance(back, str)
    if index or flow:
        assert back == text


@pytest.mark.parametrize(
    ("old", "new", "row", "problem"),
    [
        ("quota: 4", "quota: 0", "quota", "1 to 100000"),
        ("title: Robots that argue", "seed: 2", "title", "title"),
        ("supervisor, collaborator]", "supervisr]", "within.dialogue.condition", "supervisr"),
        ("[none, bad wheels]", "{calm: {noise.preset: nine}, wild: {robots: 3}}", "between.noise.preset", "nine"),
        ("{robots: 2}", "{robots: many}", "base.robots", "many"),
        ("text: consent.txt", "text: nowhere.txt", "steps[1].text", "nowhere.txt"),
        (", form: workload", "", "steps[5].step", "the step form has no form"),
        ("repeat: practice", "repeat: practise", "steps[3].repeat", "practise"),
        ("understood.played: 'yes'", "nobody.q: 'yes'", "steps[7].when", "nobody"),
    ],
)
def test_faults_stand_at_their_rows(folder: Path, old: str, new: str, row: str, problem: str) -> None:
    assert old in EXAMPLE
    found = faulty(drafted(folder, EXAMPLE.replace(old, new)))
    assert problem in found[row], found


def test_the_form_tells_the_same_faults_as_the_reader(folder: Path) -> None:
    path = folder / "experiment.yaml"
    text = EXAMPLE.replace("quota: 4", "quota: 3").replace("text: consent.txt", "text: nowhere.txt")
    path.write_text(text)
    with pytest.raises(Exception, match="nowhere") as told:
        read_experiment(path)
    assert "\n".join(str(fault) for fault in drafted(folder, text).faults) in str(told.value)
    assert "not a multiple" in drafted(folder, EXAMPLE.replace("quota: 4", "quota: 3")).notices[0]


def test_what_steps_may_name(folder: Path) -> None:
    (folder / "studies.yaml").write_text("robots: 3\n")
    (folder / "texts").mkdir()
    (folder / "texts" / "more.md").write_text("More to read.")
    draft = drafted(folder)
    named = {key: [each.value for each in resources_for(key, draft)] for key in ("study", "steps[3].form")}
    assert named["study"] == ["studies.yaml"]
    assert named["steps[3].form"] == ["preference", "trust", "usability", "workload", "understood.yaml"]
    assert [each.value for each in resources_for("steps[0].text", draft)] == [
        "consent.txt",
        "debrief.md",
        "welcome.md",
        "texts/more.md",
    ]
    assert all(map(is_named, ("study", "steps[3].form", "steps[12].text")))


def test_new_and_shipped_files(folder: Path) -> None:
    new = drafted(folder, header_of(folder / "experiment.yaml"))
    assert set(faulty(new)) == {"title"}
    new = changed(folder, new.set(new.fields()["title"], "Who decides?"))
    new = changed(folder, new.add(new.groups()["steps"]))
    assert [fault.key for fault in new.faults] == ["steps"]
    new = changed(folder, new.set(new.fields()["consent_elsewhere"], "Participants sign a form."))
    assert new.faults == ()
    text = (SHIPPED / "experiment.yaml").read_text()
    shipped = draft_of_file(SHIPPED / "experiment.yaml", text)
    assert shipped.faults == ()
    broken = drafted(folder, "title: {\n")
    assert broken.tree is None and len(broken.faults) == 1


@given(st.data())
def test_only_the_value_that_is_changed_moves(data: st.DataObject) -> None:
    draft = draft_of_file(SHIPPED / "experiment.yaml", (SHIPPED / "experiment.yaml").read_text())
    field: FormField = data.draw(st.sampled_from([field for field in draft.fields().values() if field.written]))
    outcome = draft.set(field, "7")
    assert isinstance(outcome, str)
    before, after = draft.text.splitlines(), outcome.splitlines()
    different = [number for number, (one, other) in enumerate(zip(before, after, strict=True), 1) if one != other]
    assert set(different) <= {field.line}
