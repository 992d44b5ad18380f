"""Briefing of participants: the study's data for their programs, in addition to the state of the game."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.notices import FloorPlan, GameTexts


@dataclass(frozen=True, slots=True)
class Briefing:
    """Map, names, pictures, texts and settings of a study for its participants.

    Attributes:
        floor_plan: floor plan of the game's map, or None if it is unknown.
        names: possible names of treasures. They are sent after a robot has sensed the first treasure.
        pictures: image files, by name. An image is sent after a robot has taken the picture.
        consent: text that participants must agree to first, or None if the study does not ask for consent.
        worth: points for each of `names`, or None if treasures with this name have different points. Empty if points
            are not shown.
        answers: True if the participant sees the treasures of all rooms after the game.
        farewell: thanks, and the next steps; may be empty.
        sound: True if the participant's window may play sounds.
        properties: properties of the treasures.
        words: the same properties with words in the game's language; empty if there are no words.
        called: words for the names in this language. Names without words are shown unchanged.
        kinds: all treasures without their pictures. Participants have the same list.
        condition: dialogue condition, which determines who decides.
        texts: texts of the game's language, or None if no program needs them.
    """

    floor_plan: FloorPlan | None = None
    names: tuple[str, ...] = ()
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    consent: str | None = None
    worth: tuple[int | None, ...] = ()
    answers: bool = False
    farewell: str = ""
    sound: bool = True
    properties: tuple[TreasureProperty, ...] = OF_2016
    words: tuple[TreasureProperty, ...] = ()
    called: Mapping[str, str] = field(default_factory=dict)
    kinds: tuple[TreasureKind, ...] = ()
    condition: DialogueCondition = DialogueCondition.SCRIPT
    texts: GameTexts | None = None

    def names_of_rooms(self, map_name: str | None) -> tuple[str, ...]:
        """Return the names of the rooms on the floor plan, in order; empty if the robots use another map."""
        plan = self.floor_plan
        return () if plan is None or map_name not in {None, plan.map} else tuple(room.name for room in plan.rooms)

    @property
    def room_names(self) -> RoomNames:
        """Names of the map's rooms; empty if there is no map."""
        return RoomNames() if self.floor_plan is None else self.floor_plan.room_names
