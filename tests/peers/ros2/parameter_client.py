"""A client of parameters with rclpy: it makes the same calls at our node and at a node of rclpy with equal parameters.

It runs with the Python of the peer, so it imports nothing of the project. It prints what came as one line of JSON.
"""

import json
import sys
import time
from pathlib import Path

import rclpy
from lifecycle_msgs.srv import GetState
from nav_msgs.srv import GetMap
from rcl_interfaces.msg import LoggerLevel, ParameterEvent, ParameterType
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import qos_profile_parameter_events
from std_srvs.srv import Empty
from type_description_interfaces.srv import GetTypeDescription

TIMEOUT = 60.0
OWN = ("use_sim_time", "start_type_description_service")
rclpy.init()
executor = SingleThreadedExecutor()
client_node = Node("parameter_client")
executor.add_node(client_node)
events = []
client_node.create_subscription(ParameterEvent, "/parameter_events", events.append, qos_profile_parameter_events)


def wait(future):
    executor.spin_until_future_complete(future, TIMEOUT)
    assert future.done(), "no response"
    return future.result()


def until(happens):
    end = time.monotonic() + TIMEOUT
    while not happens():
        assert time.monotonic() < end
        executor.spin_once(0.05)


def connected(name):
    client = AsyncParameterClient(client_node, name)
    assert client.wait_for_services(TIMEOUT), name
    return client


def call(type_, name, **fields):
    client = client_node.create_client(type_, name)
    assert client.wait_for_service(TIMEOUT), name
    return wait(client.call_async(type_.Request(**fields)))


def results(answer):
    return [[each.successful, each.reason] for each in answer.results]


target, twin_name = sys.argv[1], "/twin"
ours = connected(target)
names = list(wait(ours.list_parameters()).result.names)
values = [parameter_value_to_python(value) for value in wait(ours.get_parameters(names)).values]
descriptors = wait(ours.describe_parameters(names)).descriptors
by_name = dict(zip(names, values, strict=True))
twin_node = Node("twin", parameter_overrides=[Parameter("use_sim_time", value=True)])
for name, value, descriptor in zip(names, values, descriptors, strict=True):
    if name not in OWN:
        twin_node.declare_parameter(name, value, descriptor)
executor.add_node(twin_node)
twin = connected(twin_name)

changeable = next(each for each in descriptors if not each.read_only and each.type == ParameterType.PARAMETER_DOUBLE)
bounds = changeable.floating_point_range[0]
fixed = next(each for each in descriptors if each.read_only and each.name not in OWN)
whole = next(each for each in descriptors if not each.read_only and each.type == ParameterType.PARAMETER_INTEGER)
middle = bounds.from_value + (bounds.to_value - bounds.from_value) / 4
prefix = sys.argv[2]


