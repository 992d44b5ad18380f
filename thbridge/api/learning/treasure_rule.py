"""Rule that decides about treasures, so that agents only choose rooms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from thbridge.hunt.game import GameState
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.shared.robot_requests import StationIdentify, StationLeave, StationTakePicture

TreasureRequest: TypeAlias = StationIdentify | StationLeave | StationTakePicture


@dataclass(frozen=True, slots=True)
class TreasureRule:
    """Rule that names a treasure if only one name fits. First, a picture is taken if the energy is enough.

    If the rule cannot name a treasure, the treasure is left undecided. Simulated participants use the same rule.

    Attributes:
        kinds: all possible treasures.
        shown_by: name of the treasure shown in a picture, by the picture's file name.
    """

    kinds: tuple[TreasureKind, ...]
    shown_by: Mapping[str, str]

    @classmethod
    def of(cls, kinds: Sequence[TreasureKind]) -> "TreasureRule":
        """Return the rule for these treasures and their pictures."""
        return cls(tuple(kinds), {kind.image: kind.name for kind in kinds if kind.image is not None})

    def request(self, game: GameState, robot: int) -> TreasureRequest | None:
        """Return the next request about the treasure in a robot's room; None if there is none.

        `robot` is an index.
        """
        state = game.robots[robot]
        if state.bound_for is not None or state.at.is_corridor or state.is_blocked or state.is_silent:
            return None
        room = game.room(state.at)
        if room.sensed is None or room.is_decided or game.standing_in(state.at) != robot:
            return None
        known = room.known.items()
        names = {kind.name for kind in self.kinds if known <= kind.properties.items()}
        name = next(iter(names)) if len(names) == 1 else None
        if room.image is not None:
            name = self.shown_by.get(room.image)
        started = game.started
        if name is not None and state.energy >= started.identify_cost:
            return StationIdentify(robot, name)
        if name is None and room.image is None and state.energy >= started.picture_cost + started.identify_cost:
            return StationTakePicture(robot)
        return StationLeave(robot)
