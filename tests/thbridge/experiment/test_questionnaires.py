"""Forms read with all faults, scores by the key, and reliability as others compute it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thbridge.experiment.questionnaires.form import SHIPPED, Form, Item, Scale, Scoring, read_form
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE, is_right, reliability_of, scores_of
from thbridge.files.errors import BadFile

FORMS = sorted(SHIPPED.rglob("*.yaml"))


@pytest.mark.parametrize("path", FORMS, ids=[str(path.relative_to(SHIPPED)) for path in FORMS])
def test_shipped_forms_are_right(path: Path) -> None:
    form = read_form(path).value
    assert form.source
    assert all(item.text for item in form.items)


@pytest.mark.parametrize("path", sorted(SHIPPED.glob("*/*.yaml")), ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_translated_form_makes_the_same_data(path: Path) -> None:
    english = read_form(SHIPPED / path.name).value

    def codes(form: Form) -> tuple[object, ...]:
        words = dict.fromkeys(("text", "low", "high", "unit"), "") | {"labels": ()}
        items = tuple(replace(item, **words) for item in form.items)
        return replace(form, title="", instructions="", source="", items=items, like={})

    assert codes(read_form(path).value) == codes(english)
    for item, other in zip(read_form(path).value.items, english.items, strict=True):
        assert not item.options or (item.labels and not set(item.labels) & set(other.options))


def test_labels_of_answers_are_as_many_as_these_and_follow_them_when_they_are_shuffled(tmp_path: Path) -> None:
    who = Item("who", text="Wer?", scale=Scale.CHOICE, options=tuple("abcdef"), labels=tuple("ABCDEF"), shuffle=True)
    shown = [Form("t", items=(who,)).order(1, f"P-{person}")[0] for person in range(20)]
    assert len({item.options for item in shown}) > 1
    assert all("".join(item.labels).lower() == "".join(item.options) for item in shown)
    form = "title: x\nitems:\n  - {id: who, text: Wer?, scale: choice, options: [a, b], labels: [A]}\n"
    (tmp_path / "form.yaml").write_text(form)
    with pytest.raises(BadFile, match=r"2 answers need 2 labels, not 1\. Write one label for each answer"):
        read_form(tmp_path / "form.yaml")


def test_workload_is_the_mean_of_six_lines_of_which_performance_is_reversed() -> None:
    form = read_form(SHIPPED / "workload.yaml").value
    answers = {
        "mental": 80.0,
        "physical": 10.0,
        "temporal": 60.0,
        "effort": 70.0,
        "frustration": 20.0,
        "performance": 90.0,
    }
    assert scores_of(form, answers) == {"workload": pytest.approx((80 + 10 + 60 + 70 + 20 + 10) / 6)}


def test_a_score_needs_its_items_and_not_applicable_is_no_number() -> None:
    items = tuple(Item(name, text=name, subscale="trust") for name in "abcd")
    answers = {"a": 7.0, "b": 5.0, "c": NOT_APPLICABLE}
    assert math.isnan(scores_of(Form("t", items=items), answers)["trust"])
    half = Form("t", items=items, answered=0.5)
    assert scores_of(half, answers) == {"trust": 6.0}
    assert scores_of(Form("t", items=items, answered=0.5, scoring=Scoring.SUM), answers) == {"trust": 24.0}


def test_items_come_in_an_order_of_each_persons_own_and_always_the_same() -> None:
    form = read_form(SHIPPED / "trust.yaml").value
    orders = {person: form.order(1, person) for person in ("P-AAAA", "P-BBBB")}
    assert orders["P-AAAA"] != orders["P-BBBB"]
    assert form.order(1, "P-AAAA") == orders["P-AAAA"]
    assert set(orders["P-AAAA"]) == set(form.items)


def test_answers_come_in_an_order_of_each_participants_own_and_pinned_ones_keep_their_place() -> None:
    options = ("you", "the robots", "both", "chance", "none of these")
    likert = Item("sure", text="I am sure.", labels=("no", "a bit", "yes"), points=3)
    who = Item("who", text="Who?", scale=Scale.CHOICE, options=options, shuffle=True, pinned=("none of these",))
    form = Form("t", items=(who, likert))
    shown = {person: form.order(1, f"P-{person}") for person in range(200)}
    assert shown[0] == form.order(1, "P-0")
    assert form.order(2, "P-0")[0].options != form.order(3, "P-0")[0].options
    assert all(set(first.options) == set(options) for first, _ in shown.values())
    assert {first.options[-1] for first, _ in shown.values()} == {"none of these"}
    assert {other for _, other in shown.values()} == {likert}
    firsts = [first.options[0] for first, _ in shown.values()]
    assert all(30 < firsts.count(option) < 70 for option in options[:-1])


def test_an_answer_is_right_by_the_condition_in_which_it_is_given() -> None:
    by = {"dialogue.condition=supervisor": "you", "dialogue.condition=collaborator": "both"}
    item = Item("who", text="Who?", scale=Scale.CHOICE, options=("you", "both"), correct_by_condition=by)
    assert is_right(item, "you", {"dialogue.condition": "supervisor"})
    assert is_right(item, "you", {"dialogue.condition": "collaborator"}) is False
    assert is_right(item, "you", {"robots": "2"}) is None
    assert is_right(Item("n", text="n", scale=Scale.NUMBER, correct="3"), 3.0, {})
    assert is_right(Item("n", text="n", scale=Scale.TEXT, correct="Energy"), " energy ", {})


def test_scales_are_never_shuffled(tmp_path: Path) -> None:
    (tmp_path / "form.yaml").write_text(
        "title: Mine\nitems:\n  - {id: a, text: a, shuffle: true}\n"
        "  - {id: b, text: b, scale: choice, options: [x, y], shuffle: true, pinned: [z]}\n"
    )
    with pytest.raises(BadFile) as told:
        read_form(tmp_path / "form.yaml")
    assert "line 3, items[0].shuffle: the answers of a likert item have a fixed order" in str(told.value)
    assert "line 4, items[1].pinned: 'z' is not one of the item's options. Write some of x, y" in str(told.value)


def test_all_faults_of_a_form_are_told_with_their_lines(tmp_path: Path) -> None:
    (tmp_path / "form.yaml").write_text(
        "title: Mine\nlike: {points: 5}\nitems:\n"
        "  - {id: Q1, text: a}\n  - {id: q2, text: b, labels: [no, yes]}\n  - {id: q2, text: ''}\n"
        "  - {id: q3, scale: choice, text: c, options: [one]}\n  - {id: q4, text: d, reverse: true}\n"
    )
    with pytest.raises(BadFile) as told:
        read_form(tmp_path / "form.yaml")
    lines = str(told.value).splitlines()
    assert [line.split(", ")[1] for line in lines] == ["line 4", "line 5", "line 6", "line 6", "line 7", "line 8"]
    assert "5 points need 5 labels, not 2" in lines[1]


def test_an_unknown_scale_names_those_that_there_are(tmp_path: Path) -> None:
    (tmp_path / "form.yaml").write_text("title: Mine\nitems:\n  - {id: a, text: a, scale: slider}\n")
    with pytest.raises(BadFile, match=f"line 3.*{', '.join(Scale)[:20]}"):
        read_form(tmp_path / "form.yaml")


def people(rows) -> list[dict[str, float]]:
    return [{f"q{i}": float(value) for i, value in enumerate(row)} for row in rows]


ITEMS = [Item(f"q{i}", scale=Scale.ANALOGUE, subscale="s") for i in range(4)]


def test_alpha_of_answers_that_are_all_the_same_but_for_a_constant_is_one() -> None:
    told = reliability_of(ITEMS, people([[v, v + 1, v + 2, v] for v in (1, 5, 2, 9)]))
    assert told.alpha == pytest.approx(1.0)
    assert (told.people, told.items) == (4, 4)


def test_alpha_and_omega_of_one_factor_are_those_of_the_population() -> None:
    loadings = np.array([0.9, 0.8, 0.6, 0.5])
    rng = np.random.default_rng(1)
    common, own = rng.standard_normal((200_000, 1)), rng.standard_normal((200_000, 4))
    told = reliability_of(ITEMS, people(50 + common * loadings + own * np.sqrt(1 - loadings**2)))
    covariance = np.outer(loadings, loadings) + np.diag(1 - loadings**2)
    assert told.omega == pytest.approx(loadings.sum() ** 2 / covariance.sum(), abs=0.003)
    assert told.alpha == pytest.approx(4 / 3 * (1 - np.trace(covariance) / covariance.sum()), abs=0.003)
    assert told.omega > told.alpha


def test_people_who_left_an_item_out_do_not_count_for_reliability() -> None:
    answers = people([[1, 2, 3, 4], [2, 3, 3, 5], [9, 9, 8, 7]])
    del answers[0]["q2"]
    assert reliability_of(ITEMS, answers).people == 2


def test_reliability_of_one_person_is_not_a_number() -> None:
    assert math.isnan(reliability_of(ITEMS, people([[1, 2, 3, 4]])).alpha)


def test_an_attention_check_needs_its_right_answer(tmp_path: Path) -> None:
    file = tmp_path / "form.yaml"
    file.write_text("title: x\nitems:\n  - {id: a, text: Choose 2., attention: true}\n")
    with pytest.raises(BadFile, match="the attention check has no right answer") as raised:
        read_form(file)
    fault = getattr(raised.value, "faults", (raised.value,))[0]
    assert (fault.line, fault.key) == (3, "items[0].attention")
