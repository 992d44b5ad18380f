"""Time offset of real robots' odometry, as a parameter of the fleet's node on a ROS 2 graph."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import cast

from thbridge.ros.reconfigure import DescribedParameter
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.parameters import (
    MAX_CHANGES,
    GivenParameter,
    NodeParameter,
    ParameterKind,
    ParameterNode,
    Value,
    fixed,
    refusal_of,
)
from thbridge.ros2graph.sockets.carrier import GraphCarrier
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.graph import NodeName

_log = logging.getLogger(__name__)


class Nav2FleetParameters:
    """Current time offset. Nodes of the graph can read and change it. It implements `ParameterOwner`.

    Args:
        carrier: connection to the graph.
        distribution: message types of the graph.
        named: node of the fleet.
        offset: declaration of the parameter. Its default is the value at the start.
        apply: called with each new value, seconds.
        now: returns the ROS time in nanoseconds, or None while it is unknown.
        is_time_simulated: value of the parameter use_sim_time.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        distribution: Distribution,
        named: NodeName,
        offset: DescribedParameter,
        apply: Callable[[float], None],
        now: Callable[[], int | None],
        *,
        is_time_simulated: bool,
    ) -> None:
        self._offset = offset
        self._key = f"{named.whole}/{offset.name}"
        self._apply = apply
        self._now = now
        self._seconds = cast(float, offset.default)
        least, most = cast(float, offset.minimum), cast(float, offset.maximum)
        declared = NodeParameter(
            offset.name, ParameterKind.DOUBLE, offset.description, path=offset.path, minimum=least, maximum=most
        )
        time = fixed("use_sim_time", is_time_simulated, "use the time of the topic /clock")
        self._node = ParameterNode(named.namespace, named.name, None, {each.name: each for each in (declared, time)})
        services = NodeServices(carrier, distribution)
        services.describe_types(named)
        self._events = services.offer(self._node, self)

    def announce(self) -> None:
        """Publish all parameters as new."""
        self._events.announce(self._now() or 0, self.present(self._node))

    def present(self, node: ParameterNode) -> Mapping[str, Value]:
        """Return the values of the parameters that may change, by name."""
        return {self._offset.name: self._seconds}

    def set(self, node: ParameterNode, given: Sequence[GivenParameter], together: bool) -> Sequence[str]:
        """Set parameters; see `ParameterOwner`. The last valid value in a request applies."""
        refusals = [refusal_of(node, each) for each in given]
        if len(given) > MAX_CHANGES:
            refusals = [f"a request sets at most {MAX_CHANGES} parameters"] * len(given)
        if together:
            refusals = [next(filter(None, refusals), "")] * len(given)
        valid = [cast(float, each.value) for each, refusal in zip(given, refusals, strict=True) if not refusal]
        if valid:
            self._change(valid[-1])
        return refusals[:1] or [""] if together else refusals

    def _change(self, seconds: float) -> None:
        if seconds != self._seconds:
            self._seconds = seconds
            self._apply(seconds)
            self._events.changed(self._now() or 0, [(self._offset.name, seconds)])
            _log.warning("%s is %g s now", self._key, seconds)
