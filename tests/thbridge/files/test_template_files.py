import math
import re
import shutil
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image

from thbridge.dialogue.moves import Scenario
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.language_texts import shipped_texts
from thbridge.files.map_times import map_times, read_map_times
from thbridge.files.template_files import read_dialogue_text, read_template_set
from thbridge.files.treasure_files import read_treasures
from thbridge.hunt.rooms import CORRIDOR, Room

TEMPLATES = Path(__file__).parents[3] / "templates"
ORIGINAL = TEMPLATES / "original-2016"


def wordings(template, scenario):
    return [question.wordings for question in template.of(scenario)]


def refusal(read, path):
    with pytest.raises(BadFile) as caught:
        read(path)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(str(path)), message
    return message


# --- the folders that come with the program


def test_the_plain_file_of_2016_reads_as_it_was_meant():
    template = read_dialogue_text(ORIGINAL / "DialogueText")
    assert template.name == "DontKnow:"
    assert wordings(template, Scenario.DONT_KNOW) == [
        ("Do you want me to go to room £room£",),
        ("It will cost me £cost£ to go to room £room£",),
        ("Are you sure?",),
    ]
    assert wordings(template, Scenario.SPECIFIC_ROOM) == [
        ("It will cost me £cost£ to go to room £room£",),
        ("Are you sure?",),
    ]
    assert wordings(template, Scenario.TAKE_PICTURE) == wordings(template, Scenario.TAKE_TREASURE) == []


def test_the_matrix_of_2016():
    costs = read_map_times(ORIGINAL / "mapTimes")
    assert len(costs.rooms) == 8
    assert (costs.cost(Room(1), Room(4)), costs.cost(Room(4), Room(1))) == (10.0, 18.0)
    assert math.isinf(costs.cost(Room(1), CORRIDOR))


def test_the_treasures_of_2016():
    treasures = read_template_set(ORIGINAL).kinds
    assert [(kind.name, kind.points, kind.image) for kind in treasures] == [
        ("Orange Bottle", 10, "rsz_t1.jpg"),
        ("Blue Bottle", 20, "rsz_t2.jpg"),
        ("Yellow can", 20, "rsz_t3.jpg"),
        ("Pink can", 30, "rsz_t4.jpg"),
    ]
    assert treasures[2].properties == {"colour": "Yellow", "footprint": "Square and Small"}


def test_the_participants_copy_tells_no_images():
    copy = read_treasures(ORIGINAL / "treasures.participant")
    assert [kind.name for kind in copy.kinds] == ["Orange Bottle", "Blue Bottle", "Yellow can", "Pink can"]
    assert {kind.image for kind in copy.kinds} == {None}


def test_the_published_set_asks_in_every_scenario_and_values_what_is_ambiguous():
    templates = read_template_set(TEMPLATES / "sklar-azhar-2015")
    assert all(templates.dialogue.of(scenario) for scenario in Scenario if scenario is not Scenario.UNSURE_NAME)
    assert any(len(question.wordings) > 1 for question in templates.dialogue.of(Scenario.DONT_KNOW))
    points = {kind.name: kind.points for kind in templates.kinds}
    assert points["basketball"] < points["fuzzy_die"] == points["beer_bottle"] < points["candy_box"]


@pytest.mark.parametrize("folder", ["original-2016", "sklar-azhar-2015"])
def test_every_picture_is_one(folder):
    templates = read_template_set(TEMPLATES / folder)
    for kind in templates.kinds:
        with Image.open(BytesIO(templates.pictures[kind.image])) as picture:
            assert picture.size == (320, 320)
            picture.load()


# --- what people's editors do


def test_windows_line_ends_a_byte_order_mark_and_blank_lines_do_no_harm(tmp_path):
    path = tmp_path / "DialogueText"
    plain = (ORIGINAL / "DialogueText").read_text(encoding="utf-8")
    path.write_bytes(("\ufeff" + plain + "\n\n").replace("\n", "\r\n").encode())
    assert read_dialogue_text(path) == read_dialogue_text(ORIGINAL / "DialogueText")


def test_blanks_after_commas_do_not_count(tmp_path):
    path = tmp_path / "treasures"
    path.write_text("8\nOrange, Round (very) and Large, 10, Orange Bottle, rsz_t1.jpg\n")
    (kind,) = read_treasures(path).kinds
    assert (kind.properties["footprint"], kind.points, kind.image) == ("Round (very) and Large", 10, "rsz_t1.jpg")


