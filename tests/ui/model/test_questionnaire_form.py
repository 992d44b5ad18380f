"""A questionnaire is edited by the same form as a study file."""

from pathlib import Path

import pytest

from thbridge.experiment.questionnaires.form import SHIPPED, Form, Item, read_form
from ui.model.study_form.files import draft_of_file, header_of
from ui.model.study_form.form import editable_text
from ui.model.study_form.questionnaire import _OF_SCALES, START, QuestionnaireDraft

TEXT = """\
title: How you feel
like: {scale: likert, points: 5, low: never, high: always}   # what items share
items:
  - {id: calm, text: I feel calm., subscale: ease}
  - {id: hasty, text: I was hasty., subscale: ease, reverse: true}   # the other way round
  - {id: years, text: How old are you?, scale: number, unit: years}
"""


def drafted(folder: Path, text: str = TEXT) -> QuestionnaireDraft:
    draft = draft_of_file(folder / "feelings.yaml", text)
    assert isinstance(draft, QuestionnaireDraft)
    return draft


def test_items_show_the_keys_that_their_scales_heed_and_what_they_share(tmp_path: Path) -> None:
    draft = drafted(tmp_path)
    assert draft.faults == ()
    assert [item.label for item in draft.groups()["items"].groups] == ["1: calm", "2: hasty", "3: years"]
    fields = draft.fields()
    assert fields["items[0].points"].value == "5"
    assert fields["items[0].low"].value == "never"
    assert "items[0].options" not in fields and "items[0].minimum" not in fields
    assert "items[2].minimum" in fields and "items[2].labels" not in fields
    assert fields["items[1].reverse"].written == "true"
    assert all(field.help for field in fields.values())
    assert set(_OF_SCALES) <= set(Item.__dataclass_fields__)


def test_items_are_added_changed_moved_and_removed_and_all_else_stays(tmp_path: Path) -> None:
    draft = drafted(tmp_path)
    draft = drafted(tmp_path, draft.add(draft.groups()["items"]))
    draft = drafted(tmp_path, draft.add(draft.groups()["items"]))
    assert [item.label for item in draft.groups()["items"].groups][3:] == ["4: item_1", "5: item_2"]
    assert draft.faults == ()
    draft = drafted(tmp_path, draft.move(draft.groups()["items[4]"], -1))
    draft = drafted(tmp_path, draft.remove(draft.groups()["items[4]"]))
    draft = drafted(tmp_path, draft.set(draft.fields()["items[3].text"], "I was sure."))
    assert draft.text.splitlines()[:6] == TEXT.splitlines()
    assert draft.text.splitlines()[6:] == ['  - {id: item_2, text: "I was sure."}']


def test_common_keys_are_offered_and_written(tmp_path: Path) -> None:
    draft = drafted(tmp_path)
    like = draft.groups()["like"]
    assert {"subscale", "not_applicable"} <= set(draft.keys_for(like))
    assert not {"id", "text", "scale"} & set(draft.keys_for(like))
    draft = drafted(tmp_path, draft.add_key(like, "not_applicable"))
    draft = drafted(tmp_path, draft.set(draft.fields()["like.not_applicable"], "true"))
    (tmp_path / "feelings.yaml").write_text(draft.text)
    assert all(item.not_applicable for item in read_form(tmp_path / "feelings.yaml").value.items)


def test_faults_stand_at_their_fields(tmp_path: Path) -> None:
    draft = drafted(tmp_path, TEXT.replace("id: hasty", "id: calm").replace("unit: years", "options: [a, a]"))
    places = {draft.field_of(fault).key for fault in draft.faults}
    assert "items[1].id" in places
    draft = drafted(tmp_path, "title: x\nitems:\n  - {id: a, scale: differential}\n")
    assert [draft.field_of(fault).key for fault in draft.faults] == ["items[0].text"]


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*.yaml")), ids=lambda path: path.stem)
def test_shipped_forms_have_no_faults_and_every_key_a_row(path: Path) -> None:
    draft = draft_of_file(path, path.read_text())
    assert isinstance(draft, QuestionnaireDraft)
    assert draft.faults == ()
    read = read_form(path).value
    fields = draft.fields()
    for index, item in enumerate(read.items):
        assert editable_text(fields[f"items[{index}].scale"]) == item.scale
        if f"items[{index}].low" in fields:
            assert editable_text(fields[f"items[{index}].low"]) == item.low
    assert set(Form.__dataclass_fields__) <= {*fields, *draft.groups()}


def test_a_file_that_a_study_names_as_a_form_begins_as_one(tmp_path: Path) -> None:
    steps = "steps:\n  - {step: trial}\n  - {step: form, form: mine.yaml}\n"
    (tmp_path / "experiment.yaml").write_text(f"title: x\n{steps}")
    assert header_of(tmp_path / "mine.yaml") == START
    assert header_of(tmp_path / "other.yaml") != START
    assert draft_of_file(tmp_path / "mine.yaml", START).faults == ()
