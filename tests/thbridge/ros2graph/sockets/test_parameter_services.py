"""Services of the parameters of a node: bytes of a client in, bytes out, and events."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.parameters import RobotParameters
from tests.support.ros2.loopback import LoopbackGraph
from thbridge.ros2 import parameter_messages as messages
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_parameters import robot_nodes
from thbridge.ros2.parameters import GivenParameter, ParameterKind, ParameterNode, Value, kind_of
from thbridge.ros2.qos import DEFAULT
from thbridge.ros2.type_descriptions import SERVICE_TYPE
from thbridge.ros2graph.sockets.parameter_services import EVENTS, MAX_WAITING, NodeServices, ParameterEvents
from thbridge.ros2graph.values.graph import NodeName

TYPES = Distribution.of("kilted")
SOFTWARE = RobotParameters()
NODE = next(node for node in robot_nodes(0, SOFTWARE, 0.05) if node.name == "amcl")
NAME = NodeName("/robot1", "amcl")
CLIENT = NodeName("/", "client")


class Owner:
    """Holder of parameters that refuses negative numbers."""

    def __init__(self) -> None:
        self.given: list[tuple[Sequence[GivenParameter], bool]] = []

    def present(self, node: ParameterNode) -> Mapping[str, Value]:
        return node.reported(SOFTWARE)

    def set(self, node: ParameterNode, given: Sequence[GivenParameter], together: bool) -> Sequence[str]:
        self.given.append((given, together))
        refusals = ["too small" if each.value == -1.0 else "" for each in given]
        return [next(filter(None, refusals), "")] if together else refusals


class Offered:
    """A node on a graph, and a client of its services."""

    def __init__(self) -> None:
        self.owner = Owner()
        self.graph = LoopbackGraph()
        self.program, self.other = self.graph.program(), self.graph.program()
        services = NodeServices(self.program, TYPES, self.graph.pending.append)
        services.describe_types(NAME)
        self.events: ParameterEvents = services.offer(NODE, self.owner)
        self.heard: list[Any] = []

    def listen(self) -> None:
        self.other.subscribe(CLIENT, EVENTS, TYPES.message(messages.EVENT), DEFAULT, self._hear)

    def _hear(self, message: bytes, gid: bytes) -> None:
        self.heard.append(TYPES.decode(messages.EVENT, message))

    def answer(self, service: str, request: bytes) -> bytes | None:
        """Return the response to a request, or None if there is none."""
        responses: list[bytes] = []
        client = self.other.client(
            CLIENT, f"/robot1/amcl/{service}", TYPES.service(messages.SERVICE_TYPES[messages.GET])
        )
        client.call(request, responses.append)
        self.graph.deliver()
        return responses[0] if responses else None

    def ask(self, service: str, **fields: object) -> Any:
        type_ = messages.SERVICE_TYPES.get(service, SERVICE_TYPE)
        request = f"{type_}_Request"
        response = self.answer(service, TYPES.encode(request, TYPES.make(request, **fields)))
        assert response is not None
        return TYPES.decode(f"{type_}_Response", response)


@pytest.fixture
def offered() -> Iterator[Offered]:
    yield Offered()


def parameter(name: str, value: Value) -> object:
    content = messages.parameter_value(TYPES, kind_of(value), value)
    return TYPES.make("rcl_interfaces/msg/Parameter", name=name, value=content)


def test_parameters_are_listed_in_the_order_of_their_names(offered: Offered) -> None:
    assert offered.ask(messages.LIST).result.names == sorted(NODE.parameters)
    below = offered.ask(messages.LIST, prefixes=["initial_pose"], depth=1).result
    assert (below.names, below.prefixes) == (["initial_pose.x", "initial_pose.y", "initial_pose.yaw"], ["initial_pose"])


def test_descriptors_have_meaning_bounds_and_choices(offered: Offered) -> None:
    names = ["pf_err", "max_beams", "laser_model_type", "initial_pose.x", "laser_min_range"]
    error, beams, model, fixed, open_ = offered.ask(messages.DESCRIBE, names=names).descriptors
    assert (error.name, error.type, error.read_only, error.dynamic_typing) == ("pf_err", 3, False, False)
    assert error.description.endswith("(amcl.kld_err)")
    (bounds,) = error.floating_point_range
    assert (bounds.from_value, bounds.to_value, bounds.step, len(error.integer_range)) == (0.0, 1.0, 0.0, 0)
    (whole,) = beams.integer_range
    assert (whole.from_value, whole.to_value, whole.step, len(beams.floating_point_range)) == (2, 4000, 1, 0)
    assert model.additional_constraints == "one of: likelihood_field, likelihood_field_prob, beam"
    assert (fixed.read_only, len(fixed.floating_point_range)) == (True, 0)
    assert open_.floating_point_range[0].from_value == -1.0
    assert open_.floating_point_range[0].to_value > 1e300


def test_values_have_their_types(offered: Offered) -> None:
    names = ["pf_err", "max_beams", "do_beamskip", "laser_model_type", "use_sim_time"]
    values = offered.ask(messages.GET, names=names).values
    assert [value.type for value in values] == [3, 2, 1, 4, 1] == list(offered.ask(messages.TYPES, names=names).types)
    assert values[0].double_value == SOFTWARE.amcl.kld_err
    assert values[1].integer_value == SOFTWARE.amcl.laser_max_beams
    assert values[2].bool_value is SOFTWARE.amcl.do_beamskip
    assert values[3].string_value == SOFTWARE.amcl.laser_model_type
    assert values[4].bool_value is True


def test_an_unknown_name_makes_the_whole_answer_empty(offered: Offered) -> None:
    names = ["pf_err", "no_such"]
    assert offered.ask(messages.GET, names=names).values == []
    assert offered.ask(messages.DESCRIBE, names=names).descriptors == []
    assert list(offered.ask(messages.TYPES, names=names).types) == []


def test_each_parameter_has_its_result(offered: Offered) -> None:
    given_ = [parameter("pf_err", 0.25), parameter("pf_z", -1.0), parameter("x", (1, 2)), parameter("y", ("a", "b"))]
    results = offered.ask(messages.SET, parameters=given_).results
    assert [(each.successful, each.reason) for each in results] == [(True, ""), (False, "too small"), *[(True, "")] * 2]
    result = offered.ask(messages.SET_TOGETHER, parameters=given_).result
    assert (result.successful, result.reason) == (False, "too small")
    (read, together), (same, also) = offered.owner.given
    assert (together, also, read) == (False, True, same)
    assert read == [
        GivenParameter("pf_err", ParameterKind.DOUBLE, 0.25),
        GivenParameter("pf_z", ParameterKind.DOUBLE, -1.0),
        GivenParameter("x", ParameterKind.INTEGER_ARRAY, (1, 2)),
        GivenParameter("y", ParameterKind.STRING_ARRAY, ("a", "b")),
    ]


def test_a_type_without_a_name_is_read_as_not_set(offered: Offered) -> None:
    content = TYPES.make("rcl_interfaces/msg/ParameterValue", type=77, double_value=3.0)
    offered.ask(messages.SET, parameters=[TYPES.make("rcl_interfaces/msg/Parameter", name="pf_err", value=content)])
    assert offered.owner.given == [([GivenParameter("pf_err", ParameterKind.NOT_SET, None)], False)]


def test_events_have_new_and_changed_parameters(offered: Offered) -> None:
    offered.events.changed(1, [("pf_err", 0.5)])  # Without a subscriber, nothing is sent.
    offered.listen()
    offered.events.announce(2_500_000_000, NODE.reported(SOFTWARE))
    offered.events.changed(3_000_000_001, [("pf_err", 0.5), ("max_beams", 90)])
    offered.graph.deliver()
    first, second = offered.heard
    assert (first.node, first.stamp.sec, first.stamp.nanosec) == ("/robot1/amcl", 2, 500_000_000)
    assert [each.name for each in first.new_parameters] == list(NODE.parameters)
    assert {each.name: each.value.double_value for each in first.new_parameters}["pf_err"] == SOFTWARE.amcl.kld_err
    assert (first.changed_parameters, first.deleted_parameters, second.new_parameters) == ([], [], [])
    assert [each.name for each in second.changed_parameters] == ["pf_err", "max_beams"]
    assert [each.value.type for each in second.changed_parameters] == [3, 2]


def test_types_are_described(offered: Offered) -> None:
    for name in ("nav_msgs/msg/Odometry", "nav2_msgs/srv/LoadMap", "nav2_msgs/action/NavigateToPose"):
        hash_ = TYPES.message(name).hash
        answer = offered.ask("get_type_description", type_name=name, type_hash=hash_)
        assert (answer.successful, answer.failure_reason) == (True, "")
        assert answer.type_description.type_description.type_name == name
        described = TYPES.description(name)
        assert [each.name for each in answer.type_description.type_description.fields] == [
            field["name"] for field in described["type_description"]["fields"]
        ]
        assert [each.type_name for each in answer.type_description.referenced_type_descriptions] == [
            each["type_name"] for each in described["referenced_type_descriptions"]
        ]


@pytest.mark.parametrize(
    ("name", "hash_", "reason"),
    [
        ("nav_msgs/msg/Odometry", "RIHS01_" + 64 * "0", "this node uses the type nav_msgs/msg/Odometry with the hash"),
        ("nav_msgs/msg/Odometry", "", "'' is not a type hash"),
        ("nav_msgs/msg/None", "RIHS01_" + 64 * "0", "this node does not use the type nav_msgs/msg/None"),
        ("Odometry", "RIHS01_" + 64 * "0", "'Odometry' is not the name of a type"),
    ],
)
def test_an_unknown_type_has_a_reason(offered: Offered, name: str, hash_: str, reason: str) -> None:
    answer = offered.ask("get_type_description", type_name=name, type_hash=hash_)
    assert not answer.successful
    assert answer.failure_reason.startswith(reason)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from([*messages.SERVICE_TYPES, "get_type_description"]), st.binary(max_size=80), st.data())
def test_bytes_that_are_no_request_are_dropped(service: str, noise: bytes, data: st.DataObject) -> None:
    offered = Offered()
    request = TYPES.encode(
        "rcl_interfaces/srv/SetParameters_Request",
        TYPES.make("rcl_interfaces/srv/SetParameters_Request", parameters=[parameter("pf_err", 0.1)]),
    )
    place = data.draw(st.integers(0, len(request)))
    for damaged in (noise, request[:place] + noise, request[:place] + noise + request[place:]):
        offered.answer(service, damaged)  # No exception, and an answer only if the bytes are a request.


def test_a_short_request_gets_no_answer_and_one_warning(offered: Offered, caplog: pytest.LogCaptureFixture) -> None:
    for _ in range(3):
        assert offered.answer(messages.GET, b"\0\1\0\0\5") is None
    (record,) = [record for record in caplog.records if record.levelname == "WARNING"]
    assert "/robot1/amcl/get_parameters: ignoring a request of /client" in record.getMessage()
    assert cast(str, record.getMessage()).count("\n") == 0


def test_a_flood_waits_in_a_short_queue(offered: Offered, caplog: pytest.LogCaptureFixture) -> None:
    responses: list[bytes] = []
    type_ = messages.SERVICE_TYPES[messages.LIST]
    request = TYPES.encode(f"{type_}_Request", TYPES.make(f"{type_}_Request"))
    client = offered.other.client(CLIENT, "/robot1/amcl/list_parameters", TYPES.service(type_))
    for _ in range(MAX_WAITING + 50):
        client.call(request, responses.append)
    offered.graph.deliver()
    # The client's requests arrive before the first answer is due.
    assert len(responses) == MAX_WAITING
    assert [record.getMessage() for record in caplog.records if record.levelname == "WARNING"] == [
        "/robot1/amcl/list_parameters: too many or too long requests of /client wait; some are dropped"
    ]
    client.call(request, responses.append)
    offered.graph.deliver()
    assert len(responses) == MAX_WAITING + 1


def test_clients_take_turns(offered: Offered) -> None:
    order: list[str] = []
    type_ = messages.SERVICE_TYPES[messages.LIST]
    request = TYPES.encode(f"{type_}_Request", TYPES.make(f"{type_}_Request"))
    flooder, other = (
        offered.other.client(node, "/robot1/amcl/list_parameters", TYPES.service(type_))
        for node in (CLIENT, NodeName("/", "other"))
    )
    for _ in range(MAX_WAITING + 50):
        flooder.call(request, lambda response: order.append("flooder"))
    other.call(request, lambda response: order.append("other"))
    offered.graph.deliver()
    assert order.index("other") <= 2
    assert len(order) == MAX_WAITING + 1