def calls(client):
    """Make all calls, and return what came."""
    found = {}
    for label, prefixes, depth in (
        ("all", None, 0),
        ("flat", None, 1),
        ("two", None, 2),
        ("below", [prefix], 0),
        ("shallow", [prefix], 1),
        ("named", [changeable.name, "no_such"], 0),
        ("nothing", ["no_such"], 0),
    ):
        answer = wait(client.list_parameters(prefixes, depth)).result
        # The one sorts by name, as rclcpp does, the other by the time of declaration.
        found[f"list {label}"] = [sorted(set(answer.names)), sorted(set(answer.prefixes))]
    found["get"] = [parameter_value_to_python(each) for each in wait(client.get_parameters(names[::-1])).values]
    found["get twice"] = len(wait(client.get_parameters([names[0]] * 2)).values)
    found["get unknown"] = len(wait(client.get_parameters([names[0], "no_such"])).values)
    found["types"] = list(wait(client.get_parameter_types(names)).types)
    found["types unknown"] = list(wait(client.get_parameter_types([names[0], "no_such"])).types)
    found["describe unknown"] = len(wait(client.describe_parameters([names[0], "no_such"])).descriptors)
    found["describe"] = [
        [each.name, each.type, each.description, each.read_only, each.dynamic_typing, each.additional_constraints]
        + [[bound.from_value, bound.to_value] for bound in [*each.floating_point_range, *each.integer_range]]
        for each in wait(client.describe_parameters([name for name in names if name not in OWN])).descriptors
    ]
    sets = {
        "in range": [Parameter(changeable.name, value=middle)],
        "above": [Parameter(changeable.name, value=bounds.to_value * 2 + 1)],
        "wrong type": [Parameter(changeable.name, value="text")],
        "integer": [Parameter(changeable.name, value=int(bounds.to_value))],
        "double": [Parameter(whole.name, value=float(whole.integer_range[0].from_value))],
        "fixed": [Parameter(fixed.name, value=by_name[fixed.name])],
        "unknown": [Parameter("no_such", value=1)],
        "deleted": [Parameter(changeable.name, Parameter.Type.NOT_SET)],
        "mixed": [
            Parameter(changeable.name, value=bounds.to_value * 2 + 1),
            Parameter(whole.name, value=whole.integer_range[0].from_value),
        ],
    }
    for label, parameters in sets.items():
        found[f"set {label}"] = results(wait(client.set_parameters(parameters)))
    for label in ("mixed", "fixed", "unknown", "in range"):
        result = wait(client.set_parameters_atomically(sets[label])).result
        found[f"atomically {label}"] = [[result.successful, result.reason]]
    changed = [changeable.name, whole.name]
    found["present"] = [parameter_value_to_python(each) for each in wait(client.get_parameters(changed)).values]
    return found


answers = {"ours": calls(ours), "theirs": calls(twin)}


def of_node(name):
    return [
        [each.name, parameter_value_to_python(each.value)]
        for event in events
        if event.node == name
        for each in event.changed_parameters
    ]


until(lambda: len(of_node(target)) >= 2)
answers["ours"]["events"], answers["theirs"]["events"] = of_node(target), of_node(twin_name)


def type_fields(type_):
    return type_.type_id, type_.capacity, type_.string_capacity, type_.nested_type_name


described = {}
for name in (
    "rcl_interfaces/srv/GetParameters",
    "rcl_interfaces/srv/ListParameters",
    "rcl_interfaces/msg/ParameterEvent",
    "rcl_interfaces/srv/SetParametersAtomically",
    "rcl_interfaces/srv/no_hash",
):
    file = Path(sys.prefix) / "share" / f"{name}.json"
    hashes = json.loads(file.read_text())["type_hashes"] if file.exists() else []
    hash_ = next((each["hash_string"] for each in hashes if each["type_name"] == name), "RIHS01_" + 64 * "0")
    for node in (target, twin_name):
        answer = call(GetTypeDescription, f"{node}/get_type_description", type_name=name, type_hash=hash_)
        whole = answer.type_description
        described.setdefault(name, []).append(
            [
                answer.successful,
                bool(answer.failure_reason),
                [
                    [
                        struct.type_name,
                        [[each.name, each.default_value, *type_fields(each.type)] for each in struct.fields],
                    ]
                    for struct in [whole.type_description, *whole.referenced_type_descriptions]
                ],
            ]
        )
answers["described"] = described
robot = "/" + target.split("/")[1]
state = call(GetState, f"{target}/get_state").current_state
grid = call(GetMap, f"{robot}/map_server/map").map
call(Empty, f"{robot}/reinitialize_global_localization")
levels = [LoggerLevel(name="thbridge", level=0), LoggerLevel(name="none", level=20)]
answers["services"] = {
    "state": [state.id, state.label],
    "map": [grid.header.frame_id, grid.info.width, grid.info.height, list(grid.data)],
    "levels": [each.level for each in call(GetLoggerLevels, "/thbridge/get_logger_levels", names=["none"]).levels],
    "set levels": [
        each.successful for each in call(SetLoggerLevels, "/thbridge/set_logger_levels", levels=levels).results
    ],
}
print(json.dumps(answers), flush=True)
