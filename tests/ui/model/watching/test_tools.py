import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.traversability import inside
from sim.inputs import ClearCostmaps, KidnapRobot, KillRobot, PutThing, RemoveThing, ReviveRobot
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.shared.robot_requests import Request, WizardAdvice, WizardMode, WizardMove, WizardRequest
from thbridge.ros.messages.records import InitialPose, SimpleGoal
from ui.model.watching.scene import PendingAdvice, PendingTurn, RobotScene, Scene, ThingScene, Wizard
from ui.model.watching.tools import LEAST_SIZE, MOST_SIZE, ToolRefusalReason, Tools, dragged_pose, obstacle

GRID = OccupancyGrid(np.zeros((40, 40), dtype=np.int8), 0.1, Pose2(-2.0, -2.0, 0.0))
TURN = PendingTurn(3, 5, 0, "select-room", 4, ("Continue", "Stop"))
CRATE = ThingScene("obstacle 1", np.array([[0.5, 0.5], [1.0, 0.5], [1.0, 1.0], [0.5, 1.0], [0.5, 0.5]]))


@pytest.fixture
def scene() -> Scene:
    robots = (RobotScene(0, "robot 1", truth=Pose2(0.0, 0.0, 1.0)), RobotScene(1, "robot 2", dead=True))
    wizard = Wizard((0,), (TURN,), (PendingAdvice(0, ((2, 10.0),), 2),))
    return Scene(0, GRID, robots, (CRATE,), (), wizard)


def reason(outcome: Request | WizardRequest | RequestRefused) -> str:
    assert isinstance(outcome, RequestRefused)
    assert outcome.sentence.endswith((".", ")."))
    return outcome.reason


def test_what_is_done_to_robots_comes_to_requests(scene: Scene) -> None:
    tools, place = Tools(), Pose2(1.0, 0.5, 0.2)
    goal, pose = tools.goal(scene, 0, place), tools.pose(scene, 0, place)
    assert isinstance(goal, SimpleGoal)
    assert (goal.robot, goal.base_in_map) == (0, place)
    assert isinstance(pose, InitialPose)
    assert pose.base_in_map == place
    assert tools.carry(scene, 0, 1.0, 0.5) == KidnapRobot(0, Pose2(1.0, 0.5, 1.0))
    assert tools.carry(scene, 0, 1.0, 0.5, 2.0) == KidnapRobot(0, Pose2(1.0, 0.5, 2.0))
    assert tools.kill(scene, 0) == KillRobot(0)
    assert tools.revive(scene, 1) == ReviveRobot(1)
    assert tools.clear_costmaps(scene, 0) == ClearCostmaps(0)


def test_every_goal_has_another_number(scene: Scene) -> None:
    tools = Tools()
    goals = [tools.goal(scene, 0, Pose2(0.0, 0.0, 0.0)) for _ in range(3)]
    assert len({goal.number for goal in goals if isinstance(goal, SimpleGoal)}) == 3


def test_what_makes_no_sense_is_refused_in_words(scene: Scene) -> None:
    tools, place = Tools(), Pose2(0.0, 0.0, 0.0)
    assert reason(tools.goal(scene, 1, place)) == ToolRefusalReason.DEAD
    assert reason(tools.kill(scene, 1)) == ToolRefusalReason.DEAD
    assert reason(tools.clear_costmaps(scene, 1)) == ToolRefusalReason.DEAD
    assert reason(tools.revive(scene, 0)) == ToolRefusalReason.ALIVE
    assert reason(tools.goal(scene, 7, place)) == ToolRefusalReason.NO_ROBOT
    assert reason(tools.goal(scene, 0, Pose2(5.0, 0.0, 0.0))) == ToolRefusalReason.OFF_MAP
    assert reason(tools.carry(scene, 0, 0.0, -2.1)) == ToolRefusalReason.OFF_MAP
    assert reason(tools.remove(scene, 0.0, 0.0)) == ToolRefusalReason.NO_THING


def test_things_get_names_of_their_own_and_are_taken_away_where_they_stand(scene: Scene) -> None:
    put = Tools().put(scene, "circle", 0.0, 1.0, 0.6)
    assert isinstance(put, PutThing)
    assert put.thing.name == "obstacle 2"
    assert Tools().remove(scene, 0.7, 0.9) == RemoveThing("obstacle 1")


def test_a_wizard_answers_only_what_is_waited_for(scene: Scene) -> None:
    tools = Tools()
    assert tools.puppeteer(scene, 0, True) == WizardMode(0, True)
    assert tools.speak(scene, TURN, 1, " No, thank you ") == WizardMove(3, 5, 1, "No, thank you")
    assert reason(tools.speak(scene, TURN, 2)) == ToolRefusalReason.NOT_WAITING
    assert (
        reason(tools.speak(scene, PendingTurn(3, 4, 0, "select-room", 4, ("Continue",)), 0))
        == ToolRefusalReason.NOT_WAITING
    )
    assert tools.advise(scene, 0, 2) == WizardAdvice(0, 2)
    assert reason(tools.advise(scene, 1, 2)) == ToolRefusalReason.NOT_WAITING


def test_a_drag_tells_the_heading_and_a_click_keeps_it() -> None:
    assert dragged_pose(1.0, 1.0, 1.0, 2.0) == Pose2(1.0, 1.0, math.pi / 2)
    assert dragged_pose(1.0, 1.0, 1.02, 1.0, 0.7) == Pose2(1.0, 1.0, 0.7)


@given(size=st.floats(-1.0, 100.0))
@pytest.mark.parametrize("shape", ["circle", "box"])
def test_an_obstacle_is_as_large_as_it_is_dragged_within_reason(shape: str, size: float) -> None:
    thing = obstacle("it", "box" if shape == "box" else "circle", Pose2(1.0, 2.0, 0.0), size)
    across = 2.0 * max(x for x, _ in thing.footprint)
    least, most = LEAST_SIZE, MOST_SIZE
    assert across == pytest.approx(min(max(size, least), most), rel=0.03)
    assert inside(thing.footprint, np.zeros(1), np.zeros(1))[0]
