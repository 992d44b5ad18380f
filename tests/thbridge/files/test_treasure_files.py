"""Lists of treasures that declare properties of their own."""

from pathlib import Path

import pytest

from thbridge.files.errors import BadFile
from thbridge.files.template_files import read_template_set
from thbridge.files.treasure_files import read_treasures_yaml
from thbridge.hunt.properties import PropertyDrawing, Teller

SHIPPED = Path(__file__).parents[3] / "templates" / "four-properties"
GOOD = """
properties:
  - {name: colour, drawn: colour}
  - {name: weight, values: [light, heavy], cost: 2, sensor: scale}
  - {name: material, values: [wood, metal], told_by: person}
treasures:
  - {name: block, points: 5, image: block.jpg, values: {colour: red, weight: light, material: wood}}
  - {name: tin, image: tin.jpg, values: {colour: red, weight: heavy, material: metal}}
"""


def test_the_shipped_set_has_four_properties_one_told_by_people_and_one_for_energy():
    templates = read_template_set(SHIPPED)
    assert len(templates.properties) == 4
    assert [each.name for each in templates.properties if each.told_by is Teller.PERSON] == ["material"]
    assert [(each.name, each.cost) for each in templates.properties if each.is_measured] == [("weight", 2.0)]
    looks = [tuple(kind.properties.values()) for kind in templates.kinds]
    assert len({look[:2] for look in looks}) == 4, "colour and size leave two each"
    assert len({look[:3] for look in looks}) == len(looks), "and the weight tells these apart"


def test_a_declaration_is_read_with_its_defaults(tmp_path):
    path = tmp_path / "treasures.yaml"
    path.write_text(GOOD)
    treasures = read_treasures_yaml(path)
    colour, weight, _ = treasures.properties
    assert (colour.label, colour.drawn, colour.values) == ("Colour", PropertyDrawing.COLOUR, ())
    assert (weight.label, weight.sensor, weight.is_found) == ("Weight", "scale", False)
    assert [(kind.name, kind.points, kind.image) for kind in treasures.kinds] == [
        ("block", 5, "block.jpg"),
        ("tin", 0, "tin.jpg"),
    ]
    assert treasures.kinds[1].properties == {"colour": "red", "weight": "heavy", "material": "metal"}


FAULTS = [
    ("name: weight,", "name: Weight,", ["properties[1].name", "small letters"]),
    ("name: weight,", "name: cost,", ["properties[1].name", "cost"]),
    ("name: weight,", "name: other_robot,", ["properties[1].name", "other_robot"]),
    ("name: weight,", "name: colour,", ["properties[1].name", "twice"]),
    ("sensor: scale", "sensor: scale, said: heavy", ["properties[1].said", "£weight£"]),
    ("told_by: person", "told_by: person, cost: 3", ["properties[2].cost", "no cost", "Delete this key"]),
    ("values: [wood, metal], told_by", "told_by", ["properties[2].values", "at least two"]),
    ("told_by: person", "told_by: cat", ["properties[2].told_by", "robot or person"]),
    ("drawn: colour", "drawn: sphere", ["properties[0].drawn", "shape"]),
    ("cost: 2", "cost: -2", ["properties[1].cost", "out of range"]),
    ("weight: light", "weight: lihgt", ["treasures[0].values.weight", "light, heavy"]),
    ("colour: red, weight: light", "weight: light", ["treasures[0].values", "block has no colour"]),
    ("weight: light", "weigth: light", ["no property has the name 'weigth'", "line 7"]),
    ("colour: red, weight: heavy", "colour: 'red (dark)', weight: heavy", ["treasures[1].values.colour", "brackets"]),
    ("name: tin", "name: Block", ["treasures[1].name", "twice"]),
    ("image: tin.jpg", "image: ../tin.jpg", ["treasures[1].image", "plain file name"]),
    ("points: 5", "points: -5", ["treasures[0].points", "out of range"]),
]


@pytest.mark.parametrize(("good", "bad", "named"), FAULTS)
def test_a_fault_is_named_with_its_place_and_its_remedy(tmp_path, good, bad, named):
    path = tmp_path / "treasures.yaml"
    assert good in GOOD
    path.write_text(GOOD.replace(good, bad, 1), encoding="utf-8")
    with pytest.raises(BadFile) as caught:
        read_treasures_yaml(path)
    message = str(caught.value)
    assert all(word in message for word in named), message


def test_all_faults_of_a_folder_come_at_once(tmp_path):
    (tmp_path / "treasures.yaml").write_text(GOOD)
    (tmp_path / "DialogueText").write_text("Mine\nSpecificRoom:\nIt is £weight£\n", encoding="utf-8")
    (tmp_path / "mapTimes").write_text("3\n1 2\n")
    with pytest.raises(BadFile) as caught:
        read_template_set(tmp_path)
    message = str(caught.value)
    assert all(word in message for word in ("mapTimes", "DialogueText, line 3", "block.jpg", "tin.jpg")), message


def test_two_lists_in_one_folder_are_refused(tmp_path):
    for name in ("treasures.yaml", "DialogueText"):
        (tmp_path / name).write_bytes((SHIPPED / name).read_bytes())
    (tmp_path / "pictures").symlink_to(SHIPPED / "pictures")
    (tmp_path / "treasures").write_text("8\n")
    with pytest.raises(BadFile, match=r"a treasures\.yaml also exists"):
        read_template_set(tmp_path)
