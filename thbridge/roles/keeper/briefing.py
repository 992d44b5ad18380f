"""Briefing of participants: what their programs get from the study beside the state of the game."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.roles.notices import FloorPlan


@dataclass(frozen=True, slots=True)
class Briefing:
    """Map, names, pictures and consent text that a study has for its participants.

    Attributes:
        floor_plan: of the game's map; None where it is unknown.
        names: possible names of treasures; sent once one was sensed.
        pictures: image files by name; each is sent once it was taken.
        consent: text that participants have to agree to before anything else; None asks nothing.
    """

    floor_plan: FloorPlan | None = None
    names: tuple[str, ...] = ()
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    consent: str | None = None
