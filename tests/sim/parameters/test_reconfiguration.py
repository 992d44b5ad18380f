"""Parameters that change while robots run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.inputs import DriveManually, KillRobot, PutThing, SendGoal, SetSoftwareParameters
from sim.parameters import ParameterRejection, RobotParameters, WorldParameters, reconfigurable, reconfigured
from sim.robot.costmap.costs import INSCRIBED, LETHAL
from sim.robot.global_planning.path import PlanRefusal
from sim.robot.navigator.goals import Goal, GoalReached
from sim.team import Team
from sim.world.thing import Thing
from thbridge.files.map_files import read_map

ARENA = read_map(Path(__file__).parents[3] / "maps" / "arena8")
SECOND = 50
STUDY = RobotParameters()
SHOWN = replace(
    STUDY,
    global_costmap=replace(STUDY.global_costmap, publish_frequency=10.0),
    local_costmap=replace(STUDY.local_costmap, publish_frequency=10.0),
)
FAR = Goal(1, ARENA.rooms[3].goal)


def changed(path, value, parameters=STUDY):
    result = reconfigured(parameters, path, value)
    assert isinstance(result, RobotParameters), result
    return result


def team_of(parameters=STUDY):
    return Team(ARENA.grid, WorldParameters(), [parameters], ARENA.starts[:1], 1, 1e9)


def run(team, seconds, *inputs):
    snapshots = [team.step(inputs).read_costmaps()]
    while len(snapshots) < seconds * SECOND:
        snapshots.append(team.step().read_costmaps())
    return snapshots


def trace(snapshots):
    return [
        part
        for s in snapshots
        for part in (
            s.world.poses.tobytes(),
            s.commands.tobytes(),
            s.robots[0].estimate.particles.tobytes(),
            s.robots[0].navigation.plan.tobytes(),
            s.robots[0].navigation.local_plan.tobytes(),
        )
    ]


def last_views(snapshots):
    navigation = [s.robots[0].navigation for s in snapshots if s.robots[0].navigation.local_costmap][-1]
    return navigation.global_costmap.read(), navigation.local_costmap.read()


# Which values are taken


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("amcl.no_such", 1, "unknown"),
        ("amcl.min_particles.deeper", 1, "unknown"),
        ("", 1, "unknown"),
        ("amcl", 1, "fixed"),
        ("amcl.initial_pose_x", 1.0, "fixed"),
        ("localization", "ekf", "fixed"),
        ("NavfnROS.allow_unknown", True, "fixed"),
        ("amcl.min_particles", 1.5, "kind"),
        ("amcl.min_particles", True, "kind"),
        ("amcl.kld_err", "much", "kind"),
        ("amcl.kld_err", float("nan"), "kind"),
        ("amcl.kld_err", 10**400, "kind"),
        ("amcl.do_beamskip", 1, "kind"),
        ("amcl.laser_model_type", 3, "kind"),
        ("amcl.laser_model_type", "sonar", "range"),
        ("amcl.min_particles", 0, "range"),
        ("amcl.min_particles", STUDY.amcl.max_particles + 1, "range"),
        ("TrajectoryPlannerROS.max_vel_x", 21.0, "range"),
        ("local_costmap.footprint", "[[0, 0], [1, 1]]", "kind"),
        ("local_costmap.footprint", "a square", "kind"),
        pytest.param("local_costmap.footprint", "[" * 100_000, "kind", id="only brackets"),
    ],
)
def test_what_cannot_be_is_rejected_for_the_right_reason(path, value, reason):
    result = reconfigured(STUDY, path, value)
    assert isinstance(result, ParameterRejection)
    assert (result.path, result.reason) == (path, reason)
    assert path in result.sentence


def test_a_rejection_tells_the_bounds_and_the_unit():
    result = reconfigured(STUDY, "TrajectoryPlannerROS.max_vel_x", 21)
    assert result.sentence == "TrajectoryPlannerROS.max_vel_x is at most 20 m/s, not 21"


@pytest.mark.parametrize(
    ("path", "value", "kept"),
    [
        ("amcl.kld_err", 1, 1.0),
        ("amcl.do_beamskip", True, True),
        ("amcl.laser_model_type", "beam", "beam"),
        ("local_costmap.inflation_layer.inflation_radius", 0.2, 0.2),
        ("local_costmap.robot_radius", None, None),
        ("local_costmap.footprint", "[[0.1, 0.1], [-0.1, 0.1], [0, -0.1]]", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1))),
        ("local_costmap.footprint", "", ()),
    ],
)
def test_a_value_is_kept_as_its_field_holds_it(path, value, kept):
    section = changed(path, value)
    for name in path.split("."):
        section = getattr(section, name)
    assert section == kept
    assert type(section) is type(kept)


def test_only_the_one_parameter_changes():
    new = changed("local_costmap.inflation_layer.inflation_radius", 0.2)
    inflation = replace(STUDY.local_costmap.inflation_layer, inflation_radius=0.2)
    assert new == replace(STUDY, local_costmap=replace(STUDY.local_costmap, inflation_layer=inflation))


COSTMAP = """
    footprint robot_radius footprint_padding update_frequency publish_frequency static_layer.enabled
    obstacle_layer.enabled obstacle_layer.footprint_clearing_enabled obstacle_layer.combination_method
    obstacle_layer.obstacle_range obstacle_layer.raytrace_range inflation_layer.enabled
    inflation_layer.inflation_radius inflation_layer.cost_scaling_factor inflation_layer.inflate_unknown
