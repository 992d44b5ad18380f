"""Sheets of a template set: a change of a cell is a change of this value in the text, and of nothing else."""

from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused
from ui.model.template_set.sheet import Changed, Sheet, Texts
from ui.model.template_set.sheets import sheets_of

SHIPPED = Path(__file__).parents[3] / "templates"
PICTURES = ("one.jpg", "two.jpg")
WORDS = st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cs", "Zl", "Zp")), max_size=12).map(str.strip)


def texts_of(name: str) -> dict[str, str]:
    """The texts of a shipped set."""
    files = ("DialogueText", "treasures.yaml", "treasures", "treasures.participant")
    return {file: (SHIPPED / name / file).read_text() for file in files if (SHIPPED / name / file).exists()}


def done(texts: Texts, changed: Changed) -> dict[str, str]:
    """The texts after a change."""
    assert not isinstance(changed, RequestRefused), changed.sentence
    return {**texts, **changed}


def sheet(texts: Texts, title: str = "Treasures") -> Sheet:
    return sheets_of(texts, PICTURES)[title]


NEW = texts_of("four-properties")
OLD = texts_of("original-2016")


@given(data=st.data(), typed=WORDS, title=st.sampled_from(["Treasures", "Properties"]))
def test_a_cell_of_a_yaml_file_reads_as_it_was_typed_and_all_others_as_before(
    data: st.DataObject, typed: str, title: str
) -> None:
    before = sheet(NEW, title)
    row = data.draw(st.integers(0, len(before.rows) - 1))
    column = data.draw(st.integers(0, len(before.columns) - 1))
    # Names and values of properties are carried on to treasures; that is another test.
    assume(title == "Treasures" or before.columns[column].path not in {"name", "values"})
    after = done(NEW, before.put(row, column, typed))
    wanted = [list(cells) for cells in before.rows]
    wanted[row][column] = typed
    assert [list(cells) for cells in sheet(after, title).rows] == wanted
    lines = zip(NEW["treasures.yaml"].splitlines(), after["treasures.yaml"].splitlines(), strict=True)
    assert sum(was != now for was, now in lines) <= 1


@given(row=st.integers(0, 3), column=st.integers(0, 4), typed=WORDS.filter(lambda text: "," not in text and text))
def test_a_field_of_a_list_of_2016_reads_as_it_was_typed_in_both_copies(row: int, column: int, typed: str) -> None:
    before = sheet(OLD)
    after = done(OLD, before.put(row, column, typed))
    wanted = [list(cells) for cells in before.rows]
    wanted[row][column] = typed
    assert [list(cells) for cells in sheet(after).rows] == wanted
    listed, copied = (after[name].splitlines()[1:] for name in ("treasures", "treasures.participant"))
    assert [line.rpartition(",")[0].strip() for line in listed if line] == [line.strip() for line in copied if line]


@pytest.mark.parametrize("texts", [NEW, OLD], ids=["yaml", "2016"])
def test_a_row_is_added_copied_and_removed_without_a_trace(texts: Texts) -> None:
    count = len(sheet(texts).rows)
    added = done(texts, sheet(texts).add())
    assert len(sheet(added).rows) == count + 1
    copied = done(added, sheet(added).add(0))
    names = [cells[[column.path for column in sheet(copied).columns].index("name")] for cells in sheet(copied).rows]
    assert len({*names}) == count + 2
    fewer = done(copied, sheet(copied).remove(count + 1))
    assert done(fewer, sheet(fewer).remove(count)) == texts


def test_a_property_is_added_to_every_treasure_and_removed_from_it() -> None:
    added = done(NEW, sheet(NEW, "Properties").add())
    assert [cells[-1] for cells in sheet(added).rows] == ["small"] * 8
    assert done(added, sheet(added, "Properties").remove(4)) == NEW


def test_a_new_name_of_a_property_is_carried_to_treasures_and_sentences() -> None:
    after = done(NEW, sheet(NEW, "Properties").put(2, 0, "mass"))
    listed = after["treasures.yaml"].partition("properties:")[2]
    assert listed == NEW["treasures.yaml"].partition("properties:")[2].replace("weight", "mass")
    assert after["DialogueText"] == NEW["DialogueText"].replace("£weight£", "£mass£")


@pytest.mark.parametrize(
    ("typed", "colours"),
    [
        ("crimson, green", ["crimson"] * 4 + ["green"] * 4),
        ("red, green, blue", ["red"] * 4 + ["green"] * 4),
        # Two at once may be anything; the faults of the treasures say what is left to do.
        ("green, red", ["red"] * 4 + ["green"] * 4),
    ],
)
def test_treasures_follow_a_value_that_is_called_otherwise(typed: str, colours: list[str]) -> None:
    after = done(NEW, sheet(NEW, "Properties").put(0, 2, typed))
    assert [cells[3] for cells in sheet(after).rows] == colours
    assert sheet(after, "Properties").rows[0][2] == typed


def test_a_treasure_written_line_by_line_is_changed_in_its_line() -> None:
    text = "treasures:\n  - name: pot  # of clay\n    points: 5\n    image: one.jpg\n    values:\n      colour: red\n"
    texts = {"treasures.yaml": f"properties:\n  - name: colour\n{text}", "DialogueText": ""}
    after = done(texts, sheet(texts).put(0, 0, "jug"))
    assert after["treasures.yaml"] == texts["treasures.yaml"].replace("pot", "jug")
    copied = done(after, sheet(after).add(0))
    assert sheet(copied).rows == (("jug", "5", "one.jpg", "red"), ("jug 2", "5", "one.jpg", "red"))


def test_what_is_no_yaml_has_no_sheets() -> None:
    assert sheets_of({"treasures.yaml": "treasures: [", "DialogueText": ""}) == {}


def test_a_comma_would_be_another_field_and_is_refused() -> None:
    assert isinstance(sheet(OLD).put(0, 3, "can, pink"), RequestRefused)


@pytest.mark.parametrize(
    ("texts", "fault", "cell"),
    [
        (NEW, BadFile(Path("treasures.yaml"), "", "", line=12, key="treasures[2].values.colour"), (2, 3)),
        (NEW, BadFile(Path("treasures.yaml"), "", "", line=12, key="treasures[2].values"), (2, 0)),
        (NEW, BadFile(Path("DialogueText"), "", "", line=3), None),
        (OLD, BadFile(Path("treasures"), "", "", line=3, key="Points"), (1, 2)),
        (OLD, BadFile(Path("treasures"), "", "", line=1), None),
    ],
)
def test_a_fault_has_its_cell(texts: Texts, fault: BadFile, cell: tuple[int, int] | None) -> None:
    assert sheet(texts).cell_of(fault) == cell
