"""Services of lifecycle nodes, and of Nav2's lifecycle managers, for nodes that are always active.

A transition is part of a program's start or end. A session has all its nodes in one program, so each node refuses every
transition, as a lifecycle node does for a transition that its present state does not have.

Source: ros2/rcl, rcl_lifecycle/src/default_state_machine.c; ros2/rcl_interfaces, lifecycle_msgs;
ros-navigation/navigation2, nav2_lifecycle_manager/src/lifecycle_manager.cpp.
"""

from collections.abc import Callable, Iterable, Mapping

from thbridge.ros2.distribution import Distribution
from thbridge.ros2.services import constant_answer

GET_STATE = "lifecycle_msgs/srv/GetState"
CHANGE_STATE = "lifecycle_msgs/srv/ChangeState"
GET_STATES = "lifecycle_msgs/srv/GetAvailableStates"
GET_TRANSITIONS = "lifecycle_msgs/srv/GetAvailableTransitions"
IS_ACTIVE = "std_srvs/srv/Trigger"
MANAGE_NODES = "nav2_msgs/srv/ManageLifecycleNodes"

_ACTIVE = "active"
_STATES: Mapping[str, int] = {
    "unknown": 0,
    "unconfigured": 1,
    "inactive": 2,
    _ACTIVE: 3,
    "finalized": 4,
    "configuring": 10,
    "cleaningup": 11,
    "shuttingdown": 12,
    "activating": 13,
    "deactivating": 14,
    "errorprocessing": 15,
}
"""Ids of states."""
_TRANSITIONS: tuple[tuple[int, str, str, str], ...] = (
    (1, "configure", "unconfigured", "configuring"),
    (10, "transition_success", "configuring", "inactive"),
    (11, "transition_failure", "configuring", "unconfigured"),
    (12, "transition_error", "configuring", "errorprocessing"),
    (2, "cleanup", "inactive", "cleaningup"),
    (20, "transition_success", "cleaningup", "unconfigured"),
    (21, "transition_failure", "cleaningup", "inactive"),
    (22, "transition_error", "cleaningup", "errorprocessing"),
    (3, "activate", "inactive", "activating"),
    (30, "transition_success", "activating", _ACTIVE),
    (31, "transition_failure", "activating", "inactive"),
    (32, "transition_error", "activating", "errorprocessing"),
    (4, "deactivate", _ACTIVE, "deactivating"),
    (40, "transition_success", "deactivating", "inactive"),
    (41, "transition_failure", "deactivating", _ACTIVE),
    (42, "transition_error", "deactivating", "errorprocessing"),
    (5, "shutdown", "unconfigured", "shuttingdown"),
    (6, "shutdown", "inactive", "shuttingdown"),
    (7, "shutdown", _ACTIVE, "shuttingdown"),
    (50, "transition_success", "shuttingdown", "finalized"),
    (51, "transition_failure", "shuttingdown", "finalized"),
    (52, "transition_error", "shuttingdown", "errorprocessing"),
    (60, "transition_success", "errorprocessing", "unconfigured"),
    (61, "transition_failure", "errorprocessing", "finalized"),
    (62, "transition_error", "errorprocessing", "finalized"),
)
"""Id, label, first state and last state of each transition."""


def lifecycle_answers(types: Distribution) -> Mapping[str, tuple[str, Callable[[bytes], bytes]]]:
    """Return type and answer of each service of an active lifecycle node, by the last part of the service's name."""
    states = [_state(types, label) for label in _STATES]
    now = [each for each in _TRANSITIONS if each[2] == _ACTIVE]
    return {
        "get_state": (GET_STATE, constant_answer(types, GET_STATE, current_state=_state(types, _ACTIVE))),
        "change_state": (CHANGE_STATE, constant_answer(types, CHANGE_STATE)),
        "get_available_states": (GET_STATES, constant_answer(types, GET_STATES, available_states=states)),
        "get_available_transitions": (GET_TRANSITIONS, _transitions(types, now)),
        "get_transition_graph": (GET_TRANSITIONS, _transitions(types, _TRANSITIONS)),
    }


def manager_answers(types: Distribution) -> Mapping[str, tuple[str, Callable[[bytes], bytes]]]:
    """Return type and answer of each service of a lifecycle manager, by the last part of the service's name."""
    return {
        "is_active": (IS_ACTIVE, constant_answer(types, IS_ACTIVE, success=True)),
        "manage_nodes": (MANAGE_NODES, constant_answer(types, MANAGE_NODES)),
    }


def _transitions(types: Distribution, transitions: Iterable[tuple[int, str, str, str]]) -> Callable[[bytes], bytes]:
    described = [
        types.make(
            "lifecycle_msgs/msg/TransitionDescription",
            transition=types.make("lifecycle_msgs/msg/Transition", id=number, label=label),
            start_state=_state(types, first),
            goal_state=_state(types, last),
        )
        for number, label, first, last in transitions
    ]
    return constant_answer(types, GET_TRANSITIONS, available_transitions=described)


def _state(types: Distribution, label: str) -> object:
    return types.make("lifecycle_msgs/msg/State", id=_STATES[label], label=label)
