"""Listing and setting parameters of a node, as rclcpp does."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.parameters import RobotParameters
from thbridge.ros2.nav2_parameters import robot_nodes
from thbridge.ros2.parameters import (
    MAX_CHANGES,
    GivenParameter,
    ParameterKind,
    ParameterNode,
    Value,
    kind_of,
    listed,
    set_each,
    set_together,
)

SOFTWARE = RobotParameters()
NODES = {node.name: node for node in robot_nodes(0, SOFTWARE, 0.05)}
NAMES = ["a", "a.b", "a.b.c", "ab", "b.c.d.e", "b.c.f"]


def given_value(name: str, value: Value) -> GivenParameter:
    return GivenParameter(name, kind_of(value), value)


@pytest.mark.parametrize(
    ("prefixes", "depth", "names", "found"),
    [
        ([], 0, NAMES, ["a", "a.b", "b.c.d", "b.c"]),
        ([], 1, ["a", "ab"], []),
        ([], 2, ["a", "a.b", "ab"], ["a"]),
        (["a"], 0, ["a", "a.b", "a.b.c"], ["a", "a.b"]),
        (["a"], 1, ["a", "a.b"], ["a"]),
        (["b"], 1, [], []),
        (["b.c"], 1, ["b.c.f"], ["b.c"]),
        (["b.c.f", "ab"], 1, ["ab", "b.c.f"], ["b.c"]),
        ([""], 0, [], []),
    ],
)
def test_prefix_and_depth_choose_parameters(
    prefixes: list[str], depth: int, names: list[str], found: list[str]
) -> None:
    assert listed(NAMES, prefixes, depth) == (names, found)


@given(
    names=st.sets(st.lists(st.sampled_from("ab"), min_size=1, max_size=4).map(".".join)),
    prefixes=st.lists(st.sampled_from(["a", "b", "a.b", "b.b.a"]), max_size=2),
    depth=st.integers(0, 4),
)
def test_all_listed_parameters_are_below_a_prefix_and_not_too_deep(
    names: set[str], prefixes: list[str], depth: int
) -> None:
    chosen, _ = listed(sorted(names), prefixes, depth)
    for name in names:
        parts = name.split(".")
        below = [
            len(parts) - len(prefix)
            for prefix in (each.split(".") for each in prefixes)
            if parts[: len(prefix)] == prefix
        ] or ([] if prefixes else [len(parts)])
        assert (name in chosen) == any(count == 0 or depth == 0 or count <= depth for count in below)


@pytest.mark.parametrize(
    ("node", "name", "value", "reason"),
    [
        ("amcl", "no_such", 1, "parameter 'no_such' cannot be set because it was not declared"),
        ("amcl", "use_sim_time", False, "parameter 'use_sim_time' cannot be set because it is read-only"),
        (
            "amcl",
            "pf_err",
            1,
            "parameter 'pf_err' has the type double, so it cannot be set to a value of the type integer",
        ),
        (
            "amcl",
            "pf_err",
            "0.1",
            "parameter 'pf_err' has the type double, so it cannot be set to a value of the type string",
        ),
        (
            "amcl",
            "max_beams",
            40.0,
            "parameter 'max_beams' has the type integer, so it cannot be set to a value of the type double",
        ),
        ("amcl", "pf_err", 1.5, "pf_err is at most 1, not 1.5"),
        ("amcl", "max_beams", 1, "max_beams is at least 2, not 1"),
        ("amcl", "pf_err", float("nan"), "pf_err is a number, not nan"),
        ("amcl", "laser_model_type", "magic", "laser_model_type: amcl.laser_model_type is likelihood_field or"),
        ("amcl", "min_particles", 5000, "min_particles: amcl.min_particles would be 5000, above amcl.max_particles"),
        ("local_costmap", "footprint", "[[0, 0]]", "footprint: local_costmap.footprint is three or more corners"),
    ],
)
def test_a_refusal_says_why(node: str, name: str, value: Value, reason: str) -> None:
    for set_parameters in (set_each, set_together):
        changes = set_parameters(NODES[node], SOFTWARE, [given_value(name, value)])
        assert changes.refusals[0].startswith(reason)
        assert changes.values == ()
        assert changes.software is SOFTWARE


def test_each_parameter_is_set_in_its_order() -> None:
    asked = [given_value("min_particles", 2000), given_value("max_particles", 3000), given_value("min_particles", 2000)]
    changes = set_each(NODES["amcl"], SOFTWARE, asked)
    assert [bool(reason) for reason in changes.refusals] == [True, False, False]
    assert changes.values == (("amcl.max_particles", 3000), ("amcl.min_particles", 2000))
    assert changes.software.amcl == replace(SOFTWARE.amcl, min_particles=2000, max_particles=3000)


def test_all_parameters_are_set_together_or_none() -> None:
    together = [given_value("min_particles", 2000), given_value("max_particles", 3000)]
    changes = set_together(NODES["amcl"], SOFTWARE, together)
    assert changes.refusals == ("",)
    assert changes.software.amcl == replace(SOFTWARE.amcl, min_particles=2000, max_particles=3000)
    refused = set_together(NODES["amcl"], SOFTWARE, [*together, given_value("pf_err", 7.0)])
    assert refused.refusals == ("pf_err is at most 1, not 7",)
    assert (refused.values, refused.software) == ((), SOFTWARE)


def test_the_last_of_equal_names_counts() -> None:
    changes = set_together(NODES["amcl"], SOFTWARE, [given_value("pf_err", 0.2), given_value("pf_err", 0.05)])
    assert (changes.refusals, changes.values) == (("",), ())


def test_the_present_value_is_no_change() -> None:
    for node in NODES.values():
        whole = [
            GivenParameter(name, node.parameters[name].kind, value) for name, value in node.reported(SOFTWARE).items()
        ]
        changes = set_each(node, SOFTWARE, whole)
        assert set(changes.refusals) <= {""}
        assert changes.values == ()


def test_a_weight_of_dwb_has_its_own_unit() -> None:
    software = with_dwb()
    node = next(node for node in robot_nodes(0, software, 0.05) if node.name == "controller_server")
    name = "FollowPath.PathDist.scale"
    assert node.parameters[name].reported(software) == 2.0 * software.DWAPlannerROS.path_distance_bias
    changes = set_each(node, software, [given_value(name, 3.0)])
    assert changes.values == (("DWAPlannerROS.path_distance_bias", 1.5),)
    assert set_each(node, software, [given_value(name, 2001.0)]).refusals == (f"{name} is at most 2000, not 2001",)


def with_dwb() -> RobotParameters:
    base = replace(SOFTWARE.move_base, base_local_planner="dwa_local_planner/DWAPlannerROS")
    return replace(SOFTWARE, move_base=base)


@pytest.mark.parametrize("together", [False, True])
def test_requests_have_a_limit(together: bool) -> None:
    asked = [given_value("pf_err", 0.1)] * (MAX_CHANGES + 1)
    changes = (set_together if together else set_each)(NODES["amcl"], SOFTWARE, asked)
    assert len(changes.refusals) == (1 if together else len(asked))
    assert set(changes.refusals) == {f"a request sets at most {MAX_CHANGES} parameters"}


def test_an_empty_list_is_refused_only_together() -> None:
    node = ParameterNode("/", "node", None, {})
    assert set_each(node, SOFTWARE, []).refusals == ()
    assert set_together(node, SOFTWARE, []).refusals == ("the list of parameters is empty",)


def test_arrays_have_the_type_of_their_items() -> None:
    assert kind_of((1.0, 2.0)) is ParameterKind.DOUBLE_ARRAY
    assert kind_of(("a",)) is ParameterKind.STRING_ARRAY
    assert kind_of((True,)) is ParameterKind.BOOL_ARRAY
    assert kind_of((3,)) is ParameterKind.INTEGER_ARRAY
