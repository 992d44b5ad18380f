"""Additional interface of the robots' role for a session: requests to robots, and the state of the team."""

from typing import TYPE_CHECKING, Protocol, runtime_checkable

from thbridge.roles.shared.robot_requests import RobotRequest
from thbridge.roles.shared.role import Role

if TYPE_CHECKING:
    from sim.snapshot import TeamSnapshot


@runtime_checkable
class RobotsRole(Role, Protocol):
    """Role of a team of simulated or real robots."""

    @property
    def snapshot(self) -> "TeamSnapshot | None":
        """The team after the last step, or None before the first step."""

    def ask(self, request: RobotRequest, researcher: str | None = None) -> None:
        """Queue a request for the next step, before the messages of that step. A move of the game resumes afterwards.

        Args:
            request: the request.
            researcher: name of the researcher who intervenes and thereby commands the robot, or None.
        """