"""
IN_CFG_FILES = {
    "amcl": """
        min_particles max_particles kld_err kld_z update_min_d update_min_a resample_interval recovery_alpha_slow
        recovery_alpha_fast do_beamskip beam_skip_distance beam_skip_threshold laser_min_range laser_max_range
        laser_max_beams laser_z_hit laser_z_short laser_z_max laser_z_rand laser_sigma_hit laser_lambda_short
        laser_likelihood_max_dist laser_model_type odom_model_type odom_alpha1 odom_alpha2 odom_alpha3 odom_alpha4
        odom_alpha5
    """,
    "global_costmap": COSTMAP,
    "local_costmap": f"{COSTMAP} width height",
    "GlobalPlanner": "lethal_cost neutral_cost cost_factor orientation_mode orientation_window_size",
    "TrajectoryPlannerROS": """
        acc_lim_x acc_lim_theta max_vel_x min_vel_x max_vel_theta min_vel_theta min_in_place_vel_theta sim_time
        sim_granularity angular_sim_granularity path_distance_bias goal_distance_bias occdist_scale
        oscillation_reset_dist escape_reset_dist escape_reset_theta vx_samples vtheta_samples heading_lookahead
        escape_vel dwa heading_scoring heading_scoring_timestep simple_attractor
    """,
    "DWAPlannerROS": """
        max_vel_trans min_vel_trans max_vel_x min_vel_x max_vel_theta min_vel_theta acc_lim_x acc_lim_theta
        xy_goal_tolerance yaw_goal_tolerance trans_stopped_vel theta_stopped_vel sim_time sim_granularity
        angular_sim_granularity path_distance_bias goal_distance_bias occdist_scale twirling_scale
        oscillation_reset_dist oscillation_reset_angle forward_point_distance scaling_speed max_scaling_factor
        vx_samples vth_samples use_dwa
    """,
    "move_base": """
        base_global_planner base_local_planner planner_frequency controller_frequency planner_patience
        controller_patience max_planning_retries conservative_reset_dist recovery_behavior_enabled
        clearing_rotation_allowed shutdown_costmaps oscillation_timeout oscillation_distance
        make_plan_add_unreachable_goal
    """,
}


ALSO = {
    "amcl": "odom_noise_learning_rate",
    "TrajectoryPlannerROS": "xy_goal_tolerance yaw_goal_tolerance",
    "ekf": """
        update_min_d update_min_a laser_max_beams laser_max_range odom_alpha1 odom_alpha2 odom_alpha3 odom_alpha4
        gyro_noise
    """,
}


def test_what_ros_can_reconfigure_can_be_here_and_little_else():
    tables = (*IN_CFG_FILES.items(), *ALSO.items())
    assert set(reconfigurable()) == {f"{section}.{name}" for section, names in tables for name in names.split()}


@given(st.sampled_from(sorted(reconfigurable())), st.none() | st.booleans() | st.integers() | st.floats() | st.text())
def test_whatever_comes_is_taken_or_rejected(path, value):
    result = reconfigured(STUDY, path, value)
    assert isinstance(result, RobotParameters | ParameterRejection)


# What they do


def test_configuring_with_the_same_parameters_changes_nothing():
    traces = []
    for inputs in ([], [SetSoftwareParameters(0, replace(STUDY, amcl=replace(STUDY.amcl)))]):
        team = team_of()
        snapshots = run(team, 3, SendGoal(0, FAR))
        traces.append(trace(snapshots + run(team, 3, *inputs)))
    assert traces[0] == traces[1]


def another(path):
    """A value that a parameter may have and has not."""
    section = STUDY
    *sections, name = path.split(".")
    for part in sections:
        section = getattr(section, part)
    value, metadata = getattr(section, name), section.__dataclass_fields__[name].metadata
    if isinstance(value, bool):
        return not value
    if metadata["choices"]:
        return next(choice for choice in metadata["choices"] if choice != value)
    if name == "footprint":
        return "[[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]"
    if value is None:
        return 0.3
    if isinstance(value, int):
        return value + 1 if metadata["maximum"] is None or value < metadata["maximum"] else value - 1
    return 0.9 * value if value != 0.0 else 0.1


def sections():
    found = {}
    for path in reconfigurable():
        found.setdefault(path.partition(".")[0], []).append(path)
    return found


@pytest.mark.parametrize(("section", "paths"), sections().items(), ids=sections())
def test_what_is_told_before_the_first_tick_acts_as_if_it_had_been_so_from_the_beginning(section, paths):
    start = STUDY
    if section in {"DWAPlannerROS", "GlobalPlanner"}:
        planners = {
            "base_local_planner": "dwa_local_planner/DWAPlannerROS",
            "base_global_planner": "global_planner/GlobalPlanner",
        }
        start = replace(STUDY, move_base=replace(STUDY.move_base, **planners))
    if section == "ekf":
        start = replace(STUDY, localization="ekf")
    new = start
    for path in paths:
        new = changed(path, another(path), new)
    traces = [
        trace(run(team, 4, *inputs, SendGoal(0, FAR)))
        for team, inputs in (
            (team_of(new), []),
            (team_of(start), [SetSoftwareParameters(0, new)]),
            (team_of(start), []),
        )
    ]
    assert traces[0] == traces[1]
    assert traces[0] != traces[2]


def test_how_often_costmaps_are_shown_can_change_and_nothing_else_does():
    shown = changed("local_costmap.publish_frequency", 10.0, changed("global_costmap.publish_frequency", 10.0))
    traces = []
    for inputs in ([], [SetSoftwareParameters(0, shown)]):
        team = team_of()
        before = run(team, 3, SendGoal(0, FAR))
        after = run(team, 3, *inputs)
        traces.append(trace(before + after))
    assert traces[0] == traces[1]
    assert sum(s.robots[0].navigation.local_costmap is not None for s in after) == 30


def test_a_slower_robot_keeps_goal_and_plan_and_arrives():
    team = team_of()
    last = run(team, 3, SendGoal(0, FAR))[-1]
    snapshots = run(team, 60, SetSoftwareParameters(0, changed("TrajectoryPlannerROS.max_vel_x", 0.5)))
    navigation = snapshots[0].robots[0].navigation
    assert navigation.goal == FAR
    assert len(navigation.plan) >= len(last.robots[0].navigation.plan) - 1
    assert max(s.robots[0].navigation.command.linear for s in snapshots[SECOND:]) == pytest.approx(0.5)
    assert any(isinstance(s.robots[0].navigation.result, GoalReached) for s in snapshots)


def test_a_robot_that_need_not_be_exact_any_more_has_arrived_where_it_is():
    team = team_of()
    near = team_of().step().robots[0].estimate.base_in_map.compose(Pose2(0.6, 0.0, 0.0))
    run(team, 0.5, SendGoal(0, Goal(1, near)))
    loose = changed("TrajectoryPlannerROS.xy_goal_tolerance", 5.0)
    first, *_ = run(team, 1, SetSoftwareParameters(0, changed("TrajectoryPlannerROS.yaw_goal_tolerance", 3.15, loose)))
    before = first.robots[0].estimate.base_in_map.distance(near)
    result = next(s.robots[0].navigation.result for s in [first, *_] if s.robots[0].navigation.result is not None)
    assert isinstance(result, GoalReached)
    assert before > 0.2


@pytest.mark.parametrize("kind", ["ekf", "ukf"])
def test_a_filter_that_trusts_its_wheels_less_doubts_more_and_goes_on_from_what_it_believed(kind):
    start = replace(STUDY, localization=kind, ekf=replace(STUDY.ekf, vo_used=False))
    doubts = []
    for inputs in ([], [SetSoftwareParameters(0, changed("ekf.odom_alpha3", 1.0, start))]):
        team = team_of(start)
        before = run(team, 1, DriveManually(0, Twist(0.3, 0.0), 3 * SECOND))[-1].robots[0].estimate
        first, *_, last = (each.robots[0].estimate for each in run(team, 1, *inputs))
        assert first.base_in_map.distance(before.base_in_map) < 0.01
        doubts.append(float(np.trace(last.covariance[:2, :2]) - np.trace(before.covariance[:2, :2])))
    assert doubts[1] > 5.0 * doubts[0] > 0.0


def test_the_other_planners_take_over_under_way():
    team = team_of()
    run(team, 2, SendGoal(0, FAR))
    for path, value in (
        ("move_base.base_local_planner", "dwa_local_planner/DWAPlannerROS"),
        ("move_base.base_global_planner", "global_planner/GlobalPlanner"),
        ("move_base.controller_frequency", 5.0),
    ):
        team.step([SetSoftwareParameters(0, changed(path, value, team.parameters[0]))])
    assert team.parameters[0].move_base.controller_frequency == 5.0
    assert any(isinstance(s.robots[0].navigation.result, GoalReached) for s in run(team, 60))


def test_particles_stay_and_their_number_follows_the_new_bounds():
    team = team_of()
    before = run(team, 3, SendGoal(0, FAR))[-1].robots[0].estimate
    fewer = changed("amcl.max_particles", 150, changed("amcl.min_particles", 120))
    first, *rest = run(team, 5, SetSoftwareParameters(0, fewer))
    if not first.robots[0].estimate.updated:
        assert np.array_equal(first.robots[0].estimate.particles, before.particles)
    assert not any(s.robots[0].estimate.lost for s in rest)
    assert 120 <= len(rest[-1].robots[0].estimate.particles) <= 150


def test_costmaps_keep_what_was_seen_and_take_the_new_inflation():
    start = ARENA.starts[0]
    crate = Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)), start.compose(Pose2(0.9, 0.0, 0.0)))
    team = team_of(SHOWN)
    before = last_views(run(team, 2, PutThing(crate), DriveManually(0, Twist(0.0, 0.0), 1)))
    wider = SHOWN
    for costmap in ("global_costmap", "local_costmap"):
        wider = changed(f"{costmap}.inflation_layer.inflation_radius", 0.8, wider)
        wider = changed(f"{costmap}.inflation_layer.cost_scaling_factor", 2.0, wider)
    after = last_views(run(team, 0.2, SetSoftwareParameters(0, wider)))
    for old, new in zip(before, after, strict=True):
        # The laser went on marking and clearing meanwhile.
        assert abs(int((new.costs == LETHAL).sum()) - int((old.costs == LETHAL).sum())) < 5
        prudent = [((view.costs > 0) & (view.costs < INSCRIBED)).sum() for view in (old, new)]
        assert prudent[1] > 1.2 * prudent[0]


def test_a_local_costmap_of_another_size_stays_around_the_robot():
    team = team_of(SHOWN)
    run(team, 2, SendGoal(0, FAR))
    _, view = last_views(run(team, 1, SetSoftwareParameters(0, changed("local_costmap.width", 6.0, SHOWN))))
    assert view.costs.shape == (80, 120)
    pose = team.step().robots[0].estimate.base_in_map
    assert abs(view.origin.x + 3.0 - pose.x) < 0.5
    assert abs(view.origin.y + 2.0 - pose.y) < 0.5
    assert any(isinstance(s.robots[0].navigation.result, GoalReached) for s in run(team, 60))


def test_a_dead_robot_takes_no_parameters():
    team = team_of()
    run(team, 1, KillRobot(0), SetSoftwareParameters(0, changed("amcl.max_particles", 500)))
    assert team.parameters == (STUDY,)


def test_what_cannot_change_is_no_input():
    told = r"robot 0: these parameters cannot change while it runs: ekf\.imu_used, .* move_base\.recovery_behaviors"
    with pytest.raises(ValueError, match=told):
        team_of().step(
            [
                SetSoftwareParameters(
                    0,
                    replace(
                        STUDY,
                        ekf=replace(STUDY.ekf, imu_used=False, vo_used=False),
                        move_base=replace(STUDY.move_base, recovery_behaviors=()),
                    ),
                )
            ]
        )


# Plans for those who ask


def test_a_plan_that_is_asked_for_changes_nothing():
    traces = []
    for asks in (False, True):
        team = team_of()
        snapshots = []
        for tick in range(4 * SECOND):
            snapshots.append(team.step([SendGoal(0, FAR)] if tick == 0 else []))
            if asks:
                team.make_plan(0, None, ARENA.rooms[tick % 8].goal, 0.5)
        traces.append(trace(snapshots))
    assert traces[0] == traces[1]


def test_a_plan_leads_from_the_robot_to_the_goal_even_before_the_first_tick():
    team, goal = team_of(), ARENA.rooms[5].goal
    for _ in range(2):
        plan = team.make_plan(0, None, goal, 0.0)
        assert plan[0, :2] == pytest.approx(ARENA.starts[0].array()[:2], abs=0.1)
        assert plan[-1] == pytest.approx(goal.array())
        assert np.hypot(*np.diff(plan[:, :2], axis=0).T).max() < 0.2
        team.step()


def test_a_plan_may_begin_elsewhere():
    plan = team_of().make_plan(0, ARENA.rooms[1].goal, ARENA.rooms[5].goal, 0.0)
    assert plan[0, :2] == pytest.approx(ARENA.rooms[1].goal.array()[:2])


def test_where_the_goal_is_a_wall_the_plan_ends_as_near_as_is_tolerated():
    row, col = np.argwhere(ARENA.grid.cells == 100)[1000].tolist()
    x, y = ARENA.grid.centres_of(np.array([[row, col]]))[0].tolist()
    wall, team = Pose2(x, y, 0.3), team_of()
    assert isinstance(team.make_plan(0, None, wall, 0.0), PlanRefusal)
    assert isinstance(team.make_plan(0, None, wall, 0.1), PlanRefusal)
    plan = team.make_plan(0, None, wall, 1.5)
    assert plan[-1] == pytest.approx(wall.array())
    near = plan[-2]
    assert 0.2 < max(abs(near[0] - x), abs(near[1] - y)) <= 0.6
    shorter = team_of(changed("move_base.make_plan_add_unreachable_goal", False))
    assert np.array_equal(shorter.make_plan(0, None, wall, 1.5), plan[:-1])


@pytest.mark.parametrize("far", [1e6, 1e100, 1.7e308])
def test_a_goal_however_far_away_is_refused(far):
    team, place = team_of(), Pose2(far, -far, 0.0)
    for start, goal in ((None, place), (place, FAR.base_in_map)):
        assert isinstance(team.make_plan(0, start, goal, 0.5), PlanRefusal)
    results = [s.robots[0].navigation.result for s in run(team, 2, SendGoal(0, Goal(7, place)))]
    assert [result.reason for result in results if result] == ["goal_outside"]


@pytest.mark.parametrize("tolerance", [1e9, float("inf"), float("nan"), -1.0])
def test_a_tolerance_of_any_size_is_answered(tolerance):
    plan = team_of().make_plan(0, None, Pose2(1e6, 1e6, 0.0), tolerance)
    assert isinstance(plan, PlanRefusal)
    assert plan.code == "goal_outside"
