"""Briefing of participants: what their programs get from the study beside the state of the game."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.properties import OF_2016, TreasureProperty
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.notices import FloorPlan, GameTexts


@dataclass(frozen=True, slots=True)
class Briefing:
    """Map, names, pictures and consent text that a study has for its participants.

    Attributes:
        floor_plan: of the game's map; None where it is unknown.
        names: possible names of treasures; sent once one was sensed.
        pictures: image files by name; each is sent once it was taken.
        consent: text that participants have to agree to before anything else; None asks nothing.
        worth: points of each of `names`, None where treasures of this name differ; empty: they are not told.
        answers: True when it is told after the game what was in the rooms.
        farewell: thanks, and what comes next; may be empty.
        sound: True when their window may sound.
        properties: of the treasures.
        words: the same properties with their words in the game's language; empty: these have none.
        called: words for the names, in this language; a name without some is said as it is.
        kinds: treasures that there are, without their pictures; participants have the same list.
        condition: how robots and participants decide together.
        texts: of the game's language; None where nobody reads them.
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
        """Names of the map's rooms; none without a map."""
        return RoomNames() if self.floor_plan is None else self.floor_plan.room_names
