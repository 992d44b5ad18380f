"""Properties of treasures: how they are said, sensed for energy, and told by people."""

from dataclasses import replace

import pytest
from msgspec import structs

from tests.support.hunts.game_states import ARENA, ROOM_1, ROOM_4, after, visit
from thbridge.hunt import rules
from thbridge.hunt.codec import TAKEN, from_json, to_json
from thbridge.hunt.events import GameStarted, PropertyMeasured, PropertyTold, TreasureSensed, TreasuresHidden
from thbridge.hunt.game import apply, begin
from thbridge.hunt.properties import OF_2016, Teller, TreasureProperty, properties_in_words, value_in_words
from thbridge.hunt.rules import RuleReason
from thbridge.hunt.treasures import TreasureKind

SIZE = TreasureProperty("size", "Size", ("small", "large"))
WEIGHT = TreasureProperty("weight", "Weight", ("light", "heavy"), cost=2.0, sensor="scale", said="weighing £weight£")
MATERIAL = TreasureProperty("material", "Material", ("wood", "metal"), Teller.PERSON)
BRICK = TreasureKind({"size": "small", "weight": "heavy", "material": "metal"}, 10, "brick", "brick.jpg")


def found(energy=100.0):
    """Robot 0 stands in room 4, where it has found a treasure."""
    started = GameStarted(7, 1, 2, energy, 5.0, 2.0, 1.0, ARENA, (SIZE, WEIGHT, MATERIAL))
    state = visit(apply(begin(started), TreasuresHidden((BRICK,) * 8)), 0, ROOM_4)
    return after(state, rules.sense(state, ROOM_4))


def test_what_costs_nothing_is_sensed_with_the_find_and_nothing_else():
    assert found().room(ROOM_4).known == {"size": "small"}


def test_a_property_is_sensed_once_for_its_energy():
    state = found()
    ruling = rules.measure(state, ROOM_4, "weight")
    assert ruling == (PropertyMeasured(ROOM_4, 0, "weight", "heavy", 2.0),)
    then = after(state, ruling)
    assert then.robots[0].energy == state.robots[0].energy - 2.0
    assert then.room(ROOM_4).known == {"size": "small", "weight": "heavy"}
    assert rules.measure(then, ROOM_4, "weight") == ()


@pytest.mark.parametrize("name", ["size", "material", "colour", ""])
def test_nothing_else_is_sensed_on_request(name):
    assert rules.measure(found(), ROOM_4, name).reason == RuleReason.UNKNOWN_PROPERTY


def test_sensing_needs_the_energy_a_robot_and_an_open_find():
    assert rules.measure(found(energy=14.0), ROOM_4, "weight").reason == RuleReason.NOT_ENOUGH_ENERGY
    state = found()
    assert rules.measure(state, ROOM_1, "weight").reason == RuleReason.NOBODY_THERE
    left = after(state, rules.leave(state, ROOM_4))
    assert rules.measure(left, ROOM_4, "weight").reason == RuleReason.ALREADY_DECIDED


def test_people_tell_by_the_picture_and_may_change_their_mind():
    state = found()
    assert rules.tell(state, ROOM_4, "material", "wood").reason == RuleReason.NOTHING_KNOWN
    state = after(state, rules.picture(state, ROOM_4))
    energy = state.robots[0].energy
    state = after(state, rules.tell(state, ROOM_4, "material", "wood"))
    assert rules.tell(state, ROOM_4, "material", "wood") == ()
    assert rules.tell(state, ROOM_4, "material", "metal") == (PropertyTold(ROOM_4, "material", "metal"),)
    assert state.room(ROOM_4).known["material"] == "wood"
    assert state.robots[0].energy == energy
    for name, value in (("material", "paper"), ("weight", "heavy"), ("colour", "red")):
        assert rules.tell(state, ROOM_4, name, value).reason == RuleReason.UNKNOWN_PROPERTY


def test_a_game_of_the_properties_of_2016_is_written_as_ever():
    started = GameStarted(7, 1, 2, 100.0, 5.0, 2.0, 1.0, ARENA)
    assert "properties" not in to_json(started)
    declared = structs.replace(started, properties=(SIZE, WEIGHT, MATERIAL))
    assert from_json(to_json(declared)).properties == (SIZE, WEIGHT, MATERIAL)


def test_properties_are_fields_beside_the_others():
    assert to_json(TreasureSensed(ROOM_4, {"size": "small"})) == '{"v":1,"event":"sensed","room":4,"size":"small"}'
    assert {"room", "cost", "robot", "name", "image", "event"} <= TAKEN


@pytest.mark.parametrize(
    ("value", "said"),
    [("Round and Large", "round and large"), ("USB", "USB"), ("20 °C", "20 °C"), ("Grün", "grün"), ("", "")],
)
def test_plain_words_lose_their_capitals_within_a_sentence(value, said):
    assert value_in_words(value) == said


def test_a_treasure_is_said_by_what_is_known_of_it():
    known = {"weight": "Heavy", "size": "small"}
    assert properties_in_words((SIZE, WEIGHT, MATERIAL), known) == "something small, weighing heavy"
    assert properties_in_words((SIZE, WEIGHT, MATERIAL), {}) == "something"
    of_2016 = {"colour": "Orange", "footprint": "Round and Large"}
    assert properties_in_words(OF_2016, of_2016) == "something orange, round and large"


def test_what_a_set_does_not_know_of_a_treasure_is_not_sensed():
    started = GameStarted(7, 1, 2, 100.0, 5.0, 2.0, 1.0, ARENA, (SIZE, WEIGHT))
    bare = replace(BRICK, properties={})
    state = visit(apply(begin(started), TreasuresHidden((bare,) * 8)), 0, ROOM_4)
    state = after(state, rules.sense(state, ROOM_4))
    assert state.room(ROOM_4).sensed == {}
    assert rules.measure(state, ROOM_4, "weight").reason == RuleReason.NOTHING_KNOWN