def test_a_file_saved_as_latin_1_is_told_how_to_be_saved(tmp_path):
    path = tmp_path / "DialogueText"
    path.write_bytes("DontKnow:\nGo?\nroom £room£\nSpecificRoom:\n".encode("latin-1"))
    message = refusal(read_dialogue_text, path)
    assert "line 3" in message and "UTF-8" in message and "iconv" in message


def test_a_file_saved_as_utf_16_is_told_so(tmp_path):
    path = tmp_path / "mapTimes"
    path.write_bytes("2\n99 1\n99 99\n".encode("utf-16"))
    assert "UTF-16" in refusal(read_map_times, path)


def test_sections_come_in_any_order_and_may_be_empty(tmp_path):
    path = tmp_path / "DialogueText"
    path.write_text(
        "Mine\nTakePicture:\nIt is £colour£?\nTakeTreasure:\nSpecificRoom:\nA | B £cost£\n", encoding="utf-8"
    )
    template = read_dialogue_text(path)
    assert template.of(Scenario.DONT_KNOW) == template.of(Scenario.TAKE_TREASURE) == ()
    assert wordings(template, Scenario.SPECIFIC_ROOM) == [("A", "B £cost£")]
    assert wordings(template, Scenario.TAKE_PICTURE) == [("It is £colour£?",)]


def test_a_bar_without_blanks_is_text(tmp_path):
    path = tmp_path / "DialogueText"
    path.write_text("Mine\nA|B\nSpecificRoom:\n", encoding="utf-8")
    assert wordings(read_dialogue_text(path), Scenario.DONT_KNOW) == [("A|B",)]


# --- every fault is named with its place and its remedy

DIALOGUES = [
    ("", ["empty", "DontKnow:"]),
    ("SpecificRoom:\nGo?\n", ["line 1", "name"]),
    ("Mine\nGo?\n", ["SpecificRoom:", "missing"]),
    ("Mine\nGo to £romo£?\nSpecificRoom:\n", ["line 2", "£romo£", "£room£"]),
    ("Mine\nSpecificRoom:\nGo?\n\nIt is £colour£\n", ["line 5", "£colour£", "TakePicture:"]),
    ("Mine\nSpecificRoom:\nSpecificRoom:\n", ["line 3", "twice"]),
    ("Mine\nSpecificRooms:\n", ["line 2", "Write SpecificRoom:"]),
    ("Mine\nspecificroom:\n", ["line 2", "Write SpecificRoom:"]),
    ("Mine\nSpecificRoom:\nTakeTresure:\n", ["line 3", "Write TakeTreasure:"]),
    ("Mine\nSpecificRoom:\nA | | B\n", ["line 3", "empty wording"]),
    ("Mine\nSpecificRoom:\nA |\n", ["line 3", "empty wording"]),
    ("Mine\nSpecificRoom:\n| A\n", ["line 3", "empty wording"]),
]
MAPS = [
    ("", ["empty"]),
    ("nine\n", ["line 1", "'nine'", "number of nodes"]),
    ("1\n0\n", ["line 1", "from 2"]),
    ("-3\n", ["line 1", "'-3'"]),
    ("2\n99 1\n", ["line 1", "2 rows", "the file has 1"]),
    ("2\n99 1\n99 99\n1 2\n", ["line 4", "2 rows", "the file has 3"]),
    ("2\n99 1\n99\n", ["line 3", "1 costs", "needs 2"]),
    ("2\n99 1 4\n99 99\n", ["line 2", "3 costs"]),
    ("2\n99 x\n99 99\n", ["line 2", "column 2", "'x'"]),
    ("2\n99 -1\n99 99\n", ["line 2", "column 2", "'-1'"]),
    ("2\n99 nan\n99 99\n", ["line 2", "column 2"]),
    ("2\n99 inf\n99 99\n", ["line 2", "column 2"]),
]
TREASURES = [
    ("", ["empty"]),
    ("eight\nR,R,1,x,x.jpg\n", ["line 1", "'eight'", "number of rooms"]),
    ("0\nR,R,1,x,x.jpg\n", ["line 1", "from 1"]),
    ("8\n", ["no treasure", "Colour,Footprint,Points,Name,ImageFile"]),
    ("8\nR,R,1\n", ["line 2", "3 fields"]),
    ("8\nR,R,1,x,x.jpg,y\n", ["line 2", "6 fields"]),
    ("8\nR,R,ten,x,x.jpg\n", ["line 2", "Points", "'ten'"]),
    ("8\nR,R,-1,x,x.jpg\n", ["line 2", "Points", "'-1'"]),
    ("8\nR,,1,x,x.jpg\n", ["line 2", "Footprint"]),
    ("8\nR,R,1,x,x.jpg\nR,R,1,X,y.jpg\n", ["line 3", "'X'", "twice"]),
    ("8\nR,R,1,x,x.jpg\nR,R,1,y\n", ["line 3", "ImageFile"]),
    ("8\nR,R,1,x,../x.jpg\n", ["line 2", "ImageFile", "../x.jpg"]),
    ("8\nR,R,1,x,my x.jpg\n", ["line 2", "ImageFile", "blanks"]),
]


