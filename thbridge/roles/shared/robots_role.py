"""Additional interface of the robots' role to a session: it takes requests and returns the state of the team."""

from typing import TYPE_CHECKING, Protocol, runtime_checkable

from thbridge.roles.shared.robot_requests import RobotRequest
from thbridge.roles.shared.role import Role

if TYPE_CHECKING:
    from sim.team import TeamSnapshot


@runtime_checkable
class RobotsRole(Role, Protocol):
    """The role of a team of robots, simulated or real."""

    @property
    def snapshot(self) -> "TeamSnapshot | None":
        """The team after the last step; None before the first."""

    def ask(self, request: RobotRequest, researcher: str | None = None) -> None:
        """Queue a request for the next step, before the messages of that step; a move of the game resumes afterwards.

        Args:
            request: the request.
            researcher: name of the researcher who intervenes with it, and so commands the robot; None if none does.
        """
