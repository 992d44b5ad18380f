"""Names and hashes of message, service and action types: what endpoints declare about their type."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MessageSupport:
    """Message type of an endpoint.

    Attributes:
        name: for example "nav_msgs/msg/Odometry", "nav_msgs/srv/GetMap_Request".
        hash: for example "RIHS01_3cc9...".
    """

    name: str
    hash: str

    @property
    def dds_name(self) -> str:
        """Name on the wire, for example "nav_msgs::msg::dds_::Odometry_"."""
        package, kind, name = self.name.split("/")
        return f"{package}::{kind}::dds_::{name}_"


@dataclass(frozen=True, slots=True)
class ServiceSupport:
    """Service type.

    Attributes:
        name: for example "nav_msgs/srv/GetMap".
        hash: hash of the whole service, with request, response and event.
        request: type of requests.
        response: type of responses.
    """

    name: str
    hash: str
    request: MessageSupport
    response: MessageSupport

    @property
    def dds_name(self) -> str:
        """Name on the wire of zenoh, for example "nav_msgs::srv::dds_::GetMap_"."""
        package, kind, name = self.name.split("/")
        return f"{package}::{kind}::dds_::{name}_"


@dataclass(frozen=True, slots=True)
class ActionSupport:
    """Action type.

    Attributes:
        name: for example "nav2_msgs/action/NavigateToPose".
        hash: hash of the whole action.
        send_goal: service `NAME/_action/send_goal`.
        get_result: service `NAME/_action/get_result`.
        cancel_goal: service `NAME/_action/cancel_goal`, the same for all actions.
        feedback: message on `NAME/_action/feedback`.
        status: message on `NAME/_action/status`, the same for all actions.
    """

    name: str
    hash: str
    send_goal: ServiceSupport
    get_result: ServiceSupport
    cancel_goal: ServiceSupport
    feedback: MessageSupport
    status: MessageSupport