@pytest.mark.parametrize(
    ("read", "text", "named"),
    [
        *((read_dialogue_text, *case) for case in DIALOGUES),
        *((read_map_times, *case) for case in MAPS),
        *((read_treasures, *case) for case in TREASURES),
    ],
)
def test_a_fault_is_named_with_its_place_and_its_remedy(tmp_path, read, text, named):
    path = tmp_path / "file"
    path.write_text(text, encoding="utf-8")
    message = refusal(read, path)
    assert all(word in message for word in named), message


def test_faults_of_several_sentences_are_told_together_and_none_follows_from_another(tmp_path):
    path = tmp_path / "file"
    path.write_text("Mine\nGo to £romo£?\nSpecificRooms:\nA |\nTakePicture:\nIt is £colour£\n", encoding="utf-8")
    with pytest.raises(BadFiles) as caught:
        read_dialogue_text(path)
    assert [fault.line for fault in caught.value.faults] == [2, 3, 4]


def test_faults_of_several_treasures_are_told_together(tmp_path):
    path = tmp_path / "file"
    path.write_text("8\nR,R,ten,x,x.jpg\nR,R,1,y,y.jpg\nR,R,1,Y,z.jpg\n", encoding="utf-8")
    with pytest.raises(BadFiles) as caught:
        read_treasures(path)
    assert [fault.line for fault in caught.value.faults] == [2, 4]


@pytest.mark.parametrize("read", [read_dialogue_text, read_map_times, read_treasures])
def test_a_file_that_is_not_there_or_is_no_file(tmp_path, read):
    assert "there is no such file" in refusal(read, tmp_path / "nothing")
    assert "cannot be read" in refusal(read, tmp_path)


# --- files that do not agree


@pytest.fixture
def folder(tmp_path):
    return Path(shutil.copytree(ORIGINAL, tmp_path / "set"))


def set_refusal(folder):
    with pytest.raises(BadFile) as caught:
        read_template_set(folder)
    return str(caught.value)


def test_rooms_must_be_the_same_in_all_files(folder):
    (folder / "treasures").write_text((ORIGINAL / "treasures").read_text().replace("8\n", "7\n", 1))
    message = set_refusal(folder)
    assert re.search(r"treasures, line 1.*7 rooms.*9 nodes", message), message


def test_treasures_that_no_property_tells_apart_are_warned_of(folder):
    assert read_template_set(folder).warnings == ()
    for name in ("treasures", "treasures.participant"):
        written = (folder / name).read_text()
        (folder / name).write_text(written.replace("Yellow,Square and Small", "Pink,Square and Small"))
    (warning,) = read_template_set(folder).warnings
    assert str(warning).startswith(f"{folder}/treasures: 'Yellow can' and 'Pink can' have the same properties")


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("yellow,Square and Small,30,Pink can,rsz_t4.jpg", "have the same properties, so only their pictures"),
        ("Yellow,Square and Small,30,Pink can,rsz_t3.jpg", "have the same properties, so nothing distinguishes them"),
        ("Pink,Square and Small,30,Pink can,rsz_t3.jpg", "have the same picture. Give one of them another"),
    ],
)
def test_treasures_that_people_mistake_are_warned_of(folder, line, told):
    (folder / "treasures.participant").unlink()
    written = (folder / "treasures").read_text()
    (folder / "treasures").write_text(written.replace("Pink,Square and Small,30,Pink can,rsz_t4.jpg", line))
    (warning,) = read_template_set(folder).warnings
    assert str(warning).startswith(f"{folder}/treasures: 'Yellow can' and 'Pink can' {told}")


def test_every_picture_must_be_there(folder):
    (folder / "pictures" / "rsz_t3.jpg").unlink()
    message = set_refusal(folder)
    assert "Yellow can" in message and "rsz_t3.jpg" in message


