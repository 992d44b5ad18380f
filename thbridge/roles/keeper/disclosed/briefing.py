"""Briefing of participants: all that their programs get from the study in addition to the state of the game."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.notices import FloorPlan, GameTexts


@dataclass(frozen=True, slots=True)
class Briefing:
    """Map, names, pictures and consent text of a study, for its participants.

    Attributes:
        floor_plan: floor plan of the game's map; None if it is unknown.
        names: possible names of treasures; sent once the first treasure was sensed.
        pictures: image files by name; each image is sent once the picture was taken.
        consent: text to which participants have to agree first; None if they are not asked.
        worth: points of each of `names`, None if treasures of this name differ; empty if points are not shown.
        answers: True when the treasures of the rooms are shown after the game.
        farewell: thanks, and the next steps; may be empty.
        sound: True when the participant's window may play sounds.
        properties: properties of the treasures.
        words: the same properties with their words in the game's language; empty if they have none.
        called: words for the names, in this language; a name without words is used as it is.
        kinds: all treasures, without their pictures; participants have the same list.
        condition: condition of dialogues: how robots and participants decide together.
        texts: texts of the game's language; None if no program reads them.
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

    @property
    def room_names(self) -> RoomNames:
        """Names of the map's rooms; empty if there is no map."""
        return RoomNames() if self.floor_plan is None else self.floor_plan.room_names
