"""Parts of a session that are the same on ROS 1 and ROS 2 graphs, apart from the messages of clients."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.common.grid import OccupancyGrid
from sim.team import Team
from thbridge.ros.messages import pack, unpack
from thbridge.ros.names import MAP_FRAME
from thbridge.ros.parameters import Tree
from thbridge.ros.topics import OF_ERRORS, Topic
from thbridge.study.external_nodes import ExternalNodes

OF_AMCL = frozenset({"amcl_pose", "particlecloud", "initialpose", *OF_ERRORS})
"""Last parts of the names of topics that amcl publishes or reads, and of topics with errors of our localizer."""


@dataclass(frozen=True, slots=True, eq=False)
class TeamDescription:
    """Description of a team for a ROS graph.

    Attributes:
        topics: topics to advertise.
        grid: the map.
        rest: parameters of the study, without the parameters of robots.
        body: corners of a robot's body in the robot's base frame, meters.
        external: nodes that other programs run for these robots.
    """

    topics: Sequence[Topic]
    grid: OccupancyGrid
    rest: Tree
    body: Sequence[Sequence[float]]
    external: ExternalNodes = ExternalNodes.NONE


class BegunRecoveries:
    """Recovery behaviors that robots have begun since the last call of `take`."""

    def __init__(self, team: Team) -> None:
        self._team = team
        self._tried = [progress.tried for progress in team.recoveries]

    def take(self) -> list[range]:
        """Return the numbers of these behaviors for each robot."""
        before, self._tried = self._tried, [progress.tried for progress in self._team.recoveries]
        # If a robot began the list again within the tick, all behaviors tried since then are new.
        return [range(was if now >= was else 0, now) for was, now in zip(before, self._tried, strict=True)]


def without_corrections(data: bytes) -> bytes:
    """Return a message of transforms without those of the map, which an external amcl publishes."""
    pieces = unpack.transform_pieces(data)
    return pack.stamped_transforms([piece for parent, _, piece in pieces if parent != MAP_FRAME])