def test_a_picture_that_participants_would_wait_for_is_refused(folder):
    (folder / "pictures" / "rsz_t3.jpg").write_bytes(bytes(2_000_001))
    assert re.search(r"rsz_t3.jpg: the picture is larger than 2 MB", set_refusal(folder))


def test_the_participants_copy_is_not_taken_for_the_treasures(folder):
    shutil.copy(folder / "treasures.participant", folder / "treasures")
    assert "ImageFile" in set_refusal(folder)


def test_the_copy_must_say_the_same_and_no_images(folder):
    copy = folder / "treasures.participant"
    copy.write_text(copy.read_text().replace("Pink can", "Pink tin"))
    assert "differs from treasures" in set_refusal(folder)
    shutil.copy(folder / "treasures", copy)
    assert "names the images" in set_refusal(folder)
    copy.unlink()
    assert read_template_set(folder).kinds == read_template_set(ORIGINAL).kinds


def test_a_set_words_the_answers_to_its_questions_and_else_they_are_the_languages_own(folder):
    def answers(language="en"):
        dialogue, texts = read_template_set(folder).dialogue, shipped_texts(language)
        return [dialogue.answers_in(each, texts) for each in (Scenario.DONT_KNOW, Scenario.TAKE_PICTURE)]

    assert answers() == [("Continue", "Stop")] * 2
    (folder / "set.yaml").write_text("answers: {room: [Go, Not there]}\n")
    assert answers() == [("Go", "Not there"), ("Continue", "Stop")]
    assert answers("de") == [("Go", "Not there"), ("Weiter", "Stopp")]


def test_costs_may_be_left_to_the_maps(folder):
    (folder / "mapTimes").unlink()
    templates = read_template_set(folder)
    assert (templates.rooms, templates.costs, templates.map) == (8, None, "arena8")
    (folder / "set.yaml").unlink()
    assert read_template_set(folder).map is None


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("map: arena8\nmaps: arena8\n", r"set.yaml, line 2, maps: .*map"),
        ("mop: arena8\n", r"set.yaml, line 1, mop: .*map"),
        ("", r"set.yaml.*map"),
        (
            "answers: {room: [Go, go]}\n",
            r"set.yaml, line 1, answers.room: .*distinguish these answers.*\[Go, Not there\]",
        ),
        ("answers: {room: [Go, '']}\n", r"set.yaml, line 1, answers.room: .*distinguish these answers"),
        ("answers: {room: [Go]}\n", r"set.yaml, line 1, answers.room"),
    ],
)
def test_a_wrong_set_yaml_is_told_with_its_place_and_its_remedy(folder, text, named):
    (folder / "set.yaml").write_text(text)
    assert re.search(named, set_refusal(folder)), set_refusal(folder)


def test_a_folder_that_is_not_there(tmp_path):
    assert "template folder" in set_refusal(tmp_path / "nothing")


def test_measured_times_are_read_back_as_whole_seconds_and_none_becomes_the_word_for_no_move(tmp_path: Path) -> None:
    file = tmp_path / "mapTimes"
    file.write_text(map_times([[None, 12.4, 98.9], [None, None, 250.0], [None, 7.5, None]]))
    costs = read_map_times(file)
    assert costs.rows == ((math.inf, 12.0, 98.0), (math.inf, math.inf, 250.0), (math.inf, 8.0, math.inf))


def test_a_folder_without_a_list_of_treasures_is_told_both_names(tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(ORIGINAL, folder)
    (folder / "treasures").unlink()
    assert "it has neither a treasures.yaml nor a treasures" in refusal(read_template_set, folder)


def test_a_question_is_not_taken_for_the_name(tmp_path):
    text = tmp_path / "DialogueText"
    text.write_text("\nShall I go to room £room£?\nSpecificRoom:\nSure?\n", encoding="utf-8")
    assert "line 2, Shall I go" in refusal(read_dialogue_text, text)
    assert "the first line must be the template's name, not a question" in refusal(read_dialogue_text, text)


def test_a_picture_that_no_window_can_show_is_found_before_anybody_pays_for_it(tmp_path):
    folder = tmp_path / "set"
    shutil.copytree(ORIGINAL, folder)
    picture = folder / "pictures" / "rsz_t3.jpg"
    picture.write_bytes(b"\x00\x00\x00\x18ftypheic" + bytes(100))
    assert refusal(read_template_set, folder).startswith(f"{picture}: windows cannot show this picture.")
    Image.new("RGB", (4, 4)).save(picture, "webp")
    assert read_template_set(folder).pictures["rsz_t3.jpg"] == picture.read_bytes()
