"""What participants' programs are given beside the state of the game: the study's part."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.roles.notices import House


@dataclass(frozen=True, slots=True)
class Briefing:
    """What a study shows its participants, and asks of them.

    Attributes:
        house: where the game takes place; None where nobody knows.
        names: that treasures may have; told once one was sensed.
        pictures: image files by name; each is told once it was taken.
        consent: what participants have to agree to before anything else; None asks nothing.
    """

    floor_plan: House | None = None
    names: tuple[str, ...] = ()
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    consent: str | None = None
