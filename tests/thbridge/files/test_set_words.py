"""Words of template sets in further languages."""

import shutil
from pathlib import Path

import pytest

from thbridge.dialogue.moves import Scenario
from thbridge.files.errors import BadFile
from thbridge.files.resources import shipped
from thbridge.files.template_files import missing_words, read_template_set

TRANSLATED = sorted(set(shipped().names("templates")) - {"original-2016"})


def folder_of(name: str) -> Path:
    return shipped().find("templates", name, Path())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the set with four properties."""
    return Path(shutil.copytree(folder_of("four-properties"), tmp_path / "set"))


@pytest.mark.parametrize("name", TRANSLATED)
def test_shipped_sets_lack_nothing_in_german(name: str) -> None:
    assert list(missing_words(read_template_set(folder_of(name)), folder_of(name), "de")) == []


def test_a_set_is_read_in_the_language_of_the_study(folder: Path) -> None:
    templates = read_template_set(folder)
    german, english = templates.in_language("de"), templates.in_language("en")
    assert (german.names["barrel"], english.names) == ("Fass", {})
    material = german.properties[3]
    assert (material.label, material.phrase("wood"), german.properties[0].sensor) == ("Material", "aus Holz", "Kamera")
    assert english.properties == templates.properties
    assert "Waren" in german.dialogue.name and english.dialogue == templates.dialogue


def test_what_the_set_of_2016_lacks_is_told_with_the_files_to_write() -> None:
    folder = folder_of("original-2016")
    told = [str(fault) for fault in missing_words(read_template_set(folder), folder, "de")]
    assert [line.split(":")[0] for line in told] == [
        f"{folder}/de/words.yaml, treasures",
        f"{folder}/de/words.yaml, values of colour",
        f"{folder}/de/words.yaml, values of footprint",
        f"{folder}/de/DialogueText",
    ]
    assert "Orange Bottle, Blue Bottle, Yellow can, Pink can" in told[0]
    assert list(missing_words(read_template_set(folder), folder, "en")) == []


def test_single_words_that_are_missing_are_told(folder: Path) -> None:
    words = folder / "de" / "words.yaml"
    words.write_text(words.read_text().replace("  barrel: Fass\n", "").replace(", metal: Metall", ""))
    told = [str(fault) for fault in missing_words(read_template_set(folder), folder, "de")]
    assert ["barrel. Write" in told[0], "metal. Write" in told[1]] == [True, True] and len(told) == 2


def test_a_set_that_names_no_language_is_in_that_of_the_study(folder: Path) -> None:
    (folder / "set.yaml").unlink()
    shutil.rmtree(folder / "de")
    templates = read_template_set(folder)
    assert list(missing_words(templates, folder, "de")) == []
    assert templates.in_language("de").dialogue == templates.dialogue


def test_answers_that_a_language_lacks_are_those_of_the_language_and_not_of_the_set(folder: Path) -> None:
    (folder / "set.yaml").write_text("language: en\nanswers: {room: [Go, Not there]}\n")
    words = folder / "de" / "words.yaml"
    words.write_text(words.read_text().partition("\nanswers:")[0] + "\n")
    assert read_template_set(folder).in_language("de").dialogue.answers == {}
    words.write_text(words.read_text() + "answers: {picture: [Ja, Nein]}\n")
    assert read_template_set(folder).in_language("de").dialogue.answers == {Scenario.TAKE_PICTURE: ("Ja", "Nein")}


@pytest.mark.parametrize(
    ("written", "told"),
    [
        (
            "treasures: {barel: Fass}",
            "line 1, treasures.barel: no treasure has the name 'barel'. The nearest name is barrel",
        ),
        ("treasures: {barrel: ' '}", "line 1, treasures.barrel: the name is empty"),
        ("properties: [{name: color}]", "[0].name: no property has the name 'color'. The nearest name is colour"),
        ("properties: [{name: size}, {name: size}]", "properties[1].name: 'size' has two entries"),
        (
            "properties:\n- {name: size, values: {smal: klein}}",
            "line 2, properties[0].values.smal: 'smal' is not a value",
        ),
        ("properties: [{name: size, said: groß}]", "[0].said: this text does not contain the value. Write £size£"),
        ("answers: {room: [Ja, ja]}", "answers.room: people cannot distinguish these answers"),
        ("treasure: {barrel: Fass}", "treasure: unknown key. The nearest name is treasures"),
    ],
)
def test_a_fault_is_told_with_its_place_and_remedy(folder: Path, written: str, told: str) -> None:
    (folder / "de" / "words.yaml").write_text(f"{written}\n")
    with pytest.raises(BadFile) as raised:
        read_template_set(folder)
    assert str(raised.value).startswith(f"{folder}/de/words.yaml, ") and told in str(raised.value)


def test_questions_in_a_language_are_checked_as_those_of_the_set(folder: Path) -> None:
    questions = folder / "de" / "DialogueText"
    questions.write_text(questions.read_text().replace("£reason£", "£raeson£"))
    with pytest.raises(BadFile, match=r"de/DialogueText, line 2: unknown reserved word £raeson£. Write £reason£"):
        read_template_set(folder)
